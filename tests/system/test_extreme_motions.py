"""Motions with numbers that physics cannot carry, past all bounds of the schema: the simulator refuses or carries them
out, no exception leaves it, and the next episode is as if nothing had been.

`LEGPUSH_EXAMPLES=1000 python -m pytest tests/system/test_extreme_motions.py` draws more of them.
"""

import os
import sys
from collections.abc import Iterator
from contextlib import chdir
from itertools import count
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from msgspec.structs import force_setattr, replace

from legpush.geometry import Pose2
from legpush.lockstep.server import Denial, StepGuard
from legpush.messages.stepping import Action, Alter, Follow, Motion, Outcome, Push, Reset, Walk
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import Rectangle
from sim_proc.simulator import Simulator
from tests.legpush.examples import header

pytestmark = pytest.mark.filterwarnings("ignore::RuntimeWarning")
SCENARIO = load_scenario("push")
RESET = Reset(scenario=SCENARIO, seed=0)
N_EXAMPLES = int(os.environ.get("LEGPUSH_EXAMPLES", "72"))
TINY, HUGE = 5e-324, 1e308


def with_box(**changes: Any) -> Reset:
    return Reset(scenario=replace(SCENARIO, box=replace(SCENARIO.box, **changes)), seed=0)


def with_obstacles(*obstacles: Rectangle) -> Reset:
    """A reset whose room does not check its obstacles."""
    room = replace(SCENARIO.room)
    force_setattr(room, "obstacles", obstacles)
    return Reset(scenario=replace(SCENARIO, room=room), seed=0)


def with_start(x_m: float) -> Reset:
    return Reset(scenario=replace(SCENARIO, start=replace(SCENARIO.start, x_m=x_m)), seed=0)


def with_randomization(width: float) -> Reset:
    spread = replace(SCENARIO.randomization, start_xy_m=width, box_yaw_deg=width)
    return Reset(scenario=replace(SCENARIO, randomization=spread), seed=0)


def rectangle(x_m: float, width_m: float) -> Rectangle:
    """An obstacle that does not check its sides."""
    obstacle = Rectangle(x_min_m=0.0, x_max_m=1.0, y_min_m=0.0, y_max_m=1.0)
    force_setattr(obstacle, "x_min_m", x_m)
    force_setattr(obstacle, "x_max_m", x_m + width_m)
    return obstacle


def follow(*places: float) -> Follow:
    return Follow(waypoints=tuple(Pose2(x_m=x_m, y_m=0.0, yaw_rad=0.0) for x_m in places))


class Tried:
    """A simulator behind its guard, and what its undisturbed episode leads to."""

    def __init__(self) -> None:
        self._guard = StepGuard(Simulator(), lambda name, incarnation: True)
        self._sequence = count()
        self._episodes = count(1)
        self._expected = self.undisturbed()

    def undisturbed(self) -> list[int]:
        """CRCs of a whole, usual episode."""
        answers = self.episode(RESET, Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05))
        return [answer.state_crc for answer in answers if isinstance(answer, Outcome)]

    def episode(self, *motions: Motion) -> list[Outcome | Denial]:
        """The answers to an episode of these motions; a refused one does not count as a step."""
        episode, step = next(self._episodes), 0
        answers = []
        for motion in motions:
            sender = replace(header("agent"), sequence=next(self._sequence))
            answer = self._guard.answer(Action(header=sender, episode=episode, step=step, motion=motion))
            assert isinstance(answer, (Outcome, Denial))
            step += isinstance(answer, Outcome)
            answers.append(answer)
        return answers

    def check(self, *motions: Motion) -> list[Outcome | Denial]:
        """Try an episode, and that the next one is undisturbed."""
        answers = self.episode(*motions)
        assert self.undisturbed() == self._expected
        return answers


@pytest.fixture(scope="module")
def tried(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tried]:
    """A simulator that all tests here use, one after the other; MuJoCo writes its log to the working directory."""
    with chdir(tmp_path_factory.mktemp("mujoco")):
        yield Tried()


@pytest.mark.parametrize(
    "motions",
    [
        (RESET, follow(HUGE)),
        (RESET, follow(1.0, HUGE), Walk()),
        (with_start(HUGE), Walk()),
        (with_start(-HUGE), follow(-HUGE), Walk()),
        (with_box(size_m=(HUGE, 0.5, 0.4)),),
        (with_box(size_m=(0.4, 1e300, 0.4)), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)),
        (with_box(mass_kg=HUGE), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)),
        (with_box(friction=1e150), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)),
        (with_box(friction=HUGE), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)),
        (RESET, Alter(box_mass_kg=HUGE), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)),
        (RESET, Alter(box_friction=HUGE), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)),
        (with_randomization(HUGE), Walk()),
        (with_obstacles(rectangle(0.0, TINY)), Walk()),
        (with_obstacles(rectangle(-HUGE, HUGE)), Walk()),
        (with_obstacles(*[rectangle(3.0, 1.0)] * 2_000), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)),
    ],
)
def test_motions_that_ended_a_simulator_once_are_answered(tried: Tried, motions: tuple[Motion, ...]) -> None:
    assert len(tried.check(*motions)) == len(motions)


numbers = st.one_of(
    st.sampled_from([0.0, TINY, 1e-300, 1e-9, 1.0, 1e4, 1e9, 1e16, 1e150, 1e300, HUGE, sys.float_info.max]),
    st.floats(0.0, allow_infinity=False),
)
coordinates = st.one_of(numbers, numbers.map(lambda number: -number))
resets = st.one_of(
    st.builds(lambda mass_kg, friction: with_box(mass_kg=mass_kg, friction=friction), numbers, numbers),
    st.builds(lambda *size_m: with_box(size_m=size_m), numbers, numbers, numbers),
    coordinates.map(with_start),
    numbers.map(with_randomization),
)
motions = st.one_of(
    st.just(Walk()),
    st.lists(coordinates, min_size=1, max_size=3).map(lambda places: follow(*places)),
    st.builds(Push, w1=numbers, w2=numbers, leg=st.sampled_from(["FL", "FR"]), depth_m=numbers),
    st.builds(Alter, box_mass_kg=st.none() | numbers, box_friction=st.none() | numbers),
)


@settings(
    max_examples=N_EXAMPLES,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)
@given(st.one_of(st.just(RESET), resets), st.lists(motions, max_size=4))
def test_drawn_extremes_are_answered(tried: Tried, reset: Reset, others: list[Motion]) -> None:
    assert len(tried.check(reset, *others)) == 1 + len(others)
