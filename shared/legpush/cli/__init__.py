"""The `legpush` command. This module is light, so that an interrupt is handled from the first moment on."""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence


def main(argv: "Sequence[str] | None" = None) -> int:
    """Run the command line of this process, or `argv` as a function of Python; return the exit code.

    For the command line of this process, signals are handled as `legpush.entry` describes.
    """
    if argv is None:
        from legpush.entry import run_main

        return run_main("legpush.cli.command")
    from legpush.cli.command import main as run_command

    return run_command(argv)
