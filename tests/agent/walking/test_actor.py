"""One motion, and what is so after it."""

from math import cos, sin

import pytest
from msgspec.structs import replace

from agent_proc.endings import MissionEndedError
from agent_proc.walking.actor import MAX_BOX_TILT_RAD, Actor
from legpush.messages.stepping import Follow, Motion, Outcome, Push, Reset, Walk
from legpush.scene.names import Face
from legpush.scene.scenario import Goal, PoseDeg, PushSettings, Rectangle, Room, Scenario
from tests.agent.fake_world import WALK_TICKS, FakeWorld, make_scenario, scenario_at_station
from tests.agent.parts import parts_in

LATER = Rectangle(x_min_m=3.0, x_max_m=3.5, y_min_m=0.0, y_max_m=0.5, appears_at_s=1.0)
LAST = replace(LATER, y_min_m=5.5, y_max_m=6.0, appears_at_s=3.0)
CHANGING = make_scenario(room=Room(size_m=(12.0, 6.0), obstacles=(LATER, LAST)))
PUSH = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)


class Tilted(FakeWorld):
    """After a push the box leans by an angle."""

    tilt_rad = 0.0

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        outcome = super().step(motion, with_trace=with_trace)
        half_rad = self.tilt_rad / 2 if isinstance(motion, Push) else 0.0
        leaning = replace(outcome.world.box, orientation_wxyz=(cos(half_rad), 0.0, sin(half_rad), 0.0))
        return replace(outcome, world=replace(outcome.world, box=leaning))


def walked(actor: Actor, n_cycles: int) -> None:
    """Straight ahead from the start."""
    start = actor.scenario.start.pose()
    actor.step(Follow(waypoints=(start, replace(start, x_m=start.x_m + 3.0))))
    for _ in range(n_cycles):
        actor.step(Walk())


def test_after_a_motion_everything_is_where_the_world_has_it() -> None:
    actor = parts_in(FakeWorld(), make_scenario()).actor

    walked(actor, 2)

    assert actor.state.tick == 2 * WALK_TICKS
    assert (actor.trunk().x_m, actor.trunk().y_m) == pytest.approx((2.3, 3.0))
    assert (actor.box().x_m, actor.box().y_m) == (6.0, 3.0)
    assert actor.box_distance_m() == pytest.approx(6.0 - 2.3)
    assert actor.box_error().position_m == pytest.approx(1.0)


def test_every_motion_is_recorded_with_its_trace() -> None:
    asked: list[bool] = []

    class Watched(FakeWorld):
        def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
            asked.append(with_trace)
            return super().step(motion, with_trace=with_trace)

    walked(parts_in(Watched(), make_scenario()).actor, 1)

    assert asked == [True] * 3


def test_an_obstacle_is_known_from_the_step_on_in_which_it_appears() -> None:
    actor = parts_in(FakeWorld(), CHANGING).actor
    assert (actor.scenario.room.obstacles, actor.n_appeared()) == ((), 0)

    walked(actor, 1)
    assert (actor.scenario.room.obstacles, actor.n_appeared()) == ((LATER,), 1)
    actor.step(Walk())

    assert actor.appeared_since(0) == [LATER, LAST]
    assert actor.appeared_since(1) == [LAST]
    assert actor.appeared_since(2) == []


def test_the_scenario_is_revised_after_each_step() -> None:
    def revise(scenario: Scenario) -> Scenario:
        return replace(scenario, goal=Goal(pose=PoseDeg(x_m=9.0, y_m=3.0, yaw_deg=0.0)))

    world, scenario = FakeWorld(), make_scenario()
    actor = Actor(world, scenario, revise)
    assert actor.scenario is scenario

    actor.step(Reset(scenario=scenario, seed=0))

    assert actor.scenario.goal.pose.x_m == 9.0
    assert actor.box_error().position_m == pytest.approx(3.0)


def test_a_fall_ends_the_mission() -> None:
    actor = parts_in(FakeWorld(falls_in=lambda motion, _: isinstance(motion, Walk)), make_scenario()).actor

    with pytest.raises(MissionEndedError, match=rf"the robot fell during walk, tick {WALK_TICKS}") as ended:
        walked(actor, 1)
    assert ended.value.reason == "fell"


def test_a_box_that_leans_a_little_may_be_pushed_on() -> None:
    world = Tilted()
    world.tilt_rad = 0.9 * MAX_BOX_TILT_RAD
    actor = parts_in(world, scenario_at_station()).actor

    actor.step(PUSH)

    assert actor.box().x_m > 6.0


def test_a_box_that_leans_too_far_ends_the_mission() -> None:
    world = Tilted()
    world.tilt_rad = 1.1 * MAX_BOX_TILT_RAD
    actor = parts_in(world, scenario_at_station()).actor

    with pytest.raises(MissionEndedError, match="the box leans by 16°") as ended:
        actor.step(PUSH)
    assert ended.value.reason == "box_tipped"


def test_a_mission_goes_on_only_with_the_box_at_its_goal() -> None:
    at_goal, short = (
        parts_in(FakeWorld(), make_scenario(goal=Goal(pose=PoseDeg(x_m=x_m, y_m=3.0, yaw_deg=0.0)))).actor
        for x_m in (6.0, 6.1)
    )

    at_goal.require_goal("stuck", "why")
    with pytest.raises(MissionEndedError, match="why") as ended:
        short.require_goal("stuck", "why")
    assert ended.value.reason == "stuck"


def test_only_faces_of_the_scenario_that_the_shape_allows_can_be_pushed() -> None:
    faces: tuple[Face, ...] = ("left", "rear")
    scenario = make_scenario(pushing=PushSettings(faces=faces))
    wedge = replace(scenario, box=replace(scenario.box, shape="wedge"))

    assert parts_in(FakeWorld(), scenario).actor.faces() == faces
    assert parts_in(FakeWorld(), wedge).actor.faces() == ("rear",)


def test_a_robot_stands_at_the_face_whose_station_it_is_at() -> None:
    there, away = (parts_in(FakeWorld(), scenario).actor for scenario in (scenario_at_station(), make_scenario()))

    assert (there.standing_at(), away.standing_at()) == ("rear", None)
    assert (there.at_station("rear"), there.at_station("left"), away.at_station("rear")) == (True, False, False)
