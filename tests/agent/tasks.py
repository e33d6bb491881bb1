"""Tasks of tests: built-in ones with some fields replaced."""

from typing import Any

from msgspec.structs import replace

from agent_proc.task.config import TaskConfig
from agent_proc.task.file import load_task


def tuned(**changes: Any) -> TaskConfig:
    """The task `tuned`, with variable entry."""
    return replace(load_task("tuned"), **changes)


def paper(**changes: Any) -> TaskConfig:
    """The task `paper-text`, with variable entry."""
    return replace(load_task("paper-text"), **{"entry": "variable", **changes})
