"""Options of `legpush record`, `info`, `recover`, `replay` and `branch`."""

from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Annotated, Literal

import tyro

from legpush.bus.endpoints import local
from legpush.errors import ConfigError
from legpush.fields import Name, episode_and_step, require
from legpush.options.checks import require_not_negative, require_positive
from legpush.scene.scenario import PlannerName

File = Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="FILE")]
Files = Annotated[tyro.conf.Positional[tuple[Path, ...]], tyro.conf.arg(metavar="FILE")]


@dataclass(frozen=True, kw_only=True)
class RecordOptions:
    """Record all that the processes of a run publish into an MCAP file, until Ctrl-C; it never slows them.

    Exit codes: 0 the recording is complete from its beginning on, 1 it is not and says what is missing, 2 bad input, or
    the file cannot be written any more.
    """

    file: File
    """The new recording, such as mission.mcap."""
    run: Annotated[str | None, tyro.conf.arg(metavar="NAME|FOLDER")] = None
    """Which run: the one that a launcher has going if not given, else that of processes started by hand, `local`.
    LEGPUSH_RUN says the same."""
    name: str = "main"
    """Tells recorders of one run apart."""
    listen: tuple[str, ...] = ()
    """Endpoints to listen on."""
    connect: tuple[str, ...] = ()
    """Endpoints of planner, simulator and agent; found by --run, or the ports of those started by hand, if not
    given."""
    topics: Annotated[tuple[str, ...], tyro.conf.arg(metavar="PATTERN ...")] = ()
    """Record only these, such as "sim/*" "plan/*"."""
    split_mb: Annotated[float | None, tyro.conf.arg(metavar="MB")] = None
    """Go on in another file, FILE-001 and so on, when one has this size."""
    split_s: Annotated[float | None, tyro.conf.arg(metavar="S")] = None
    """The same after this many seconds."""
    duration_s: Annotated[float | None, tyro.conf.arg(name="duration", metavar="S")] = None
    """Stop after this many seconds."""
    about: Annotated[tyro.conf.UseAppendAction[tuple[str, ...]], tyro.conf.arg(metavar="NAME=VALUE")] = ()
    """Metadata for the file; may be given again."""

    def __post_init__(self) -> None:
        require(Name, self.name, "--name")
        for flag, number in (
            ("--split-mb", self.split_mb),
            ("--split-s", self.split_s),
            ("--duration", self.duration_s),
        ):
            require_positive(number, flag)
        for item in self.about:
            if "=" not in item:
                raise ConfigError(f"Expected NAME=VALUE for --about, got {item!r}")


@dataclass(frozen=True, kw_only=True)
class InfoOptions:
    """Show what is in a recording: channels, rates, episodes, completeness, result. Exit code 2 where it is none."""

    files: Files
    """The recording, or its parts."""


@dataclass(frozen=True, kw_only=True)
class RecoverOptions:
    """Make a whole recording of one that was cut off, in a new file."""

    file: File
    """It stays as it is."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """The new file, FILE-recovered.mcap if not given."""


@dataclass(frozen=True, kw_only=True)
class ReplayOptions:
    """Verify a recording, let it play a process, or publish it again for whoever records or watches.

    Exit codes: 0 identical, or done; 1 it diverges; 2 bad input, such as a recording without the steps that it takes; 3
    a process failed; 130 interrupted.
    """

    files: Files
    """The recording, or its parts."""
    verify: bool = False
    """Ask a fresh simulator what was asked, and compare every answer bit for bit."""
    as_role: Annotated[
        Literal["planner", "sim", "agent"] | None, tyro.conf.arg(name="as", metavar="planner|sim|agent")
    ] = None
    """The recording takes the part of this process, the others are live."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    """With --as: folder of the run, `runs/<time>-...` if not given."""
    rate: Annotated[float, tyro.conf.arg(metavar="X")] = 1.0
    """Publish so many times as fast as it was recorded."""
    loop: bool = False
    """Publish over and over, until Ctrl-C."""
    start_s: Annotated[float, tyro.conf.arg(name="start", metavar="S")] = 0.0
    """Publish from so many seconds after the beginning on."""
    run: str = "replay"
    """Name of the run in which it is published."""
    listen: tuple[str, ...] = local("agent").listen
    """Where recorders and viewers of that run connect to."""

    def __post_init__(self) -> None:
        if not self.files:
            raise ConfigError("Expected the file of a recording, got none")
        if self.verify and self.as_role is not None:
            raise ConfigError("Expected either --verify or --as, got both")
        require_positive(self.rate, "--rate")
        require_not_negative(self.start_s, "--start")
        require(Name, self.run, "--run")


@dataclass(frozen=True, kw_only=True)
class BranchOptions:
    """Continue a recorded mission from a step on with another policy, planner or box, as a run of its own.

    Steps before it are done again, to the same states; then the mission goes on live. Exit codes as of `legpush run`.
    """

    files: Files
    """The recording of a mission, or its parts."""
    at: Annotated[str, tyro.conf.arg(metavar="EPISODE:STEP")] = ""
    """The first step that is not the recorded one, such as 0:12; `legpush info` lists both."""
    policy: Annotated[str | None, tyro.conf.arg(metavar="POLICY")] = None
    """Chooses the pushes from there on."""
    planner: PlannerName | None = None
    """Which search is asked for from there on."""
    planner_command: Annotated[str | None, tyro.conf.arg(metavar="COMMAND")] = None
    """Another planner process from there on."""
    box_mass_kg: Annotated[float | None, tyro.conf.arg(metavar="KG")] = None
    """Mass of the box from there on; the mission is not told."""
    box_friction: Annotated[float | None, tyro.conf.arg(metavar="MU")] = None
    """Friction of the box from there on; the mission is not told."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    """Folder of the run, `runs/<time>-<scenario>-seed<N>` if not given; an unfinished one goes on in its folder."""
    record: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """The new recording, which names this one; FILE-branch-EPISODE-STEP.mcap if not given."""
    video: bool = False
    """Render mission.mp4 at the end."""

    def __post_init__(self) -> None:
        if not self.files:
            raise ConfigError("Expected the file of a recording, got none")
        episode_and_step(self.at, "--at")
        least_kg = 0.001
        if self.box_mass_kg is not None and not (isfinite(self.box_mass_kg) and self.box_mass_kg >= least_kg):
            raise ConfigError(f"Expected at least {least_kg} kg for --box-mass-kg, got {self.box_mass_kg}")
        require_positive(self.box_friction, "--box-friction")
