"""Finds the engine that `--on` names."""

from typing import Final

from legpush.errors import ConfigError
from legpush.study.engines.engine import Engine
from legpush.study.engines.local import LocalEngine

ENGINES: Final = ("local",)


def require_engine(on: str) -> None:
    """Check that there is such an engine.

    Raises:
        ConfigError: There is none; lists the valid ones.
    """
    if on not in ENGINES:
        raise ConfigError(f"Expected {' or '.join(ENGINES)} for --on, got {on!r}")


def make_engine(on: str, n_workers: int) -> Engine:
    """Make the engine that `--on` names.

    Raises:
        ConfigError: There is none, or it cannot be used here.
    """
    require_engine(on)
    return LocalEngine(n_workers)
