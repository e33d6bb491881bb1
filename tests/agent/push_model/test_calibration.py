"""Calibration: series of pushes, and missions that use a map or measure for themselves."""

import threading
from math import degrees

import pytest
from msgspec.structs import replace

from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.push_model.calibration import SERIES, CalibrationError, calibrate, cells, open_floor
from agent_proc.push_model.map import PushMap
from agent_proc.push_model.model import NOMINAL
from legpush.errors import StopRequestedError
from legpush.messages.planning import BoxPathQuery
from legpush.messages.stepping import Push
from legpush.scene.faces import FACES, pushed_box, pushed_pose
from legpush.scene.names import Face
from legpush.scene.reference import Arcs, Left, Straight, reference_curve
from legpush.scene.scenario import Goal, PoseDeg, PushSettings, Room
from legpush.scene.station import at_station
from planner_proc.planning import make_plan
from tests.agent.fake_world import FakeWorld, make_scenario, scenario_at_station
from tests.agent.push_model.maps import measured


@pytest.mark.parametrize("face", FACES)
def test_the_robot_stands_ready_at_the_face_that_is_measured(face: Face) -> None:
    scenario = open_floor(NOMINAL, face)
    pose = scenario.box.pose.pose()

    assert at_station(scenario.start.pose(), pushed_box(scenario.box, face), pushed_pose(pose, face))
    assert degrees(pushed_pose(pose, face).yaw_rad) == pytest.approx(0.0, abs=1e-9)


def test_samples_come_in_the_order_of_the_cells_however_many_worlds_there_are() -> None:
    planned = cells(("rear", "right"), ((0.5, 0.5),), (0.02, 0.05), (1, 2))
    n_done: list[int] = []
    one, three = (
        calibrate([FakeWorld() for _ in range(n)], NOMINAL, planned, on_cell=lambda: n_done.append(1)) for n in (1, 3)
    )

    assert one == three
    assert [(s.face, s.depth_m) for s in one] == [(c.face, c.depth_m) for c in planned for _ in SERIES]
    assert [s.leg for s in one[: len(SERIES)]] == ["FL", "FR", "FL", "FL", "FR", "FR", "FL", "FR"]
    assert len(n_done) == 2 * len(planned)


def test_a_fall_ends_a_calibration_and_a_stop_too() -> None:
    planned = cells(("rear",), ((0.5, 0.5),), (0.05,), (1,))
    falling = FakeWorld(falls_in=lambda motion, n: isinstance(motion, Push) and n == 3)
    with pytest.raises(CalibrationError, match=r"fell as it pushed the rear face 0.05 m deep, FL"):
        calibrate([falling], NOMINAL, planned)
    stop = threading.Event()
    stop.set()
    with pytest.raises(StopRequestedError):
        calibrate([FakeWorld()], NOMINAL, planned, stop=stop)


def test_a_mission_plans_by_the_map() -> None:
    scenario = replace(
        make_scenario(room=Room(size_m=(12.0, 6.0))), goal=Goal(pose=PoseDeg(x_m=8.0, y_m=4.0, yaw_deg=90.0))
    )
    queries = []
    for push_map in (None, turning_twice()):
        world = FakeWorld(planner=make_plan)
        run_mission(world, scenario, 3, ScriptedPolicy(), push_map)
        queries.append(world.box_queries()[0])

    radii = [query.sides[0].min_turning_radius_m for query in queries]
    assert radii[1] == pytest.approx(radii[0] / 2, rel=1e-3)


def turning_twice() -> PushMap:
    """The map of a box that turns twice as much."""
    push_map = measured()
    return replace(push_map, effects=tuple(replace(e, turn_deg=2 * e.turn_deg) for e in push_map.effects))


def calibrating(n_pushes: int, room: Room) -> list[BoxPathQuery | Push]:
    """What a mission asks and does, in order, with an unknown box that turns half as much again."""
    goal = Goal(pose=PoseDeg(x_m=8.0, y_m=4.0, yaw_deg=90.0))
    pushing = PushSettings(calibration_pushes=n_pushes, faces=("rear",))
    world = FakeWorld(planner=make_plan, turn_scale=1.5)
    result = run_mission(world, replace(make_scenario(room=room), goal=goal, pushing=pushing), 3, ScriptedPolicy())
    assert result.success, result.detail
    assert result.n_push_cycles == len(world.motions(Push))
    return [record[0] for record in world.records if isinstance(record[0], BoxPathQuery | Push)]


def test_a_robot_that_is_asked_to_calibrates_before_it_plans() -> None:
    plain, own = (calibrating(n, Room(size_m=(12.0, 6.0))) for n in (0, 6))
    first = next(index for index, step in enumerate(own) if isinstance(step, Push))

    legs = [step.leg for step in own[first : first + 6] if isinstance(step, Push)]
    assert legs == ["FL", "FR", "FR", "FL", "FL", "FR"]
    guessed, known = plain[0], own[first + 6]
    assert isinstance(guessed, BoxPathQuery)
    assert isinstance(known, BoxPathQuery)
    ratio = guessed.sides[0].min_turning_radius_m / known.sides[0].min_turning_radius_m
    assert ratio == pytest.approx(1.5, rel=0.06)


def test_without_the_space_for_it_nothing_is_calibrated() -> None:
    narrow = Room(size_m=(8.45, 6.0))

    plain, own = ([step for step in calibrating(n, narrow) if isinstance(step, Push)] for n in (0, 40))

    assert own == plain


def test_a_reference_is_refused_for_a_guess_but_not_if_the_box_can_be_calibrated_first() -> None:
    reference = Arcs(radius_m=0.5, segments=(Straight(length_m=0.5), Left(angle_deg=60.0), Straight(length_m=0.5)))
    scenario = scenario_at_station()
    x_m, y_m, yaw_rad = reference_curve(reference, scenario.box.pose.pose())[-1].tolist()
    goal = Goal(pose=PoseDeg(x_m=x_m, y_m=y_m, yaw_deg=degrees(yaw_rad)))
    results = []
    for n_pushes in (0, 6):
        pushing = PushSettings(calibration_pushes=n_pushes)
        asked = replace(scenario, reference=reference, goal=goal, pushing=pushing)
        results.append(run_mission(FakeWorld(turn_scale=1.5), asked, 3, ScriptedPolicy()))

    assert (results[0].reason, results[0].n_push_cycles) == ("no_path", 0)
    assert results[1].success, results[1].detail
