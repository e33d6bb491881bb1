"""What is usual, and how much more is allowed."""

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.control.balance import ComPlan
from sim_proc.control.feedback.deviation import Deviation
from tests.robots import ROBOT

CAPTURE = ROBOT.capture
HEIGHT_M = ROBOT.stance.com_height_m


def standing(n_ticks: int) -> ComPlan:
    """A plan to stand at the origin."""
    nothing = np.zeros((n_ticks, 2))
    return ComPlan(position_m=nothing, velocity_m_s=nothing, acceleration_m_s2=nothing, zmp_m=nothing)


def has_alarm(deviation: Deviation, beside_m: float, n_ticks: int = 20) -> bool:
    """Whether a robot that stands beside its plan leaves it; if not, that is learned."""
    watch = deviation.watch(standing(n_ticks), n_ticks)
    com = np.tile([beside_m, 0.0, HEIGHT_M], (n_ticks, 1))
    alarm = watch.alarm(com, np.zeros_like(com), np.zeros((n_ticks, 4, 3)))
    if alarm is None:
        deviation.learn(watch, rough=False)
    return alarm is not None


def test_a_constant_deviation_becomes_usual_and_a_sudden_one_does_not() -> None:
    deviation = Deviation(CAPTURE, HEIGHT_M)
    assert has_alarm(deviation, 0.08)
    for beside_m in (0.05, 0.05, 0.05, 0.08, 0.08, 0.08):
        assert not has_alarm(deviation, beside_m)
    assert has_alarm(deviation, -0.03)


def test_after_a_trot_more_is_allowed_for_a_while_up_to_a_bound() -> None:
    deviation = Deviation(replace(CAPTURE, most_m=0.09), HEIGHT_M)
    for _ in range(4):
        deviation.allow_more()
    assert has_alarm(deviation, 0.1)
    assert not has_alarm(deviation, 0.085, n_ticks=1)
    for _ in range(40):
        assert not has_alarm(deviation, 0.0)
    assert has_alarm(deviation, 0.07)


def test_a_motion_of_no_tick_teaches_nothing() -> None:
    deviation = Deviation(CAPTURE, HEIGHT_M)
    deviation.learn(deviation.watch(standing(3), 3), rough=False)
    assert has_alarm(deviation, 0.07)


@pytest.mark.parametrize(
    ("told_ticks", "late_ticks", "found_ticks"), [(None, 0, 0), (None, 3, 3), (0, 3, 0), (2, 3, 2)]
)
def test_a_robot_that_does_everything_late_is_where_it_was_to_be_before(
    told_ticks: int | None, late_ticks: int, found_ticks: int
) -> None:
    """What the joints tell of a delay is believed, and not what looks like one."""
    deviation = Deviation(CAPTURE, HEIGHT_M)
    n_ticks, speed_m_s = 20, 0.5
    for begin in range(0, 10 * n_ticks, n_ticks):
        at_s = CONTROL_PERIOD_S * np.arange(begin, begin + n_ticks)
        place_m, velocity_m_s = np.sin(5 * at_s) * speed_m_s / 5, np.cos(5 * at_s) * speed_m_s
        plan = ComPlan(
            position_m=np.stack([place_m, np.zeros(n_ticks)], axis=1),
            velocity_m_s=np.stack([velocity_m_s, np.zeros(n_ticks)], axis=1),
            acceleration_m_s2=np.zeros((n_ticks, 2)),
            zmp_m=np.zeros((n_ticks, 2)),
        )
        deviation.tell(told_ticks)
        watch = deviation.watch(plan, n_ticks)
        earlier_s = at_s - CONTROL_PERIOD_S * late_ticks
        com, velocity = np.zeros((n_ticks, 3)), np.zeros((n_ticks, 3))
        com[:, 0], velocity[:, 0] = np.sin(5 * earlier_s) * speed_m_s / 5, np.cos(5 * earlier_s) * speed_m_s
        watch.alarm(com, velocity, np.zeros((n_ticks, 4, 3)))
        deviation.learn(watch, rough=False)
    assert deviation.late_ticks == found_ticks


def test_a_delay_that_the_joints_told_is_not_forgotten_with_what_the_motion_taught() -> None:
    deviation = Deviation(CAPTURE, HEIGHT_M)
    deviation.tell(5)
    beyond_m = CAPTURE.from_m + 4 * CAPTURE.late_m
    assert not has_alarm(deviation, beyond_m)
    deviation.forget()
    assert deviation.late_ticks == 5
    assert not has_alarm(deviation, beyond_m)
    deviation.tell(0)
    deviation.forget()
    assert has_alarm(deviation, beyond_m)
