"""Help texts of all commands and processes, made in this process."""

import io
from collections.abc import Callable
from contextlib import redirect_stdout
from functools import cache, partial
from typing import Final

from agent_proc.mission.process import AgentConfig
from legpush.cli import command as cli
from legpush.messages.common import Role
from legpush.service import ServiceConfig, parse
from tests.command_names import command_names

PROCESSES: Final[dict[Role, type[ServiceConfig]]] = {
    "planner": ServiceConfig,
    "sim": ServiceConfig,
    "agent": AgentConfig,
}


@cache
def help_texts() -> dict[str, str]:
    """Command and text of every `--help`: those of `legpush`, and those of the three processes."""
    texts = {}
    for words in ("", *command_names()):
        texts[f"legpush {words}".strip()] = _printed(partial(cli.main, [*words.split(), "--help"]))
    for role, options in PROCESSES.items():
        texts[f"python -m {role}_proc"] = _printed(partial(parse, role, options, ["--help"], {}))
    return texts


def _printed(run: Callable[[], object]) -> str:
    out = io.StringIO()
    try:
        with redirect_stdout(out):
            run()
    except SystemExit as end:
        if end.code != 0:
            raise RuntimeError(f"Expected exit code 0 of a help text, got {end.code}") from end
    return " ".join(out.getvalue().replace("│", " ").split())
