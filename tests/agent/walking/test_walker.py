"""Walking along a path, behind a face of the box, and back from it."""

from itertools import pairwise

import pytest
from msgspec.structs import replace

from agent_proc.endings import MissionEndedError
from agent_proc.walking.stuck import STILL_CYCLES
from agent_proc.walking.walker import MOST_THROWN
from legpush.errors import PeerError
from legpush.geometry import Pose2, distance_m
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Follow, Motion, Outcome, Walk
from legpush.scene.scenario import Rectangle, Room, Scenario
from legpush.scene.station import can_turn
from tests.agent.fake_world import STRIDE_M, FakeWorld, KinematicSimulator, make_scenario, scenario_at_station
from tests.agent.parts import Parts, parts_in
from tests.robots import ROBOT

AHEAD = tuple(Pose2(x_m=1.5 + k / 10, y_m=3.0, yaw_rad=0.0) for k in range(21))
"""2 m straight ahead from the start, in five gait cycles."""
GATE = Rectangle(x_min_m=3.2, x_max_m=3.4, y_min_m=2.0, y_max_m=4.0, appears_at_s=2.0)
BESIDE = replace(GATE, y_min_m=0.0, y_max_m=1.0)


def with_obstacles(*obstacles: Rectangle, scenario: Scenario | None = None) -> Scenario:
    return replace(scenario or make_scenario(), room=Room(size_m=(12.0, 6.0), obstacles=obstacles))


def failing(_query: PlanQuery) -> Plan:
    return Plan(status="failed", reason="nothing found")


def test_a_path_is_walked_to_its_end_and_progress_is_told() -> None:
    parts = parts_in(FakeWorld(), make_scenario())

    assert parts.walker.walk("strolling", AHEAD)

    assert distance_m(parts.actor.trunk(), AHEAD[-1]) < 1e-9
    assert parts.world.motions(Follow) == [Follow(waypoints=AHEAD)]
    assert len(parts.world.motions(Walk)) == 5
    shares = [share for phase, share, _ in parts.world.told if phase == "strolling"]
    assert shares == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8, 1.0])


def test_a_path_of_one_place_needs_no_gait_cycle() -> None:
    parts = parts_in(FakeWorld(), make_scenario())

    assert parts.walker.walk("strolling", AHEAD[:1])
    assert parts.world.motions(Walk) == []


def test_a_walk_ends_as_soon_as_the_box_is_near_enough() -> None:
    parts = parts_in(FakeWorld(), make_scenario())

    assert parts.walker.walk("strolling", AHEAD, until_m=3.5)

    assert 3.5 - STRIDE_M < parts.actor.box_distance_m() <= 3.5


def test_a_walk_is_given_up_when_something_appears_in_what_is_left_of_it() -> None:
    blocked, free = (parts_in(FakeWorld(), with_obstacles(obstacle)) for obstacle in (GATE, BESIDE))

    assert not blocked.walker.walk("strolling", AHEAD)
    assert free.walker.walk("strolling", AHEAD)

    assert (blocked.planner.n_replans, free.planner.n_replans) == (1, 0)
    assert blocked.actor.trunk().x_m == pytest.approx(AHEAD[0].x_m + 2 * STRIDE_M)
    assert free.actor.n_appeared() == 1


def test_what_stood_there_before_the_walk_is_left_to_the_plan() -> None:
    parts = parts_in(FakeWorld(), with_obstacles(GATE))
    parts.walker.walk("strolling", AHEAD)

    assert parts.walker.walk("strolling", AHEAD)
    assert parts.planner.n_replans == 1


@pytest.mark.parametrize(("stride_m", "n_cycles"), [(0.001, STILL_CYCLES), (0.0041, 488)])
def test_a_robot_that_does_not_get_on_is_stuck(stride_m: float, n_cycles: int) -> None:
    parts = parts_in(FakeWorld(walk_stride_m=stride_m), make_scenario())

    if n_cycles > STILL_CYCLES:
        assert parts.walker.walk("strolling", AHEAD)
    else:
        with pytest.raises(
            MissionEndedError, match="no progress in at least 5 gait cycles, 0% of the path behind it"
        ) as ended:
            parts.walker.walk("strolling", AHEAD)
        assert ended.value.reason == "stuck"
    assert len(parts.world.motions(Walk)) == n_cycles


