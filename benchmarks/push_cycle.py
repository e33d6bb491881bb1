"""`python -m benchmarks.push_cycle`: what control adds to the time of physics in push and gait cycles, and their speed.

Two measurements take turns in one process: the simulator's whole cycle (planning, kinematics, feed-forward, recording),
and the bare `mj_step` calls that it contains, from the same states with the same controls. Gait cycles are those of
missions' walks to the box. The numbers go to `results/push_cycle.json`.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import tyro

from agent_proc.statistics.intervals import median
from benchmarks.report import write_report
from experiments.tables.parts import plain
from legpush.lockstep.local import LocalWorld
from legpush.messages.stepping import Motion, Outcome, Push, Reset, Walk
from legpush.scenarios.file import load_scenario
from legpush.scene.conventions import CONTROL_PERIOD_S, FRONT_LEGS
from legpush.stepwise import StepwiseWorld
from planner_proc.planning import make_plans
from sim_proc.control.joint_commands import JointCommands
from sim_proc.control.plant import TickLog, Touchdown
from sim_proc.control.watch import Watch
from sim_proc.headless import mujoco
from sim_proc.physics import physics
from sim_proc.simulator import Simulator

STATE = mujoco.mjtState.mjSTATE_INTEGRATION


@dataclass(frozen=True, kw_only=True)
class Config:
    """Length of the measurement."""

    n_cycles: int = 60
    """Number of cycles of each kind, each measured both ways."""


@dataclass(frozen=True, kw_only=True)
class Cycle:
    """One cycle, measured both ways."""

    cycle_s: float
    bare_s: float
    simulated_s: float
    is_repeated: bool
    """Whether the bare steps end in the same state. They do not if actuators met their limits at angles and speeds."""


def main(config: Config) -> None:
    """Measure both kinds of cycles and report their ratios."""
    simulator = TimedSimulator()
    pushes, gait = _pushes(simulator, config.n_cycles), _gait_cycles(simulator, config.n_cycles)
    write_report("push_cycle", {**_numbers(pushes), "walking": _numbers(gait)})


class TimedSimulator:
    """A simulator whose push and gait cycles are measured both ways."""

    def __init__(self) -> None:
        self._simulator = Simulator()
        self._controls: list[np.ndarray] = []
        _collect_controls(self._controls)
        self._bare: mujoco.MjData | None = None
        """The data of the bare steps since the last reset."""
        self.cycles: list[Cycle] = []
        """The push and gait cycles since the last reset."""

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        """Carry out one motion; repeat a push or a gait cycle by bare steps."""
        if isinstance(motion, Reset):
            self.cycles, self._bare = [], None
        if self._simulator.episode is None or not isinstance(motion, Push | Walk):
            return self._simulator.perform(motion, with_trace=with_trace)
        world = self._simulator.episode.physics
        self._bare = data = self._bare or mujoco.MjData(world.model)
        state = np.empty(mujoco.mj_stateSize(world.model, STATE))
        mujoco.mj_getState(world.model, world.data, state, STATE)
        self._controls.clear()
        began = time.perf_counter()
        outcome = self._simulator.perform(motion, with_trace=with_trace)
        cycle_s = time.perf_counter() - began
        controls = np.concatenate(self._controls)
        mujoco.mj_setState(world.model, data, state, STATE)
        began = time.perf_counter()
        for control in controls.reshape(-1, world.model.nu):
            data.ctrl[:] = control
            mujoco.mj_step(world.model, data)
        bare_s = time.perf_counter() - began
        self.cycles.append(
            Cycle(
                cycle_s=cycle_s,
                bare_s=bare_s,
                simulated_s=len(controls) * CONTROL_PERIOD_S,
                is_repeated=np.array_equal(data.qpos, world.data.qpos),
            )
        )
        return outcome


def _pushes(simulator: TimedSimulator, n_cycles: int) -> list[Cycle]:
    """Push cycles with random curves and both feet, one after the other."""
    simulator.perform(Reset(scenario=load_scenario("push"), seed=0), with_trace=False)
    rng = np.random.default_rng(0)
    for index in range(n_cycles):
        push = Push(w1=rng.uniform(), w2=rng.uniform(), leg=FRONT_LEGS[index % 2], depth_m=0.03)
        simulator.perform(push, with_trace=False)
    return simulator.cycles


def _gait_cycles(simulator: TimedSimulator, n_cycles: int) -> list[Cycle]:
    """Gait cycles along the paths of missions with seeds from 0."""
    cycles: list[Cycle] = []
    seed = 0
    while len(cycles) < n_cycles:
        walking = StepwiseWorld(LocalWorld(simulator, make_plans), load_scenario("default"), seed)
        walking.follow(walking.plan())
        while (path := walking.state.path) is not None and not path.done:
            walking.walk()
        cycles += simulator.cycles
        seed += 1
    return cycles[:n_cycles]


def _numbers(cycles: Sequence[Cycle]) -> dict[str, Any]:
    """The numbers of one kind of cycle, without those that bare steps did not repeat.

    Raises:
        RuntimeError: They did not repeat more than a tenth.
    """
    n_cycles = len(cycles)
    cycles = [cycle for cycle in cycles if cycle.is_repeated]
    if len(cycles) < 0.9 * n_cycles:
        raise RuntimeError(f"Of {n_cycles} cycles bare steps repeated only {len(cycles)}: the comparison is void")
    cycle_s, bare_s, simulated_s = (
        np.array([getattr(cycle, name) for cycle in cycles]) for name in ("cycle_s", "bare_s", "simulated_s")
    )
    ratio = cycle_s / bare_s
    low, high = np.percentile(ratio, [5, 95]).tolist()
    return {
        "n": len(ratio),
        "n_at_limits": n_cycles - len(cycles),
        "over_bare_steps": plain(median(ratio.tolist()), 4),
        "low": round(low, 4),
        "high": round(high, 4),
        "cycle_ms": round(float(np.median(cycle_s)) * 1e3, 2),
        "simulated_s": round(float(np.median(simulated_s)), 3),
        "times_real_time": round(float(np.median(simulated_s / cycle_s)), 1),
    }


def _collect_controls(controls: list[np.ndarray]) -> None:
    """Make `Physics.run` append its servo commands to the list from now on."""
    run = physics.Physics.run

    def run_and_collect(
        self: physics.Physics, commands: JointCommands, until: Touchdown | None = None, watch: Watch | None = None
    ) -> TickLog:
        recording = run(self, commands, until, watch)
        controls.append(recording.ctrl)
        return recording

    physics.Physics.run = run_and_collect  # type: ignore[method-assign]


if __name__ == "__main__":
    main(tyro.cli(Config))
