"""Floors that are not flat: a floor with a tile that is higher or lower than its surroundings."""

import mujoco
import pytest

from legpush.arrays import Floats
from legpush.realism.reality import AS_ASSUMED, Reality
from legpush.scene.scenario import Scenario
from sim_proc.model.collisions import FLOOR, contact
from sim_proc.model.world import build_spec
from sim_proc.physics import physics
from tests.robots import ROBOT

THICKNESS_M = 0.5
FAR_M = 20.0


def lay_tile(monkeypatch: pytest.MonkeyPatch, centre_m: Floats, top_m: float, side_m: float = 0.2) -> None:
    """Build worlds whose floor is at `top_m` in a square about `centre_m` (2,), and at 0 around it."""

    def build_model(scenario: Scenario, reality: Reality = AS_ASSUMED) -> mujoco.MjModel:
        spec = build_spec(scenario, reality)
        spec.geom("floor").pos[2] = -2 * THICKNESS_M
        (x, y), half, far = centre_m, side_m / 2, FAR_M / 2
        for name, place, sides, top in (
            ("tile", (x, y), (half, half), top_m),
            ("east", (x + half + far, y), (far, FAR_M), 0.0),
            ("west", (x - half - far, y), (far, FAR_M), 0.0),
            ("north", (x, y + half + far), (half, far), 0.0),
            ("south", (x, y - half - far), (half, far), 0.0),
        ):
            spec.worldbody.add_geom(
                name=name,
                type=mujoco.mjtGeom.mjGEOM_BOX,
                pos=[*place, top - THICKNESS_M / 2],
                size=[*sides, THICKNESS_M / 2],
                **FLOOR,
                **contact(ROBOT.legs.foot_friction, priority=1),
            )
        return spec.compile()

    monkeypatch.setattr(physics, "build_model", build_model)