class Thrown(KinematicSimulator):
    """Gusts throw the robot to its left in some gait cycles."""

    left_m: dict[int, float]
    """By the number of the gait cycle, from 0."""

    def _move(self, motion: Motion) -> int:
        n_ticks = super()._move(motion)
        if isinstance(motion, Walk):
            by_m = self.left_m.get(self.n_done[Walk], 0.0)
            self._trunk = self._trunk @ Pose2(x_m=0.0, y_m=by_m, yaw_rad=0.0)
        return n_ticks


def thrown(scenario: Scenario | None = None, **left_m: float) -> Parts:
    simulator = Thrown()
    simulator.left_m = {int(name[1:]): by_m for name, by_m in left_m.items()}
    return parts_in(FakeWorld(simulator=simulator), scenario or make_scenario())


def test_a_robot_that_is_thrown_off_its_path_asks_for_another_one() -> None:
    parts = thrown(n1=0.4)
    plan = parts.planner.ask(parts.walker.query_behind_nominal("rear"), "the way")

    assert not parts.walker.walk_plan("strolling", plan)

    assert len(parts.world.motions(Walk)) == 2
    assert parts.planner.n_replans == 1
    assert parts.world.told[-1] == ("giving up a path", None, "of the robot, which was thrown 0.40 m off it")


def test_a_robot_that_is_thrown_a_little_or_too_near_to_something_stays_on_its_path() -> None:
    little = thrown(n1=0.2)
    plan = little.planner.ask(little.walker.query_behind_nominal("rear"), "the way")
    wall = Rectangle(x_min_m=0.0, x_max_m=12.0, y_min_m=3.6, y_max_m=4.0)
    near = thrown(with_obstacles(wall), n1=0.4)

    assert little.walker.walk_plan("strolling", plan, until_m=2.0)
    assert near.walker.walk_plan("strolling", plan, until_m=2.0)
    assert (little.planner.n_replans, near.planner.n_replans) == (0, 0)


def test_a_robot_that_is_thrown_again_and_again_gives_up_in_the_end() -> None:
    parts = thrown(**{f"n{k}": 0.4 * (-1) ** k for k in range(200)})

    def go_on() -> None:
        for _ in range(MOST_THROWN + 1):
            here = parts.actor.trunk()
            ahead = Plan(status="exact", reason="", waypoints=(here, here @ Pose2(x_m=0.5, y_m=0.0, yaw_rad=0.0)))
            parts.walker.walk_plan("strolling", ahead)
            parts.world.simulator._trunk = here

    with pytest.raises(MissionEndedError, match="thrown off its path more than 50 times"):
        go_on()
    assert parts.planner.n_replans == MOST_THROWN


def test_a_world_without_progress_after_a_follow_is_an_error() -> None:
    class Forgetful(FakeWorld):
        def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
            outcome = super().step(motion, with_trace=with_trace)
            return replace(outcome, world=replace(outcome.world, path=None))

    with pytest.raises(PeerError, match="Expected `path` in the state of the world at tick 0"):
        parts_in(Forgetful(), make_scenario()).walker.walk("strolling", AHEAD)


@pytest.mark.parametrize("obstacle", [GATE, BESIDE])
def test_after_a_planned_walk_the_planner_may_stop(obstacle: Rectangle) -> None:
    parts = parts_in(FakeWorld(), with_obstacles(obstacle))
    plan = parts.planner.ask(parts.walker.query_behind("rear"), "the way")

    done = parts.walker.walk_plan("strolling", plan)

    assert done == (obstacle is BESIDE)
    assert parts.world.n_cancelled == 1


def test_a_query_leads_from_the_robot_behind_the_box_as_it_is_or_as_it_should_be() -> None:
    parts = parts_in(FakeWorld(box_offset=(0.05, 0.02, 0.1)), make_scenario())
    parts.walker.walk("strolling", AHEAD)

    measured, nominal = parts.walker.query_behind("rear"), parts.walker.query_behind_nominal("rear")

    assert measured.start == nominal.start == parts.actor.trunk()
    assert measured.goal.yaw_rad == pytest.approx(0.1)
    assert nominal.goal.yaw_rad == 0.0
    assert measured.seed == nominal.seed == parts.planner.seed


@pytest.mark.parametrize("face", ["rear", "right"])
def test_an_approach_ends_at_the_station_of_the_face(face: str) -> None:
    parts = parts_in(FakeWorld(), make_scenario())

    parts.walker.approach(face)  # type: ignore[arg-type]

    assert parts.actor.standing_at() == face
    (query,) = parts.world.queries()
    follow = parts.world.motions(Follow)[0]
    assert isinstance(follow, Follow)
    assert any(distance_m(waypoint, query.goal) < 1e-9 for waypoint in follow.waypoints)
    assert max(distance_m(a, b) for a, b in pairwise(follow.waypoints)) < 0.1


