"""The commands of legpush, as the table of the command line has them."""

from legpush.cli.commands import COMMANDS, Group, all_commands


def command_names() -> list[str]:
    """The words behind `legpush` of every command, such as `study` and `study verify`."""
    return [*(name for name, entry in COMMANDS.items() if isinstance(entry, Group)), *all_commands()]


def leaf_names() -> list[str]:
    """The same without those that have commands below them."""
    return list(all_commands())
