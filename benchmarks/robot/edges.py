"""Floors with one step, for benchmarks of the robot."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final
from unittest.mock import patch

import mujoco

from benchmarks.robot.motions import ROOM_M, START_M
from legpush.realism.reality import AS_ASSUMED, Reality
from legpush.scene.scenario import Scenario
from sim_proc.model.actual import actual_robot
from sim_proc.model.collisions import FLOOR, FOOT_SOLREF, contact
from sim_proc.model.world import build_spec
from sim_proc.physics import physics

THICKNESS_M: Final = 0.5


@contextmanager
def floor_with_edge(edge_m: float, height_m: float) -> Iterator[None]:
    """Build worlds whose floor is higher from `edge_m` ahead of the start of a straight walk on."""

    def build_model(scenario: Scenario, reality: Reality = AS_ASSUMED) -> mujoco.MjModel:
        spec = build_spec(scenario, reality)
        friction = actual_robot(scenario.robot, reality).legs.foot_friction
        half_m = (ROOM_M - START_M - edge_m) / 2
        spec.worldbody.add_geom(
            name="step",
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=[START_M + edge_m + half_m, ROOM_M / 2, height_m - THICKNESS_M / 2],
            size=[half_m, ROOM_M / 2, THICKNESS_M / 2],
            **(FLOOR | contact(friction, priority=1) | {"solref": FOOT_SOLREF}),
        )
        return spec.compile()

    with patch.object(physics, "build_model", build_model):
        yield