def test_an_approach_asks_again_when_something_appears_in_the_way() -> None:
    parts = parts_in(FakeWorld(), with_obstacles(GATE))

    parts.walker.approach("rear")

    assert len(parts.world.queries()) == 2
    assert parts.planner.n_replans == 1
    assert parts.actor.at_station("rear")


def test_an_approach_without_a_path_ends_the_mission() -> None:
    with pytest.raises(MissionEndedError, match="the way behind the box: the planner's answer is failed") as ended:
        parts_in(FakeWorld(planner=failing), make_scenario()).walker.approach("rear")
    assert ended.value.reason == "no_path"


@pytest.mark.parametrize(
    ("drifts", "words", "key"),
    [
        ("_trunk", r"the approach ended 0\.7\d m from the box, not at the station", "planning.margin_m"),
        ("_box", r"the approach ended \d\.\d\d m from the box, which moved by \d\.\d\d m meanwhile", "box.friction"),
    ],
)
def test_an_approach_that_ends_elsewhere_ends_the_mission(drifts: str, words: str, key: str) -> None:
    class Drifting(KinematicSimulator):
        def _move(self, motion: Motion) -> int:
            n_ticks = super()._move(motion)
            if isinstance(motion, Walk):
                pose: Pose2 = getattr(self, drifts)
                setattr(self, drifts, replace(pose, y_m=pose.y_m - 0.4))
            return n_ticks

    with pytest.raises(MissionEndedError, match=words) as ended:
        parts_in(FakeWorld(simulator=Drifting()), make_scenario()).walker.approach("rear")
    assert ended.value.reason == "missed_station"
    assert ended.value.remedy.startswith("raise ")
    assert f"`{key}`" in ended.value.remedy.partition(";")[0]


def test_a_robot_that_is_stopped_without_space_to_turn_steps_back() -> None:
    beside = Rectangle(x_min_m=5.2, x_max_m=5.3, y_min_m=3.39, y_max_m=3.6, appears_at_s=13.5)
    parts = parts_in(FakeWorld(), with_obstacles(beside))
    plan = parts.planner.ask(parts.walker.query_behind("rear"), "the way")

    assert not parts.walker.walk_behind("rear", plan)

    assert "backing off" in [phase for phase, _, _ in parts.world.told]
    assert turns(parts)


def turns(parts: Parts) -> bool:
    """Whether the robot has space to turn."""
    return can_turn(parts.actor.scenario, parts.actor.trunk(), parts.actor.box())


def test_a_robot_at_the_box_backs_off_straight() -> None:
    parts = parts_in(FakeWorld(), scenario_at_station())
    before = parts.actor.trunk()

    parts.walker.back_off()

    assert turns(parts)
    assert before.x_m - parts.actor.trunk().x_m >= ROBOT.pushing.least_back_m
    assert parts.actor.trunk().y_m == before.y_m


def test_a_robot_away_from_the_box_does_not_back_off() -> None:
    parts = parts_in(FakeWorld(), make_scenario())

    parts.walker.back_off()

    assert parts.world.motions(Follow) == []


def test_another_face_is_reached_by_backing_off_first() -> None:
    parts = parts_in(FakeWorld(), scenario_at_station())

    assert parts.walker.change_face("right")

    assert parts.actor.standing_at() == "right"
    assert len(parts.world.motions(Follow)) == 2
    assert parts.world.queries()[0].start.x_m < 5.2


def test_another_face_is_not_reached_without_a_way() -> None:
    parts = parts_in(FakeWorld(planner=failing), scenario_at_station())

    assert not parts.walker.change_face("left")
    assert parts.planner.n_replans == 0


def test_another_face_is_not_reached_when_something_appears_in_the_way() -> None:
    free = parts_in(FakeWorld(), scenario_at_station())
    assert free.walker.change_face("left")
    (query,) = free.world.queries()
    x_m, y_m = query.goal.x_m, query.goal.y_m
    crate = Rectangle(x_min_m=x_m - 0.1, x_max_m=x_m + 0.1, y_min_m=y_m, y_max_m=y_m + 0.2, appears_at_s=3.0)
    blocked = parts_in(FakeWorld(), with_obstacles(crate, scenario=scenario_at_station()))

    assert not blocked.walker.change_face("left")
    assert blocked.planner.n_replans == 1
