"""`python -m benchmarks.robot.collision_cost`: what it costs that every link of the robot collides.

Recorded controls are simulated again, in turn with the model as it is and with one in which only feet, trunk and box
touch floor and walls, from the same state. The numbers go to `results/collision_cost.json`.
"""

import time
from dataclasses import dataclass
from math import hypot, sqrt
from typing import Final

import numpy as np
import tyro
from msgspec.structs import replace

from agent_proc.statistics.intervals import median
from benchmarks.report import write_report
from benchmarks.robot.alterations import stepped_by
from experiments.tables.parts import plain
from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.messages.stepping import Follow, Push, Reset, Walk
from legpush.scenarios.file import load_scenario
from legpush.scene.conventions import FRONT_LEGS, LEGS
from legpush.scene.scenario import Rectangle, Scenario
from sim_proc.headless import mujoco
from sim_proc.model.collisions import WALL, WALL_FRICTION
from sim_proc.model.world import build_model, build_spec
from sim_proc.physics.state_crc import STATE
from sim_proc.simulator import Simulator

N_WALLS: Final = (0, 100, 1000)
"""Numbers of pillars that are put into the room of `default`, besides its own walls."""
PILLAR_M: Final = 0.6
WALK_M: Final = 2.4


@dataclass(frozen=True, kw_only=True)
class Config:
    """Length of the measurement."""

    repeats: int = 12
    """How often each model simulates the controls."""


def main(config: Config) -> None:
    """Measure the cost with each number of walls."""
    cases = {"push": (load_scenario("push"), True)}
    cases |= {f"default and {n} walls": (_with_pillars(load_scenario("default"), n), False) for n in N_WALLS}
    write_report(
        "collision_cost",
        {
            "n": config.repeats,
            "over_listed_pairs": {
                name: plain(median(_ratios(scenario, pushes, config.repeats)), 3)
                for name, (scenario, pushes) in cases.items()
            },
        },
    )


def _with_pillars(scenario: Scenario, n: int) -> Scenario:
    """Put pillars into a room that is made as large as they need, away from the walk."""
    random, side_m = np.random.default_rng(0), max(*scenario.room.size_m, 2 * sqrt(n))
    walls = list(scenario.room.obstacles)
    while len(walls) < len(scenario.room.obstacles) + n:
        x_m, y_m = random.uniform(0.0, side_m - PILLAR_M, size=2).tolist()
        if all(hypot(x_m - place.x_m, y_m - place.y_m) > WALK_M for place in (scenario.start, scenario.box.pose)):
            walls.append(Rectangle(x_min_m=x_m, x_max_m=x_m + PILLAR_M, y_min_m=y_m, y_max_m=y_m + PILLAR_M))
    return replace(scenario, room=replace(scenario.room, size_m=(side_m, side_m), obstacles=tuple(walls)))


def _ratios(scenario: Scenario, pushes: bool, repeats: int) -> list[float]:
    """CPU time of the model as it is over that of listed pairs alone."""
    state, controls = _recorded(scenario, pushes)
    listed, whole = _listed_pairs_alone(scenario), build_model(scenario)
    ratios = []
    for _ in range(repeats):
        (listed_s, ended_so), (whole_s, ended) = (_simulate(model, state, controls) for model in (listed, whole))
        if not np.array_equal(ended_so, ended):
            raise RuntimeError("Expected motions in which nothing else touches, got other states: the ratio is void")
        ratios.append(whole_s / listed_s)
    return ratios


def _recorded(scenario: Scenario, pushes: bool) -> tuple[Floats, Floats]:
    """A state and the controls (n, 12) of the motions that follow it."""
    simulator = Simulator()
    simulator.perform(Reset(scenario=scenario, seed=0), with_trace=False)
    if simulator.episode is None:
        raise RuntimeError("Expected an episode after the reset, got none")
    world = simulator.episode.physics
    state = np.empty(mujoco.mj_stateSize(world.model, STATE))
    mujoco.mj_getState(world.model, world.data, state, STATE)
    controls: list[Floats] = []
    step = mujoco.mj_step

    def step_and_keep(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        controls.append(data.ctrl.copy())
        step(model, data)

    with stepped_by(step_and_keep):
        if pushes:
            for leg in FRONT_LEGS:
                simulator.perform(Push(w1=0.5, w2=0.5, leg=leg, depth_m=0.05), with_trace=False)
        else:
            trunk = world.trunk_pose()
            ahead = (
                trunk @ Pose2(x_m=at_m, y_m=0.0, yaw_rad=0.0) for at_m in np.linspace(0.0, WALK_M / 2, 13).tolist()
            )
            simulator.perform(Follow(waypoints=tuple(ahead)), with_trace=False)
            for _ in range(2):
                simulator.perform(Walk(), with_trace=False)
    return state, np.array(controls)


def _listed_pairs_alone(scenario: Scenario) -> mujoco.MjModel:
    """A model with listed pairs alone: its own ones, and feet, trunk and box with each wall."""
    spec = build_spec(scenario)
    walls = [geom for geom in spec.geoms if geom.name.startswith("wall_")]
    parts = [f"{leg}_foot" for leg in LEGS] + ["trunk"] + [g.name for g in spec.geoms if g.name in ("box", "box_1")]
    friction = [WALL_FRICTION, WALL_FRICTION, 0.005, 0.0001, 0.0001]
    for wall in walls:
        for part in parts:
            spec.add_pair(
                geomname1=wall.name, geomname2=part, friction=friction, condim=WALL["condim"], solref=WALL["solref"]
            )
    model = spec.compile()
    for bits in (model.geom_contype, model.geom_conaffinity, model.body_contype, model.body_conaffinity):
        bits[:] = 0
    return model


def _simulate(model: mujoco.MjModel, state: Floats, controls: Floats) -> tuple[float, Floats]:
    """CPU seconds of the bare steps, and the state at their end."""
    data = mujoco.MjData(model)
    mujoco.mj_setState(model, data, state, STATE)
    began_s = time.process_time()
    for control in controls:
        data.ctrl[:] = control
        mujoco.mj_step(model, data)
    return time.process_time() - began_s, data.qpos.copy()


if __name__ == "__main__":
    main(tyro.cli(Config))
