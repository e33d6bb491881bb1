"""Capture steps: a robot that was thrown off its plan trots until its trunk is stopped.

Two diagonal feet stand while the other two step to where the trunk could come to rest, as the capture point of a linear
inverted pendulum tells. Nothing is planned ahead: each tick begins with what is measured.
"""

from math import atan2, hypot, radians, sqrt
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.scene.conventions import CONTROL_PERIOD_S, LEGS
from sim_proc.control.body_state import BodyState
from sim_proc.control.plant import TickLog
from sim_proc.control.posture import Posture
from sim_proc.control.swing import quintic
from sim_proc.gravity import GRAVITY_M_S2
from sim_proc.kinematics.leg import SIDE

PAIRS: Final = ((0, 3), (1, 2))
"""The diagonal pairs of feet."""
BESIDE: Final = (1, 0, 3, 2)
"""The other foot at the same end of the trunk, for each foot."""
ALONG_SHARE: Final = 0.9
"""Share of a step after which the foot only moves down."""


class CaptureTrot:
    """Trots on the spot until the trunk is stopped."""

    def __init__(self, posture: Posture, *, uneven: bool = False) -> None:
        """Move the robot that has this posture, on a floor that may be uneven."""
        self._uneven = uneven
        self._posture = posture
        robot = posture.plant.robot
        self._numbers, self._touchdown_m = robot.capture, robot.touchdown_m
        self._stance, self._corners_b = robot.stance, robot.stance.foot_rectangle_b()
        self._per_speed_s = sqrt(robot.stance.com_height_m / GRAVITY_M_S2)
        self._carried_n = posture.plant.mass_kg * GRAVITY_M_S2 / 2
        self._contact_n = robot.gait.contact_share * posture.plant.mass_kg * GRAVITY_M_S2
        self.n_footsteps = 0

    def run(self, lifted: int | None) -> list[TickLog]:
        """Trot, at first with the pair of a foot that is in the air, `lifted`, or with the one that carries less."""
        numbers, plant = self._numbers, self._posture.plant
        pair = self._first_pair(plant.body_state(), lifted)
        logs: list[TickLog] = []
        for n_steps in range(1, numbers.most_steps + 1):
            begin = plant.body_state()
            for tick in range(1, numbers.step_ticks + 1):
                logs.append(self._tick(PAIRS[pair], begin.tips_m, tick))
                if plant.fallen:
                    return logs
            pair = 1 - pair
            self.n_footsteps += 2
            if n_steps >= numbers.least_steps and self._stands(plant.body_state()):
                break
        return logs

    def _first_pair(self, state: BodyState, lifted: int | None) -> int:
        if lifted is not None:
            return int(lifted in PAIRS[1])
        carried = [float(state.loads_n[list(pair)].sum()) for pair in PAIRS]
        return int(carried[1] < carried[0])

    def _stands(self, state: BodyState) -> bool:
        tilt = hypot(state.rotation[2, 0], state.rotation[2, 1])
        speed_m_s = hypot(*state.velocity_m_s[:2].tolist())
        return speed_m_s < self._numbers.still_m_s and tilt < radians(self._numbers.level_deg)

    def _tick(self, swinging: tuple[int, int], from_m: Floats, tick: int) -> TickLog:
        """One tick of a step of two feet, which began at `from_m` (4, 3)."""
        numbers, state = self._numbers, self._posture.plant.body_state()
        u, left_s = tick / numbers.step_ticks, (numbers.step_ticks - tick) * CONTROL_PERIOD_S
        yaw_rad = atan2(state.rotation[1, 0], state.rotation[0, 0])
        trunk = Pose2(x_m=float(state.position_m[0]), y_m=float(state.position_m[1]), yaw_rad=yaw_rad)
        from_world = trunk.inverse()
        standing = [leg for leg in range(len(LEGS)) if leg not in swinging or self._is_down(leg, state, u)]
        ground_m = float(from_m[[leg for leg in range(len(LEGS)) if leg not in swinging], 2].mean())
        velocity_b = Pose2(x_m=0.0, y_m=0.0, yaw_rad=-yaw_rad).apply(state.velocity_m_s[None, :2])[0]
        feet_b, forces = np.empty((4, 3)), np.zeros((4, 3))
        tips_b, begun_b = from_world.apply(state.tips_m[:, :2]), from_world.apply(from_m[:, :2])
        share, sunk = float(quintic(np.minimum(u / ALONG_SHARE, 1.0))), float(quintic(np.array(u)))
        followed = CONTROL_PERIOD_S * (1 - numbers.brake_share)
        for leg in range(len(LEGS)):
            if leg in standing:
                feet_b[leg, :2] = tips_b[leg] - velocity_b * followed
                feet_b[leg, 2] = state.tips_m[leg, 2] if self._uneven else ground_m
                forces[leg, 2] = self._carried_n if leg not in swinging else 0.0
                continue
            target_b = self._target_b(leg, velocity_b, tips_b) + velocity_b * left_s
            feet_b[leg, :2] = begun_b[leg] + share * (target_b - begun_b[leg]) - velocity_b * CONTROL_PERIOD_S
            rise_m = numbers.step_height_m * 16 * u**2 * (1 - u) ** 2
            feet_b[leg, 2] = ground_m + rise_m + (1 - sunk) * (from_m[leg, 2] - ground_m)
        feet_b[:, 2] -= ground_m - self._touchdown_m + self._stance.height_m
        return self._posture.react(feet_b, forces)

    def _is_down(self, leg: int, state: BodyState, u: float) -> bool:
        """Whether a foot that has come a share `u` of its step stands on something higher than expected."""
        return self._uneven and u > 0.5 and bool(state.loads_n[leg] > self._contact_n)

    def _target_b(self, leg: int, velocity_b: Floats, tips_b: Floats) -> Floats:
        """Where a foot is to land, (2,), seen from the trunk at that time: within reach, and apart from its neighbour.

        `tips_b` (4, 2) is where the feet are now.
        """
        numbers, side, beside = self._numbers, float(SIDE[leg]), BESIDE[leg]
        x, y = (self._corners_b[leg] + velocity_b * self._per_speed_s).tolist()
        corner_x = float(self._corners_b[leg, 0])
        x = min(max(x, corner_x - numbers.forward_m), corner_x + numbers.forward_m)
        outward = min(max(side * y, numbers.inward_m), numbers.outward_m)
        outward = max(outward, side * float(tips_b[beside, 1]) + numbers.apart_m)
        return np.array([x, side * outward])
