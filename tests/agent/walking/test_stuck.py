"""A robot that stays where it is is stuck at once; one that moves to and fro gets more time."""

from agent_proc.walking.stuck import STILL_CYCLES, THROWN_CYCLES, is_stuck
from legpush.geometry import Pose2


def test_a_robot_that_moves_to_and_fro_gets_more_time() -> None:
    still = [(Pose2(x_m=0.001 * k, y_m=0.0, yaw_rad=0.0), 0.001 * k) for k in range(STILL_CYCLES + 1)]
    to_and_fro = [(Pose2(x_m=0.2 * (k % 2), y_m=0.0, yaw_rad=0.0), 0.2 * (k % 2)) for k in range(THROWN_CYCLES + 1)]

    assert is_stuck(still, 0.8)
    assert not is_stuck(still[:-1], 0.8)
    assert not is_stuck(to_and_fro[:-1], 0.8)
    assert is_stuck(to_and_fro, 0.8)
