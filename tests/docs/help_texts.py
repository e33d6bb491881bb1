"""Help texts of all commands and processes, made in this process."""

import io
from collections.abc import Callable, Iterator
from contextlib import redirect_stdout
from functools import cache, partial
from typing import Any, Final, get_args, get_type_hints

from agent_proc.mission.process import AgentConfig
from legpush.cli import command as cli
from legpush.messages.common import Role
from legpush.options.bench import Bench
from legpush.options.policies import Policies
from legpush.options.scenarios import Scenarios
from legpush.options.study import Studies
from legpush.service import ServiceConfig, parse

PROCESSES: Final[dict[Role, type[ServiceConfig]]] = {
    "planner": ServiceConfig,
    "sim": ServiceConfig,
    "agent": AgentConfig,
}


@cache
def help_texts() -> dict[str, str]:
    """Command and text of every `--help`: those of `legpush`, and those of the three processes."""
    texts = {}
    for words in commands():
        texts[f"legpush {words}".strip()] = _printed(partial(cli.main, [*words.split(), "--help"]))
    for role, options in PROCESSES.items():
        texts[f"python -m {role}_proc"] = _printed(partial(parse, role, options, ["--help"], {}))
    return texts


def commands() -> Iterator[str]:
    """The words behind `legpush` of every command, none first."""
    yield ""
    for name in _names(cli.Command):
        yield name
    for command, options in (("scenarios", Scenarios), ("study", Studies), ("policy", Policies), ("bench", Bench)):
        for name in _names(get_type_hints(options, include_extras=True)["action"]):
            yield f"{command} {name}"


def _names(union: Any) -> list[str]:
    return [kind.__metadata__[0].name for kind in get_args(union)]


def _printed(run: Callable[[], object]) -> str:
    out = io.StringIO()
    try:
        with redirect_stdout(out):
            run()
    except SystemExit as end:
        if end.code != 0:
            raise RuntimeError(f"Expected exit code 0 of a help text, got {end.code}") from end
    return " ".join(out.getvalue().replace("│", " ").split())
