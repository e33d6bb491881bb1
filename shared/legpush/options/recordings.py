"""Options of `legpush record`, `info`, `recover`, `replay` and `branch`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from legpush.bounds import BoxMass, FileMegabytes, Friction, Speed, TimeS, WaitS
from legpush.bus.endpoints import local
from legpush.errors import ConfigError
from legpush.fields import Name, episode_and_step, require
from legpush.scene.names import PlannerName

File = Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="FILE")]
Files = Annotated[tyro.conf.Positional[tuple[Path, ...]], tyro.conf.arg(metavar="FILE")]


@dataclass(frozen=True, kw_only=True)
class RecordOptions:
    """Record all messages of a run into an MCAP file, until Ctrl-C, without slowing its processes.

    Exit codes: 0 the recording is complete from its beginning on, 1 it is not and says what is missing, 2 bad input, or
    the file cannot be written any more.
    """

    file: File
    """The new recording, such as mission.mcap."""
    run: Annotated[str | None, tyro.conf.arg(metavar="NAME|FOLDER")] = None
    """The run to record. If not given, it is the run in LEGPUSH_RUN, else the live run of a launcher, else `local`, the
    run of processes started by hand."""
    name: str = "main"
    """Name of the recorder, to distinguish several recorders of one run."""
    listen: tuple[str, ...] = ()
    """Endpoints to listen on."""
    connect: tuple[str, ...] = ()
    """Endpoints of planner, simulator and agent. If not given, --run finds them, or they are the ports of processes
    started by hand."""
    topics: Annotated[tuple[str, ...], tyro.conf.arg(metavar="PATTERN ...")] = ()
    """Record only these topics, such as "sim/*" "plan/*"."""
    split_mb: Annotated[float | None, tyro.conf.arg(metavar="MB")] = None
    """Continue in another file, FILE-001 and so on, when a file has this size."""
    split_s: Annotated[float | None, tyro.conf.arg(metavar="S")] = None
    """Continue in another file after this many seconds."""
    duration_s: Annotated[float | None, tyro.conf.arg(name="duration", metavar="S")] = None
    """Stop after this many seconds."""
    about: Annotated[tyro.conf.UseAppendAction[tuple[str, ...]], tyro.conf.arg(metavar="NAME=VALUE")] = ()
    """Metadata for the file. Give it again for more."""

    def __post_init__(self) -> None:
        require(Name, self.name, "--name")
        require(FileMegabytes, self.split_mb, "--split-mb")
        require(WaitS, self.split_s, "--split-s")
        require(WaitS, self.duration_s, "--duration")
        for item in self.about:
            if "=" not in item:
                raise ConfigError(f"Expected NAME=VALUE for --about, got {item!r}")


@dataclass(frozen=True, kw_only=True)
class InfoOptions:
    """Describe a recording: channels, rates, episodes, completeness, result.

    Exit codes: 0 described, 2 the file is not a recording.
    """

    files: Files
    """The recording, or its parts."""


@dataclass(frozen=True, kw_only=True)
class RecoverOptions:
    """Make a whole recording from one that is cut off or damaged, in a new file; or let an interrupted mission go on.

    Exit codes: 0 recovered, 2 nothing to recover, or nothing can be recovered.
    """

    file: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="FILE|RUN_FOLDER")]
    """The recording, which is not changed; or the folder of a run, whose damaged journal is cut off before its first
    damage and kept beside it."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """The new file; FILE-recovered.mcap if not given."""


@dataclass(frozen=True, kw_only=True)
class ReplayOptions:
    """Verify a recording, let it take the part of a process, or publish it again for recorders and viewers.

    Exit codes: 0 identical, or done; 1 it diverges or is damaged; 2 bad input, such as a recording without the required
    steps; 3 a process failed; 130 interrupted.
    """

    files: Files
    """The recording, or its parts."""
    verify: bool = False
    """Send the recorded motions to a fresh simulator, compare every answer bit for bit, and list all damage."""
    as_role: Annotated[
        Literal["planner", "sim", "agent"] | None, tyro.conf.arg(name="as", metavar="planner|sim|agent")
    ] = None
    """Let the recording take the part of this process; the other processes are live."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    """With --as: folder of the run; `runs/<time>-...` if not given."""
    policy: Annotated[str | None, tyro.conf.arg(metavar="POLICY")] = None
    """With --as planner|sim: the policy of the recording, repeated because it runs code and you trust it."""
    trust_policy_file: bool = False
    """Load it if it is a model file (.zip) of Stable-Baselines3, which is a pickle: loading it runs any code in it."""
    rate: Annotated[float, tyro.conf.arg(metavar="X")] = 1.0
    """Publish this many times as fast as it was recorded."""
    loop: bool = False
    """Publish again and again, until Ctrl-C."""
    start_s: Annotated[float, tyro.conf.arg(name="start", metavar="S")] = 0.0
    """Begin to publish this many seconds after the beginning."""
    run: str = "replay"
    """Name of the run in which the recording is published."""
    listen: tuple[str, ...] = local("agent").listen
    """Endpoints for the recorders and viewers of that run."""

    def __post_init__(self) -> None:
        if not self.files:
            raise ConfigError("Expected the file of a recording, got none")
        if self.verify and self.as_role is not None:
            raise ConfigError("Expected either --verify or --as, got both")
        if self.policy is not None and self.as_role not in ("planner", "sim"):
            raise ConfigError("Expected --as planner or --as sim with --policy, since nothing else asks the policy")
        require(Speed, self.rate, "--rate")
        require(TimeS, self.start_s, "--start")
        require(Name, self.run, "--run")


@dataclass(frozen=True, kw_only=True)
class BranchOptions:
    """Continue a recorded mission from a step on with another policy, planner or box, as a run of its own.

    The steps before it are done again, with the same states. Then the mission continues live. The exit codes are those
    of `legpush run`.
    """

    files: Files
    """The recording of a mission, or its parts."""
    at: Annotated[str, tyro.conf.arg(metavar="EPISODE:STEP")] = ""
    """The first step that differs from the recording, such as 0:12; `legpush info` lists episodes and steps."""
    policy: Annotated[str | None, tyro.conf.arg(metavar="POLICY")] = None
    """Policy that chooses the pushes from that step on; if not given, that of the recording. Repeat that one if it runs
    code and you trust it."""
    past_policy: Annotated[str | None, tyro.conf.arg(metavar="POLICY")] = None
    """The policy of the recording, repeated because it runs code and you trust it, where --policy is another one."""
    trust_policy_file: bool = False
    """Load a model file (.zip) of Stable-Baselines3. It is a pickle: loading it runs any code in it."""
    planner: PlannerName | None = None
    """Search that the planner uses from that step on."""
    planner_command: Annotated[str | None, tyro.conf.arg(metavar="COMMAND")] = None
    """Planner process from that step on."""
    box_mass_kg: Annotated[float | None, tyro.conf.arg(metavar="KG")] = None
    """Mass of the box from that step on; the mission is not told about it."""
    box_friction: Annotated[float | None, tyro.conf.arg(metavar="MU")] = None
    """Friction of box and floor from that step on; the mission is not told about it."""
    box_foot_friction: Annotated[float | None, tyro.conf.arg(metavar="MU")] = None
    """Friction of box and foot from that step on; the mission is not told about it."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    """Folder of the run; `runs/<time>-<scenario>-seed<N>` if not given. An unfinished run in this folder continues."""
    record: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """The new recording, which names the old one; FILE-branch-EPISODE-STEP.mcap if not given."""
    video: bool = False
    """Render mission.mp4 at the end."""

    def __post_init__(self) -> None:
        if not self.files:
            raise ConfigError("Expected the file of a recording, got none")
        episode_and_step(self.at, "--at")
        require(BoxMass, self.box_mass_kg, "--box-mass-kg")
        require(Friction, self.box_friction, "--box-friction")
        require(Friction, self.box_foot_friction, "--box-foot-friction")
