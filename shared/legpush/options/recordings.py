"""Options of `legpush record`, `info`, `recover`, `replay` and `branch`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final, Literal

from legpush.arguments import USUAL_OUTPUT, Flag, OutputOptions, Positional, Repeated, arg
from legpush.bounds import BoxMass, FileMegabytes, Friction, Speed, TimeS, WaitS
from legpush.bus.endpoints import require_alone
from legpush.errors import ConfigError
from legpush.fields import Name, episode_and_step, require
from legpush.options.scenarios import Changes
from legpush.scene.names import PlannerName

BOX_CHANGES: Final[dict[str, tuple[str, Any]]] = {
    "box.mass_kg": ("box_mass_kg", BoxMass),
    "box.friction": ("box_friction", Friction),
    "box.foot_friction": ("box_foot_friction", Friction),
}
"""What a branch may change of the box: the field of `Alter`, and its bounds."""
File = Positional[Annotated[Path, arg("FILE")]]
Files = Positional[Annotated[tuple[Path, ...], arg("FILE")]]


@dataclass(frozen=True, kw_only=True)
class RecordOptions:
    """Record all messages of a run into an MCAP file, until Ctrl-C, without slowing its processes.

    Exit codes: 0 the recording is complete from its beginning on, 1 it is not and says what is missing, 2 bad input, or
    the file cannot be written any more.
    """

    file: File
    """The new recording, such as mission.mcap."""
    run: Annotated[str | None, arg("NAME|FOLDER")] = None
    """The run to record. If not given, it is the run in LEGPUSH_RUN, else the live run of a launcher, else `local`, the
    run of processes started by hand."""
    name: Annotated[str, arg("NAME")] = "main"
    """Name of the recorder, to distinguish several recorders of one run."""
    listen: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints to listen on."""
    connect: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints of planner, simulator and agent. If not given, --run finds them, or they are the sockets of processes
    started by hand."""
    router: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints of routers (`legpush router`) through which the run is reached, in the place of --listen and
    --connect."""
    secure: Annotated[Path | None, arg("DIR")] = None
    """Folder of this host that `legpush secure init` made: talk over TLS alone, as a recorder. The usual endpoints are
    then the ports 17471 to 17473 of 127.0.0.1."""
    topics: Annotated[tuple[str, ...], arg("PATTERN ...")] = ()
    """Record only these topics, such as "sim/*" "plan/*"."""
    split_mb: Annotated[float | None, arg("MB")] = None
    """Continue in another file, FILE-001 and so on, when a file has this size."""
    split_s: Annotated[float | None, arg("S")] = None
    """Continue in another file after this many seconds."""
    duration_s: Annotated[float | None, arg("S", name="duration")] = None
    """Stop after this many seconds."""
    about: Annotated[Repeated[str], arg("NAME=VALUE")] = ()
    """Metadata for the file; may be given several times."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        require(Name, self.name, "--name")
        require(FileMegabytes, self.split_mb, "--split-mb")
        require(WaitS, self.split_s, "--split-s")
        require(WaitS, self.duration_s, "--duration")
        require_alone(self.router, (*self.listen, *self.connect))
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
    output: OutputOptions = USUAL_OUTPUT


@dataclass(frozen=True, kw_only=True)
class RecoverOptions:
    """Make a whole recording from one that is cut off or damaged, in a new file; or let an interrupted mission go on.

    Exit codes: 0 recovered, 2 nothing to recover, or nothing can be recovered.
    """

    file: Positional[Annotated[Path, arg("FILE|DIR")]]
    """The recording, which is not changed; or the folder of a run, whose damaged journal is cut off before its first
    damage and kept beside it."""
    out: Annotated[Path | None, arg("FILE")] = None
    """The new file; FILE-recovered.mcap if not given."""
    output: OutputOptions = USUAL_OUTPUT


@dataclass(frozen=True, kw_only=True)
class ReplayOptions:
    """Verify a recording, let it take the part of a process, or publish it again for recorders and viewers.

    Exit codes: 0 identical, or done; 1 it diverges or is damaged; 2 bad input, such as a recording without the required
    steps; 3 a process failed; 130 interrupted.
    """

    files: Files
    """The recording, or its parts."""
    verify: Flag = False
    """Send the recorded motions to a fresh simulator, compare every answer bit for bit, and list all damage."""
    as_role: Annotated[Literal["planner", "sim", "agent"] | None, arg("planner|sim|agent", name="as")] = None
    """Let the recording take the part of this process; the other processes are live."""
    out: Annotated[Path | None, arg("DIR")] = None
    """With --as: folder of the run; `runs/<time>-...` if not given."""
    policy: Annotated[str | None, arg("POLICY")] = None
    """With --as planner|sim: the policy of the recording, repeated because it runs code and you trust it."""
    trust_policy_file: Flag = False
    """Load it if it is a model file (.zip) of Stable-Baselines3, which is a pickle: loading it runs any code in it."""
    rate: Annotated[float, arg("X")] = 1.0
    """Publish this many times as fast as it was recorded."""
    loop: Flag = False
    """Publish again and again, until Ctrl-C."""
    start_s: Annotated[float, arg("S", name="start")] = 0.0
    """Begin to publish this many seconds after the beginning."""
    run: Annotated[str, arg("NAME")] = "replay"
    """Name of the run in which the recording is published."""
    listen: Annotated[tuple[str, ...], arg("ENDPOINT ...")] = ()
    """Endpoints for the recorders and viewers of that run; if not given, the socket of an agent started by hand."""
    secure: Annotated[Path | None, arg("DIR")] = None
    """Folder of this host that `legpush secure init` made: publish over TLS alone, as a launcher; if --listen is not
    given, at port 17473 of 127.0.0.1."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        if not self.files:
            raise ConfigError("Expected the file of a recording, got none")
        if self.verify and self.as_role is not None:
            raise ConfigError("Expected either --verify or --as, got both")
        if self.secure is not None and (self.verify or self.as_role is not None):
            raise ConfigError("Expected --secure without --verify and --as: these start processes of their own")
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
    at: Annotated[str, arg("EPISODE:STEP")] = ""
    """The first step that differs from the recording, such as 0:12; `legpush info` lists episodes and steps."""
    policy: Annotated[str | None, arg("POLICY")] = None
    """Policy that chooses the pushes from that step on; if not given, that of the recording. Repeat that one if it runs
    code and you trust it."""
    past_policy: Annotated[str | None, arg("POLICY")] = None
    """The policy of the recording, repeated because it runs code and you trust it, where --policy is another one."""
    trust_policy_file: Flag = False
    """Load a model file (.zip) of Stable-Baselines3. It is a pickle: loading it runs any code in it."""
    planner: Annotated[PlannerName | None, arg()] = None
    """Search that the planner uses from that step on."""
    planner_command: Annotated[str | None, arg("COMMAND")] = None
    """Planner process from that step on."""
    changes: Changes = ()
    """Change the box from that step on: box.mass_kg, box.friction or box.foot_friction, such as box.mass_kg=0.9. The
    mission is not told about it. May be given several times."""
    out: Annotated[Path | None, arg("DIR")] = None
    """Folder of the run; `runs/<time>-<scenario>-seed<N>` if not given. An unfinished run in this folder continues."""
    record: Annotated[Path | None, arg("FILE")] = None
    """The new recording, which names the old one; FILE-branch-EPISODE-STEP.mcap if not given."""
    video: Flag = False
    """Render mission.mp4 at the end."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        if not self.files:
            raise ConfigError("Expected the file of a recording, got none")
        episode_and_step(self.at, "--at")
        self.changed_box()

    def changed_box(self) -> dict[str, float]:
        """Return the new numbers of the box, by the names that `Alter` has for them.

        Raises:
            ConfigError: A change is none of the box, or its number cannot be used.
        """
        from legpush.scenarios.changes import parse_changes

        changed = {}
        for path, value in parse_changes(self.changes).items():
            if path not in BOX_CHANGES:
                valid = ", ".join(BOX_CHANGES)
                raise ConfigError(f"Expected one of {valid} for --set of a branch, got {path}")
            name, kind = BOX_CHANGES[path]
            require(kind, value, f"--set {path}")
            changed[name] = float(value)
        return changed
