"""Options of `legpush study`."""

import os
import platform
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

from legpush.arguments import USUAL_OUTPUT, Flag, OutputOptions, Positional, Repeated, arg
from legpush.bus.endpoints import DEFAULT_NAME, DEFAULT_RUN, Endpoints, by_router, local, require_alone
from legpush.bus.secure.host_folder import credentials_of
from legpush.errors import ConfigError
from legpush.fields import MAX_NAME, Name, Seed, require
from legpush.messages.common import Role
from legpush.options.checks import require_new_file

MOST_WORKERS: Final = 100_000
MOST_WORKERS_OF_HOST: Final = 1024


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where a head and workers on other hosts find each other."""

    listen: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints to listen on for the other side. Without any endpoint, head and workers meet at a socket of their user.
    """
    connect: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints on which the other side listens."""
    router: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints of routers (`legpush router`), in the place of --listen and --connect."""
    secure: Annotated[Path | None, arg("DIR")] = None
    """Folder of this host that `legpush secure init` made: talk over TLS alone."""

    def endpoints(self, role: Role) -> Endpoints:
        """Return where a process of this role listens and connects.

        Raises:
            EndpointError: One of the texts is not an endpoint.
            CredentialsError: The certificate of this role cannot be used.
        """
        credentials = credentials_of(self.secure, role)
        if self.router:
            return by_router(self.router, credentials)
        if self.listen or self.connect:
            return Endpoints(listen=self.listen, connect=self.connect, credentials=credentials)
        usual = local(role, credentials)
        return Endpoints(listen=usual.listen, connect=() if role == "agent" else usual.connect, credentials=credentials)


@dataclass(frozen=True, kw_only=True)
class EngineOptions(Place):
    """Where cells are run, and what code they may run."""

    join: Annotated[str | None, arg("RUN")] = None
    """Run the cells in the workers of this run, which `legpush study work` starts on any host. --listen, --connect,
    --router and --secure say where they are."""
    on: Annotated[str, arg("ENGINE")] = "local"
    """Where to run the cells: `local`, in processes on this machine; `inline`, in this process alone, for a debugger or
    an emulator; `ray`, on a Ray cluster that is started on this
    machine; `ray:HOST:PORT`, on a running one of which this machine is a node; `ray://HOST:PORT`, on one of which it is
    none; or `slurm`."""
    workers: Annotated[int | None, arg("N")] = None
    """Number of worker processes, or of jobs in the queue of Slurm; if not given, one per core of this machine. A
    running Ray cluster has its own number."""
    slurm_option: Annotated[Repeated[str], arg("NAME=VALUE")] = ()
    """Give Slurm this option of `sbatch` for each job, such as `partition=cpu` or `time=120` (minutes); may be given
    several times. `cluster=local` needs no Slurm: it runs the same jobs on this machine, as a rehearsal."""
    cell: Annotated[str | None, arg("MODULE:FUNCTION")] = None
    """Run cells of this kind, which is your own code. A study file alone never names code."""
    policy: Annotated[Repeated[str], arg("POLICY")] = ()
    """Allow this policy of the study file, which runs code; may be given several times."""

    def __post_init__(self) -> None:
        if self.workers is not None and not 1 <= self.workers <= MOST_WORKERS:
            raise ConfigError(f"Expected 1 to {MOST_WORKERS} for --workers, got {self.workers}")
        require(Name, self.join, "--join")
        if self.join is None and (self.listen or self.connect or self.router or self.secure):
            raise ConfigError(
                "Expected --join RUN with --listen, --connect, --router and --secure: they say where its workers are"
            )
        require_alone(self.router, (*self.listen, *self.connect))
        if self.join is not None and (self.on != "local" or self.workers is not None or self.slurm_option):
            raise ConfigError(
                "Expected --join alone, without --on, --workers and --slurm-option: a run has its workers"
            )
        for option in self.slurm_option:
            if not all(option.partition("=")):
                raise ConfigError(f"Expected NAME=VALUE for --slurm-option, got {option!r}")

    @property
    def n_workers(self) -> int:
        """Number of worker processes."""
        return self.workers if self.workers is not None else len(os.sched_getaffinity(0))

    @property
    def slurm_options(self) -> dict[str, str]:
        """Options of Slurm by name."""
        return {name: value for name, _, value in (option.partition("=") for option in self.slurm_option)}


@dataclass(frozen=True, kw_only=True)
class RunStudy(EngineOptions):
    """Run the cells of a study, or go on with it in its folder.

    Ctrl-C keeps every finished cell; the same command goes on. Exit codes: 0 all cells have a row, 1 some cells failed,
    2 bad input, 3 the engine failed, 5 the disk is full, 130 interrupted.
    """

    file: Positional[Annotated[Path, arg("FILE")]]
    """The study: a TOML file."""
    out: Annotated[Path | None, arg("DIR")] = None
    """Folder of the study; `runs/` and the name of the file if not given. A study in this folder continues."""
    retry_failed: Flag = False
    """Run again the cells that failed by themselves; without it, only those whose workers were lost."""
    yes: Flag = False
    """Run more than a million cells."""
    output: OutputOptions = USUAL_OUTPUT

    @property
    def folder(self) -> Path:
        """Folder of the study."""
        return self.out or Path("runs") / self.file.stem


