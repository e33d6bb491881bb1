"""Robots that tests use: the default one, and others that are made from it."""

from typing import Any

import msgspec

from legpush.scene.robot import RobotSpec
from sim_proc.kinematics.leg import LegKinematics

ROBOT = RobotSpec()
CIRCLE_M = ROBOT.stance.foot_circle_m
KINEMATICS = LegKinematics(ROBOT)

POWERS = {"_kg_m2": 5.0, "_n_m_s_rad": 4.5, "_n_m_rad": 4.0, "_kg": 3.0, "_m": 1.0}
"""How a number scales with the length of a robot of equal density and shape, by the unit in its name."""


def scaled_robot(scale: float) -> RobotSpec:
    """The default robot with all lengths multiplied by `scale`, and masses and servos that fit them."""
    return msgspec.convert(_scaled(msgspec.to_builtins(ROBOT), scale), RobotSpec)


def _scaled(table: dict[str, Any], scale: float) -> dict[str, Any]:
    scaled: dict[str, Any] = {}
    for name, value in table.items():
        power = next((power for unit, power in POWERS.items() if name.endswith(unit)), 0.0)
        if isinstance(value, dict):
            scaled[name] = _scaled(value, scale)
        elif power == 0.0 or value is None:
            scaled[name] = value
        elif isinstance(value, (list, tuple)):
            scaled[name] = [each * scale**power for each in value]
        else:
            scaled[name] = value * scale**power
    return scaled
