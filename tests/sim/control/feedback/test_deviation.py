"""What is usual, and how much more is allowed."""

import numpy as np
from msgspec.structs import replace

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
    alarm = watch.alarm(com, np.zeros_like(com))
    if alarm is None:
        deviation.learn(watch)
    return alarm is not None


def test_a_constant_deviation_becomes_usual_and_a_sudden_one_does_not() -> None:
    deviation = Deviation(CAPTURE, HEIGHT_M)
    assert has_alarm(deviation, 0.08)
    for beside_m in (0.05, 0.05, 0.05, 0.08, 0.08, 0.08):
        assert not has_alarm(deviation, beside_m)
    assert has_alarm(deviation, -0.03)


def test_after_a_trot_more_is_allowed_for_a_while_up_to_a_bound() -> None:
    deviation = Deviation(replace(CAPTURE, most_m=0.09), HEIGHT_M)
    deviation.allow_more()
    deviation.allow_more()
    assert has_alarm(deviation, 0.1)
    assert not has_alarm(deviation, 0.085, n_ticks=1)
    for _ in range(40):
        assert not has_alarm(deviation, 0.0)
    assert has_alarm(deviation, 0.07)


def test_a_motion_of_no_tick_teaches_nothing() -> None:
    deviation = Deviation(CAPTURE, HEIGHT_M)
    deviation.learn(deviation.watch(standing(3), 3))
    assert has_alarm(deviation, 0.07)
