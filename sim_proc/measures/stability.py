"""How firmly the robot stands at every physics step: margins of three points, and the moment of the feet about the CoM.

The points are the projection of the centre of mass, the zero-moment point and the capture point. Each is compared with
the support polygon of the loaded feet.
"""

from dataclasses import dataclass

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.scene.conventions import LOADED_N
from legpush.scene.robot import RobotSpec
from sim_proc.control.plant import StepLog
from sim_proc.gravity import GRAVITY_M_S2
from sim_proc.measures.support import support_margins


@dataclass(frozen=True, kw_only=True)
class Margins:
    """Distances to the border of the support polygon, positive inside, (n,) each."""

    support_m: Floats
    """Of the projection of the centre of mass."""
    zmp_m: Floats
    """Of the zero-moment point."""
    capture_m: Floats
    """Of the capture point."""


def zero_moment_points(tips_m: Floats, loads_n: Floats, com_m: Floats) -> Floats:
    """Centres of pressure of the feet, (n, 2), from their centres (n, 4, 3) and vertical forces (n, 4).

    A robot that no foot carries has none. Its place is taken by the point below the CoM, from `com_m` (n, 3).
    """
    total = loads_n.sum(axis=1, keepdims=True)
    pressure = np.einsum("nl,nli->ni", loads_n, tips_m[:, :, :2]) / np.maximum(total, LOADED_N)
    return np.where(total >= LOADED_N, pressure, com_m[:, :2])


def capture_points(com_m: Floats, com_velocity_m_s: Floats, downhill: Floats, height_m: float) -> Floats:
    """Capture points on the floor, (n, 2), of a linear inverted pendulum of height `height_m`.

    A robot whose zero-moment point stays there comes to rest above it. `com_m` and `com_velocity_m_s` are (n, 3), and
    `downhill` (2,) is that of the plant: on a slope the pendulum rests where a plumb line ends.
    """
    below: Floats = com_m[:, :2] + com_m[:, 2:] * downhill
    points: Floats = below + com_velocity_m_s[:, :2] / np.sqrt(GRAVITY_M_S2 / height_m)
    return points


def margins(steps: StepLog, loaded: Flags, downhill: Floats, robot: RobotSpec) -> Margins:
    """Margins in each of n physics steps, whose loaded feet are (n, 4)."""
    com, tips = steps.com_m.reshape(-1, 3), steps.tips_m.reshape(-1, 4, 3)
    loads = steps.floor_forces_n.reshape(-1, 4, 3)[:, :, 2]
    velocity = steps.com_velocity_m_s.reshape(-1, 3)
    points = np.stack(
        [
            com[:, :2] + com[:, 2:] * downhill,
            zero_moment_points(tips, loads, com),
            capture_points(com, velocity, downhill, robot.stance.com_height_m),
        ]
    )
    support, zmp, capture = support_margins(points, tips[:, :, :2], loaded)
    return Margins(support_m=support, zmp_m=zmp, capture_m=capture)


def foot_moments_n_m(
    tips_m: Floats, floor_forces_n: Floats, box_forces_n: Floats, com_m: Floats, foot_radius_m: float
) -> Floats:
    """Moments of all forces on the feet about the centre of mass, (n, 3), the sum of Eq. 9.

    Feet and forces are (n, 4, 3), and `com_m` is (n, 3). A force of the floor acts at the lowest point of the foot's
    sphere. A force of the box acts at its centre, which is exact for the part that is normal to the face; friction acts
    a radius nearer to the box, which is left out.

    Eq. 9 sets the sum to zero, which holds for a robot whose parts do not rotate. The sum is the rate of change of the
    angular momentum about the CoM as long as nothing but feet touches anything: a leg that swings and a trunk that
    sways need a moment.
    """
    x, y, z = (tips_m - com_m[:, None]).transpose(2, 1, 0)
    fx, fy, fz = (floor_forces_n + box_forces_n).transpose(2, 1, 0)
    floor_x, floor_y, _ = floor_forces_n.transpose(2, 1, 0)
    moments = (
        y * fz - z * fy + foot_radius_m * floor_y,
        z * fx - x * fz - foot_radius_m * floor_x,
        x * fy - y * fx,
    )
    return np.stack([moment.sum(axis=0) for moment in moments], axis=1)
