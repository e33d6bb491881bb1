"""Finds the engine that `--on` names."""

import os
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from legpush.errors import ConfigError
from legpush.options.study import EngineOptions
from legpush.processes.environment import ONE_THREAD
from legpush.study.engines.engine import Engine
from legpush.study.engines.inline import InlineEngine
from legpush.study.engines.local import LocalEngine

LOCAL: Final = "local"
SLURM: Final = "slurm"
INLINE: Final = "inline"
ENGINES: Final = (LOCAL, INLINE, "ray", "ray:HOST:PORT", "ray://HOST:PORT", SLURM)
NUMERICS: Final = ("LEGPUSH_NUMERICS", "OPENBLAS_CORETYPE", "NPY_DISABLE_CPU_FEATURES", "GLIBC_TUNABLES")
"""Environment variables that decide which bits a process computes: workers elsewhere have those of the head."""


def require_engine(on: str, slurm_options: Mapping[str, str]) -> None:
    """Refuse an engine that is unknown, or that has no such options.

    Raises:
        ConfigError: There is none; lists the valid ones.
    """
    if on not in (LOCAL, INLINE, SLURM) and on.partition(":")[0] != "ray":
        raise ConfigError(f"Expected one of {', '.join(ENGINES)} for --on, got {on!r}")
    if slurm_options and on != SLURM:
        raise ConfigError(f"Expected --slurm-option with --on slurm, got it with --on {on}")


def engine_of(options: EngineOptions, study: Path, stop: threading.Event) -> Engine:
    """Make the engine that the options of a command ask for; `study` is the folder of the study.

    `stop` ends waiting for a router.

    Raises:
        ConfigError: There is none, or it cannot be used here.
        EndpointError: The workers of a run cannot be reached from here.
        StopRequestedError: `stop` was set before a router was there.
    """
    if options.join is None:
        return make_engine(options.on, options.n_workers, study, options.slurm_options)
    from legpush.study.engines.joined import JoinedEngine

    return JoinedEngine(options.join, options.endpoints("agent"), stop=stop)


def make_engine(on: str, n_workers: int, study: Path, slurm_options: Mapping[str, str]) -> Engine:
    """Make the engine that `--on` names.

    Args:
        on: One of `ENGINES`.
        n_workers: Number of worker processes, or of jobs in the queue of Slurm.
        study: Folder of the study.
        slurm_options: Options of `sbatch` by name.

    Raises:
        ConfigError: There is none, or it cannot be used here.
    """
    require_engine(on, slurm_options)
    if on == LOCAL:
        return LocalEngine(n_workers)
    if on == INLINE:
        return InlineEngine()
    extra = on.partition(":")[0]
    environment = {**ONE_THREAD, **{name: os.environ[name] for name in NUMERICS if name in os.environ}}
    try:
        if on == SLURM:
            from legpush.study.engines.slurm import SlurmEngine

            return SlurmEngine(study, n_jobs=n_workers, options=slurm_options, environment=environment)
        from legpush.study.engines.ray_cluster import RayEngine

        return RayEngine(on, n_workers=n_workers, environment=environment)
    except ModuleNotFoundError as error:
        raise ConfigError(
            f"--on {on} needs {error.name}, which is not installed; pip install 'legpush[{extra}]' installs it"
        ) from error
