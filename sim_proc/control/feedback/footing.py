"""Footing: feet that lost the floor go down until they feel it again, while the others stay as they are."""

from math import ceil
from typing import Final

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.control.balance import foot_forces
from sim_proc.control.body_state import BodyState
from sim_proc.control.plant import TickLog
from sim_proc.control.posture import Posture
from sim_proc.gravity import GRAVITY_M_S2

REGAIN_SHARE: Final = 0.25
"""How far below its place a foot looks for the floor, as a share of the height at which the robot stands."""
HOLD_TICKS: Final = 8
"""How long the robot holds its legs after the last foot has landed."""
IN_AIR_SHARE: Final = 1e-4
"""Share of its full load planned for a foot that carries nothing: the forces stay determined."""


class Footing:
    """Regains the footing of a robot one or more of whose feet have slipped off an edge, or are still in the air."""

    def __init__(self, posture: Posture) -> None:
        """Move the robot that has this posture."""
        self._posture = posture
        robot = posture.plant.robot
        self._mass_kg = posture.plant.mass_kg
        self._contact_n = robot.gait.contact_share * self._mass_kg * GRAVITY_M_S2
        self._per_tick_m = robot.rough.reflex_m_s * CONTROL_PERIOD_S
        self._most_ticks = ceil(REGAIN_SHARE * robot.stance.height_m / self._per_tick_m)

    def run(self) -> list[TickLog]:
        """Lower all feet that carry nothing, each until it has felt something or has gone down as far as it may.

        Then the robot holds its legs for a moment, because feet that landed bounce.
        """
        plant, logs = self._posture.plant, list[TickLog]()
        tips_b, landed = self._posture.commanded_tips_b(), np.zeros(4, dtype=np.bool_)
        for tick in range(self._most_ticks):
            state = plant.body_state()
            down: Flags = state.loads_n >= self._contact_n
            measured_b = (state.tips_m - state.position_m) @ state.rotation
            begins = ~down & (tick == 0)
            lands = down & ~landed & (tick > 0)
            tips_b[begins | lands] = measured_b[begins | lands]
            landed |= down
            if landed.all():
                break
            tips_b[~landed] -= self._per_tick_m * state.rotation[2]
            logs.append(self._react(state, tips_b, landed))
            if plant.fallen:
                return logs
        for _ in range(HOLD_TICKS):
            logs.append(self._react(plant.body_state(), tips_b, landed))
            if plant.fallen:
                break
        return logs

    def _react(self, state: BodyState, tips_b: Floats, down: Flags) -> TickLog:
        return self._posture.react(tips_b, self._forces_n(state, down) @ state.rotation)

    def _forces_n(self, state: BodyState, down: Flags) -> Floats:
        """Vertical forces of the feet that are down, (4, 3), that carry the robot as far as they can."""
        shares = np.where(down, 1.0, IN_AIR_SHARE)[None]
        still = np.zeros((1, 2))
        forces: Floats = foot_forces(state.tips_m[None], shares, state.com_m[None, :2], still, self._mass_kg)[0]
        forces[:, 2] = np.clip(forces[:, 2], 0.0, self._mass_kg * GRAVITY_M_S2)
        return forces
