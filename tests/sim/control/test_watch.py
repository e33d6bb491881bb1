"""Whether a motion is as planned."""

import numpy as np

from sim_proc.control.watch import Watch

PER_SPEED_S = 0.2


FEET = np.zeros((3, 4, 3))
"""Feet that stay on a level floor."""


def watch(allowed_m: float = 0.06, usual_m: tuple[float, float] = (0.0, 0.0)) -> Watch:
    """A watch over three ticks in which the robot is to stand."""
    return Watch(np.zeros((3, 2)), PER_SPEED_S, np.array(usual_m), allowed_m)


def test_a_robot_that_stands_where_it_is_to_stand_raises_no_alarm() -> None:
    assert watch().alarm(np.zeros((3, 3)), np.zeros((3, 3)), FEET) is None


def test_the_first_tick_with_too_much_way_and_speed_raises_an_alarm() -> None:
    com, velocity = np.zeros((3, 3)), np.zeros((3, 3))
    com[1:, 0], velocity[1:, 0] = 0.03, [0.1, 0.2]
    watching = watch()
    assert watching.alarm(com, velocity, FEET) == 2
    np.testing.assert_allclose(watching.deviations_m, [[0.0, 0.0], [0.05, 0.0], [0.07, 0.0]])
    assert watch(allowed_m=0.04).alarm(com, velocity, FEET) == 1


def test_what_is_usual_is_no_alarm_and_the_height_does_not_count() -> None:
    com = np.full((2, 3), 0.07)
    assert watch().alarm(com, np.zeros((2, 3)), FEET[:2]) == 0
    assert watch(usual_m=(0.05, 0.05)).alarm(com, np.zeros((2, 3)), FEET[:2]) is None


def test_a_foot_that_sinks_below_its_least_height_raises_an_alarm() -> None:
    least = np.array([-0.01, -0.01, -np.inf, -0.01])
    sinks = FEET.copy()
    sinks[:, 2, 2], sinks[2, 1, 2] = -0.05, -0.02
    nothing = np.zeros((3, 3))
    assert Watch(np.zeros((3, 2)), PER_SPEED_S, np.zeros(2), 0.06, least).alarm(nothing, nothing, sinks) == 2
    assert watch().alarm(nothing, nothing, sinks) is None
