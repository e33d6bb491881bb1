"""Options of `legpush plan-check`."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from legpush.arguments import USUAL_OUTPUT, OutputOptions, arg
from legpush.bounds import WaitS
from legpush.errors import ConfigError
from legpush.fields import require
from legpush.options.checks import program_path, require_writable_file

USAGE = "legpush plan-check [--deadline S] [--only TEXT ...] [--out FILE] -- COMMAND..."


@dataclass(frozen=True, kw_only=True)
class PlanCheckOptions:
    """Check a planner: `legpush plan-check [OPTIONS] -- COMMAND...` starts it and sends it queries over the bus.

    Exit codes: 0 all checks passed, 1 not all, 2 bad input, 130 interrupted.
    """

    deadline_s: Annotated[float, arg("S", name="deadline")] = 20.0
    """Longest time that the planner may take for each answer."""
    only: Annotated[tuple[str, ...], arg("TEXT ...")] = ()
    """Run only the checks that have one of these texts in their name."""
    out: Annotated[Path | None, arg("FILE")] = None
    """Write the findings to this JSON file as well."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        require(WaitS, self.deadline_s, "--deadline", "seconds")
        if self.out is not None:
            require_writable_file(self.out, "--out")


def split_at_dashes(argv: Sequence[str]) -> tuple[list[str], tuple[str, ...]]:
    """Split at `--` into flags and the planner's command, which gets its program's absolute path.

    Raises:
        ConfigError: The command is missing, or its program is not found.
    """
    words = list(argv)
    if "--" not in words:
        return (words, ()) if {"-h", "--help"} & set(words) else _refuse(words)
    at = words.index("--")
    if at + 1 == len(words):
        _refuse(words)
    return words[:at], (program_path(words[at + 1]), *words[at + 2 :])


def _refuse(words: Sequence[str]) -> tuple[list[str], tuple[str, ...]]:
    raise ConfigError(f"Expected the planner's command after `--`: {USAGE}, got {' '.join(words) or 'nothing'}")
