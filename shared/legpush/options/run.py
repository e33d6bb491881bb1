"""Options of `legpush run`."""

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from legpush.bounds import BoxMass, Distance, Friction, WaitS
from legpush.errors import ConfigError
from legpush.fields import Seed, require
from legpush.options.checks import program_path, require_new_file
from legpush.policy_names import DEFAULT_POLICY, require_trust
from legpush.realism.settings import Profile
from legpush.scene.names import PlannerName, Steering

if TYPE_CHECKING:
    from legpush.scene.scenario import Scenario


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """Run a mission: start planner, simulator and agent, watch over them, and report.

    Exit codes: 0 the box is at its goal, 1 it is not, 2 bad input, 3 gave up on a process, 5 the disk
    is full, 130 interrupted.
    """

    scenario: Annotated[str, tyro.conf.arg(metavar="NAME|FILE")] = "default"
    """A built-in scenario (`legpush scenarios list`) or the path of a scenario file."""
    seed: Annotated[int, tyro.conf.arg(metavar="N")] = 0
    """Seed of the offsets of start and box, and of the path. Equal seeds give equal missions, bit for bit."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    """Folder of the run; `runs/<time>-<scenario>-seed<N>` if not given. An unfinished run in this folder continues."""
    policy: Annotated[str, tyro.conf.arg(metavar="POLICY")] = DEFAULT_POLICY
    """Policy that chooses the pushes: scripted, the name of a shipped policy, a policy folder, a model file (.zip), or
    module:factory."""
    trust_policy_file: bool = False
    """Load a model file (.zip) of Stable-Baselines3. It is a pickle: loading it runs any code in it."""
    push_map: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Push map of this box, measured by `legpush calibrate`. If not given, that of the default box is scaled."""
    planner_command: Annotated[str | None, tyro.conf.arg(metavar="COMMAND")] = None
    """Another planner process, such as "python examples/grid_planner.py"; `docs/protocol.md` says what it must do."""
    planner: PlannerName | None = None
    """Replaces the scenario's planner."""
    steering: Steering | None = None
    """Replaces the scenario's steering of paths; dubins and reeds_shepp need a turning radius."""
    turning_radius_m: Annotated[float | None, tyro.conf.arg(metavar="M")] = None
    """Replaces the scenario's least turning radius of the robot's paths."""
    box_mass_kg: Annotated[float | None, tyro.conf.arg(metavar="KG")] = None
    """Replaces the scenario's box mass."""
    box_friction: Annotated[float | None, tyro.conf.arg(metavar="MU")] = None
    """Replaces the scenario's friction of box and floor."""
    box_foot_friction: Annotated[float | None, tyro.conf.arg(metavar="MU")] = None
    """Replaces the scenario's friction of box and foot."""
    realism: Profile | None = None
    """Replaces the scenario's profile of `realism`: how the world differs from what the robot takes it to be."""
    record: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Record all messages of the processes into this new MCAP file; see `legpush replay`."""
    picture: bool = True
    """Draw mission.png at the end."""
    video: bool = True
    """Render mission.mp4 at the end."""
    deadline_s: Annotated[float | None, tyro.conf.arg(name="deadline", metavar="S")] = None
    """Give up if the mission is not over after this many seconds."""
    inject_faults: Annotated[float, tyro.conf.arg(metavar="P")] = 0.0
    """For tests: drop, duplicate, delay and reorder messages between the processes, each with this probability."""

    def __post_init__(self) -> None:
        require(Seed, self.seed, "--seed")
        require_trust(self.policy, self.trust_policy_file)
        if not 0.0 <= self.inject_faults < 1.0:
            raise ConfigError(f"Expected a probability in [0, 1) for --inject-faults, got {self.inject_faults}")
        if self.record is not None:
            require_new_file(self.record, "--record")
        if self.planner_command is not None:
            split_command(self.planner_command)
        require(WaitS, self.deadline_s, "--deadline", "seconds")
        require(Distance, self.turning_radius_m, "--turning-radius-m")
        require(BoxMass, self.box_mass_kg, "--box-mass-kg")
        require(Friction, self.box_friction, "--box-friction")
        require(Friction, self.box_foot_friction, "--box-foot-friction")

    def resolved_scenario(self) -> "Scenario":
        """Return the scenario, with the values that these options replace.

        Raises:
            ScenarioError: The scenario, or a value of these options, cannot be used.
        """
        from legpush.scenarios.file import resolve_scenario

        return resolve_scenario(
            self.scenario,
            planner=self.planner,
            steering=self.steering,
            turning_radius_m=self.turning_radius_m,
            changes={
                "box.mass_kg": self.box_mass_kg,
                "box.friction": self.box_friction,
                "box.foot_friction": self.box_foot_friction,
                "realism.profile": self.realism,
            },
        )


def split_command(command: str) -> tuple[str, ...]:
    """Split the command of a planner into its program, with its absolute path, and the arguments.

    Raises:
        ConfigError: The text cannot be parsed, or there is no such program.
    """
    try:
        words = shlex.split(command)
    except ValueError as error:
        raise ConfigError(f"Expected a command for --planner-command, got {command!r} ({error})") from error
    if not words:
        raise ConfigError("Expected a command for --planner-command, got nothing")
    return (program_path(words[0]), *words[1:])