@dataclass(frozen=True, kw_only=True)
class WorkOptions(Place):
    """Run cells of studies for heads on any host, until a signal: `legpush study run FILE --join RUN` is a head.

    A worker runs the cells that the installed package has, and policies that are data. Files that a cell names, such as
    the folder of a policy, have to be on this host.
    Exit codes: 0 ended by a signal, 2 bad input, 3 the network failed.
    """

    run: Annotated[str, arg("NAME")] = DEFAULT_RUN
    """Name of the run; a head has the same one for --join."""
    name: Annotated[str | None, arg("NAME")] = None
    """Name of the worker among those of the run, which no other host uses; if not given, the name of the host. If there
    are several, they are named NAME-1, NAME-2, ..."""
    workers: Annotated[int | None, arg("N")] = None
    """Number of workers of this host, each a process; if not given, one per core."""
    cell: Annotated[str | None, arg("MODULE:FUNCTION")] = None
    """Allow cells of this kind, which is your own code; the head has the same option."""
    policy: Annotated[Repeated[str], arg("POLICY")] = ()
    """Allow this policy, which runs code, or this plug-in of another package, such as a logger; may be given several
    times."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        require(Name, self.run, "--run")
        require_alone(self.router, (*self.listen, *self.connect))
        if self.workers is not None and not 1 <= self.workers <= MOST_WORKERS_OF_HOST:
            raise ConfigError(f"Expected 1 to {MOST_WORKERS_OF_HOST} for --workers, got {self.workers}")
        for name in self.names:
            require(Name, name, "--name")

    @property
    def own_name(self) -> str:
        """Name that the workers of this host have in common."""
        return host_name() if self.name is None else self.name

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the workers."""
        n = self.workers if self.workers is not None else len(os.sched_getaffinity(0))
        return tuple(f"{self.own_name}-{number}" for number in range(1, n + 1)) if n > 1 else (self.own_name,)


def host_name() -> str:
    """Return the name of this host, as the name of a worker may be, with room for a number."""
    longest = MAX_NAME - len(f"-{MOST_WORKERS_OF_HOST}")
    return re.sub(r"[^A-Za-z0-9_-]+", "-", platform.node())[:longest].strip("-") or DEFAULT_NAME


@dataclass(frozen=True, kw_only=True)
class StudyStatus:
    """Show how far a study is, and why cells failed."""

    folder: Positional[Annotated[Path, arg("DIR")]]
    """Folder of the study."""
    output: OutputOptions = USUAL_OUTPUT


@dataclass(frozen=True, kw_only=True)
class VerifyStudy(EngineOptions):
    """Run a random share of the cells again and compare every number.

    Exit codes: 0 equal, 1 a cell differs, 2 bad input, 3 the engine failed, 130 interrupted.
    """

    folder: Positional[Annotated[Path, arg("DIR")]]
    """Folder of the study."""
    share: Annotated[float, arg("X")] = 0.05
    """Share of the cells to run again, at least one."""
    seed: Annotated[int, arg("N")] = 0
    """Seed of the choice of cells."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        super().__post_init__()
        require(Seed, self.seed, "--seed")
        if not 0.0 < self.share <= 1.0:
            raise ConfigError(f"Expected more than 0 and at most 1 for --share, got {self.share}")


@dataclass(frozen=True, kw_only=True)
class MergeStudies:
    """Write the rows of several folders of one kind of cell into one table."""

    folders: Positional[Annotated[tuple[Path, ...], arg("DIR")]]
    """Folders of studies with equal code."""
    out: Annotated[Path | None, arg("DIR")] = None
    """New folder for all of them; the name of the first one with `-merged` if not given."""
    output: OutputOptions = USUAL_OUTPUT

    @property
    def folder(self) -> Path:
        """Folder of the merged study."""
        first = self.folders[0]
        return self.out or first.with_name(f"{first.name}-merged")


@dataclass(frozen=True, kw_only=True)
class StudyTable:
    """Print a table of a study: means with 95 % intervals, by the axes."""

    folder: Positional[Annotated[Path, arg("DIR")]]
    """Folder of the study."""
    by: Annotated[tuple[str, ...], arg("AXIS ...")] = ()
    """Columns whose values make the groups; if not given, every axis but the seed."""
    measure: Annotated[tuple[str, ...], arg("COLUMN ...")] = ()
    """Columns to summarize; if not given, every result that is a number or a truth value."""
    paired: Annotated[str | None, arg("AXIS=VALUE")] = None
    """Show the mean difference from the cells with this value, between cells whose other axes are the same."""
    csv: Annotated[Path | None, arg("FILE")] = None
    """Write the table into this new file."""
    plot: Annotated[Path | None, arg("FILE")] = None
    """Draw the table into this new PNG file."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        for path, flag in ((self.csv, "--csv"), (self.plot, "--plot")):
            if path is not None:
                require_new_file(path, flag)
        if self.paired is not None and "=" not in self.paired:
            raise ConfigError(f"Expected AXIS=VALUE for --paired, such as policy=scripted, got {self.paired!r}")
