"""Runs missions in this process: finds planner, simulator, policy and mission by name and calls them as functions."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn
from threadpoolctl import threadpool_limits

from legpush.errors import ConfigError, UnsolvableError
from legpush.fields import Seed, require
from legpush.history.steps import PlanRecord, StepRecord
from legpush.lockstep.local import LocalWorld
from legpush.lockstep.mission import Mission, Tell
from legpush.lockstep.simulator import Stepper
from legpush.numerics.current import tell_if_native
from legpush.output.screen import Screen
from legpush.plans.planner import MakePlans
from legpush.plugins import load_plugin
from legpush.policy_names import DEFAULT_POLICY, require_trust
from legpush.runs.report import Report
from legpush.scenarios.file import resolve_scenario
from legpush.scene.names import PlannerName, Steering
from legpush.scene.scenario import Scenario
from legpush.stepwise import StepwiseWorld

DEFAULT_PLANNER = "ompl"
DEFAULT_SIMULATOR = "mujoco"
DEFAULT_MISSION = "push"


@dataclass(frozen=True)
class MissionRun:
    """A finished mission."""

    report: Report
    """The numbers, as in `report.json`."""
    records: tuple[StepRecord | PlanRecord, ...]
    """Every step with its motion, outcome and trace, and every plan with its query, in order, from the reset on."""

    @property
    def success(self) -> bool:
        """Whether the box is at its goal."""
        return self.report.success

    @property
    def state_crc(self) -> str:
        """CRC-32 of the simulator's last state, eight hexadecimal digits; equal missions have the same one."""
        return self.report.state_crc


def run(
    scenario: str | Path | Scenario = "default",
    *,
    seed: int = 0,
    policy: object = DEFAULT_POLICY,
    trust_policy_file: bool = False,
    push_map: str | Path | None = None,
    planner: PlannerName | None = None,
    steering: Steering | None = None,
    turning_radius_m: float | None = None,
    changes: Mapping[str, Any] | None = None,
    progress: bool | Tell = False,
    planner_program: str = DEFAULT_PLANNER,
    simulator: str = DEFAULT_SIMULATOR,
    mission: str = DEFAULT_MISSION,
) -> MissionRun:
    """Run a whole mission in this process, as `legpush run` does in three.

    Numerics are those of this process, which is under the profile of `legpush run` if `legpush python` started it. If
    it can compute other bits, a warning is logged once.

    Args:
        scenario: The name of a built-in scenario, the path of a scenario file, or a record.
        seed: Seed of the offsets of start and box, and of the path. Equal seeds give equal missions, bit for bit, with
            the same `state_crc` as `legpush run` under equal numerics.
        policy: The policy that chooses the pushes: the name of a plug-in (`scripted`, `dynamic_programming`, `fixed`,
            `variable`), the path of a policy folder or model file, `module:function`, or an object with a method
            `decide`.
        trust_policy_file: Load a model file. It is a pickle: loading it runs any code in it.
        push_map: The push map of this box, measured by `legpush calibrate`.
        planner: Replaces the scenario's search, such as `rrt_star`.
        steering: Replaces the scenario's steering of paths; `dubins` and `reeds_shepp` need a turning radius.
        turning_radius_m: Replaces the least turning radius of the robot's paths, in m.
        changes: Other fields of the scenario by their path, such as `{"box.mass_kg": 2.0}`.
        progress: True shows a progress bar in a terminal or a notebook. A function gets phase, share and detail.
        planner_program: The plug-in that plans (`legpush.planners`).
        simulator: The plug-in that simulates (`legpush.simulators`).
        mission: The plug-in that carries out the mission (`legpush.missions`).

    Raises:
        ScenarioError: The scenario cannot be used.
        PluginError: A planner, simulator, policy or mission cannot be found or imported.
        PolicyError: The policy cannot be used, or raised an exception.
        UnsolvableError: The planner finds no path. Its `run` is the mission up to this error.
        ConfigError: Another argument cannot be used.
        BrokenEpisodeError: The simulator failed in a motion, such as at numbers that physics cannot carry.
        LegpushError: The base of all of these.
        KeyboardInterrupt: The user interrupted the mission.
    """
    require(Seed, seed, "seed")
    if isinstance(policy, str):
        require_trust(policy, trust_policy_file)
    resolved = resolve_scenario(
        scenario, planner=planner, steering=steering, turning_radius_m=turning_radius_m, changes=changes
    )
    make_plans = cast(MakePlans, load_plugin("legpush.planners", planner_program))
    make_simulator = load_plugin("legpush.simulators", simulator)
    run_mission = cast(Mission, load_plugin("legpush.missions", mission))
    tell_if_native()
    records: list[StepRecord | PlanRecord] = []
    with threadpool_limits(limits=1), _progress(progress) as tell:
        report = run_mission(
            LocalWorld(cast(Stepper, make_simulator()), make_plans, on_record=records.append),
            resolved,
            seed=seed,
            policy=policy,
            trust_policy_file=trust_policy_file,
            push_map=None if push_map is None else Path(push_map),
            records=records,
            tell=tell,
        )
    done = MissionRun(report, tuple(records))
    if report.reason == "no_path":
        raise UnsolvableError(f"{resolved.name}: {report.detail}", done)
    return done


@contextmanager
def world(
    scenario: str | Path | Scenario = "push",
    *,
    seed: int = 0,
    planner: PlannerName | None = None,
    steering: Steering | None = None,
    turning_radius_m: float | None = None,
    changes: Mapping[str, Any] | None = None,
    trace: bool = False,
    planner_program: str = DEFAULT_PLANNER,
    simulator: str = DEFAULT_SIMULATOR,
) -> Iterator[StepwiseWorld]:
    """Open a world to move step by step; it has been reset already.

    The arguments are those of `run`; with `trace`, every outcome has a trace of its ticks.

    Raises:
        ScenarioError: The scenario cannot be used.
        PluginError: The planner or the simulator cannot be found or imported.
        ConfigError: Another argument cannot be used.
    """
    require(Seed, seed, "seed")
    resolved = resolve_scenario(
        scenario, planner=planner, steering=steering, turning_radius_m=turning_radius_m, changes=changes
    )
    make_plans = cast(MakePlans, load_plugin("legpush.planners", planner_program))
    make_simulator = load_plugin("legpush.simulators", simulator)
    tell_if_native()
    with threadpool_limits(limits=1):
        yield StepwiseWorld(LocalWorld(cast(Stepper, make_simulator()), make_plans), resolved, seed, with_trace=trace)


@contextmanager
def _progress(progress: bool | Tell) -> Iterator[Tell]:
    """Yield a function that shows the progress of a mission."""
    if callable(progress):
        yield progress
        return
    if not isinstance(progress, bool):
        raise ConfigError(f"Expected a truth value or a function for progress, got {type(progress).__name__}")
    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TextColumn("{task.fields[detail]}"))
    bar = Progress(*columns, disable=not progress, transient=True)
    task = bar.add_task("starting", total=1.0, detail="")
    screen = Screen()

    def tell(phase: str, fraction: float | None, detail: str) -> None:
        screen.draw(lambda: bar.update(task, description=phase, completed=fraction or 0.0, detail=detail))

    screen.draw(bar.start)
    try:
        yield tell
    finally:
        screen.draw(bar.stop)
