"""`python -m benchmarks.push_cycle`: time that control adds to physics in a push cycle, and speed over real time.

Two measurements take turns in one process: the simulator's whole push cycle (planning, kinematics, feed-forward,
recording), and the bare `mj_step` calls that it contains, from the same states with the same controls. The
numbers go to `results/push_cycle.json`.
"""

import time
from dataclasses import dataclass

import numpy as np
import tyro

from agent_proc.statistics.intervals import median
from benchmarks.report import write_report
from experiments.tables.parts import plain
from legpush.messages.stepping import Push, Reset
from legpush.scenarios.file import load_scenario
from legpush.scene.conventions import CONTROL_PERIOD_S, FRONT_LEGS
from sim_proc.control.joint_commands import JointCommands
from sim_proc.control.plant import TickLog, Touchdown
from sim_proc.headless import mujoco
from sim_proc.physics import physics
from sim_proc.simulator import Simulator

STATE = mujoco.mjtState.mjSTATE_INTEGRATION


@dataclass(frozen=True, kw_only=True)
class Config:
    """Length of the measurement."""

    n_cycles: int = 60
    """Number of push cycles, each measured both ways."""


def main(config: Config) -> None:
    """Measure both and report their ratio."""
    simulator = Simulator()
    simulator.perform(Reset(scenario=load_scenario("push"), seed=0), with_trace=False)
    if simulator.episode is None:
        raise RuntimeError("Expected an episode after the reset, got none")
    world = simulator.episode.physics
    controls: list[np.ndarray] = []
    _collect_controls(controls)
    bare_data = mujoco.MjData(world.model)
    state = np.empty(mujoco.mj_stateSize(world.model, STATE))
    rng = np.random.default_rng(0)
    cycle_s, bare_s, n_ticks = [], [], []
    for index in range(config.n_cycles):
        push = Push(w1=rng.uniform(), w2=rng.uniform(), leg=FRONT_LEGS[index % 2], depth_m=0.03)
        mujoco.mj_getState(world.model, world.data, state, STATE)
        controls.clear()
        began = time.perf_counter()
        simulator.perform(push, with_trace=False)
        cycle_s.append(time.perf_counter() - began)
        mujoco.mj_setState(world.model, bare_data, state, STATE)
        began = time.perf_counter()
        for control in np.concatenate(controls).reshape(-1, world.model.nu):
            bare_data.ctrl[:] = control
            mujoco.mj_step(world.model, bare_data)
        bare_s.append(time.perf_counter() - began)
        if not np.array_equal(bare_data.qpos, world.data.qpos):
            raise RuntimeError("The bare steps ended in another state: the comparison is void")
        n_ticks.append(sum(len(part) for part in controls))
    ratio = np.array(cycle_s) / np.array(bare_s)
    real_time = np.array(n_ticks) * CONTROL_PERIOD_S / np.array(cycle_s)
    low, high = np.percentile(ratio, [5, 95]).tolist()
    write_report(
        "push_cycle",
        {
            "n": len(ratio),
            "over_bare_steps": plain(median(ratio.tolist()), 4),
            "low": round(low, 4),
            "high": round(high, 4),
            "cycle_ms": round(float(np.median(cycle_s)) * 1e3, 2),
            "simulated_s": round(float(np.median(n_ticks)) * CONTROL_PERIOD_S, 3),
            "times_real_time": round(float(np.median(real_time)), 1),
        },
    )


def _collect_controls(controls: list[np.ndarray]) -> None:
    """Make `Physics.run` append its servo commands to the list from now on."""
    run = physics.Physics.run

    def run_and_collect(self: physics.Physics, commands: JointCommands, until: Touchdown | None = None) -> TickLog:
        recording = run(self, commands, until)
        controls.append(recording.ctrl)
        return recording

    physics.Physics.run = run_and_collect  # type: ignore[method-assign]


if __name__ == "__main__":
    main(tyro.cli(Config))
