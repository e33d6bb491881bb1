"""Push maps: what is measured, its file, and missions that go by it or measure for themselves."""

import threading
from collections.abc import Callable
from math import degrees
from pathlib import Path

import pytest
from msgspec.structs import replace

from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.push_model.calibration import SERIES, CalibrationError, calibrate, cells, open_floor
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.push_model.map import PushMap, load_push_map, make_push_map, measured_faces, write_push_map
from agent_proc.push_model.model import NOMINAL, PushModel
from legpush.errors import ConfigError, StopRequestedError
from legpush.messages.planning import BoxPathQuery
from legpush.messages.stepping import Push
from legpush.scene.faces import FACES, pushed_box, pushed_pose
from legpush.scene.reference import Arcs, Left, Straight, reference_curve
from legpush.scene.scenario import Box, Face, Goal, PoseDeg, PushSettings, Room
from legpush.scene.station import at_station
from planner_proc.planning import make_plan
from tests.agent.fake_world import FakeWorld, make_scenario, scenario_at_station

DEPTHS_M = (0.02, 0.05)


def measured(box: Box = NOMINAL, push_scale: float = 1.0, curves: tuple[float, ...] = (0.5,)) -> PushMap:
    """A map of what the fake world does."""
    worlds = [FakeWorld(push_scale=push_scale) for _ in range(2)]
    planned = cells(measured_faces(box), [(w, w) for w in curves], DEPTHS_M, (1, 2))
    return make_push_map(box, calibrate(worlds, box, planned), "test")


@pytest.mark.parametrize("face", FACES)
def test_the_robot_stands_ready_at_the_face_that_is_measured(face: Face) -> None:
    scenario = open_floor(NOMINAL, face)
    pose = scenario.box.pose.pose()

    assert at_station(scenario.start.pose(), pushed_box(scenario.box, face), pushed_pose(pose, face))
    assert degrees(pushed_pose(pose, face).yaw_rad) == pytest.approx(0.0, abs=1e-9)


def test_a_map_has_what_pushes_did_by_face_leg_and_depth() -> None:
    push_map = measured()
    truth = PushModel()

    assert {(e.face, e.leg, e.depth_m) for e in push_map.effects} == {
        (face, leg, depth_m) for face in ("rear", "right") for leg in ("FL", "FR") for depth_m in DEPTHS_M
    }
    assert all(effect.n == len(SERIES) for effect in push_map.effects)
    model = push_map.model("rear")
    for depth_m in DEPTHS_M:
        index, expected = model.depth_m.index(depth_m), truth.depth_m.index(depth_m)
        assert model.forward_m[index] == pytest.approx(truth.forward_m[expected], abs=1e-4)
        assert model.left_m[index] == pytest.approx(truth.left_m[expected], abs=1e-4)
        assert model.turn_deg[index] == pytest.approx(truth.turn_deg[expected], abs=1e-2)
    assert push_map.model("front") == replace_box(model, pushed_box(NOMINAL, "front"))
    assert push_map.model("left").forward_m == push_map.model("right").forward_m
    assert (model.depth_m[0], model.forward_m[0], model.turn_deg[0]) == (0.0, 0.0, 0.0)


def replace_box(model: PushModel, box: Box) -> PushModel:
    return PushModel(**{**{name: getattr(model, name) for name in model.__dataclass_fields__}, "box": box})


def test_circles_are_those_of_an_estimate_and_their_intervals_hold_them() -> None:
    push_map = measured()

    for circle in push_map.circles:
        estimate = PushEstimate(pushed_box(NOMINAL, circle.face))
        assert circle.radius_m.value == pytest.approx(estimate.turning_radius_m, rel=1e-3)
        assert circle.axle_m.value == pytest.approx(estimate.axle_m, rel=1e-3)
        assert circle.radius_m.low <= circle.radius_m.value <= circle.radius_m.high


def test_by_the_map_of_a_box_an_estimate_knows_it_at_once() -> None:
    push_map = measured(push_scale=0.8)

    by_map = PushEstimate(NOMINAL, push_map.model("rear"))
    assert by_map.after(NOMINAL.pose.pose(), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)).x_m == pytest.approx(
        0.8 * PushEstimate(NOMINAL).after(NOMINAL.pose.pose(), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)).x_m,
        rel=1e-3,
    )


@pytest.mark.parametrize(
    ("box", "faces"),
    [
        (NOMINAL, ("rear", "right")),
        (replace(NOMINAL, size_m=(0.4, 0.4, 0.4)), ("rear",)),
        (replace(NOMINAL, size_m=(0.4, 0.4, 0.4), shape="cylinder"), ("rear",)),
        (replace(NOMINAL, shape="l_shape"), ("rear", "left")),
        (replace(NOMINAL, shape="wedge"), ("rear",)),
    ],
)
def test_only_faces_that_differ_are_measured(box: Box, faces: tuple[Face, ...]) -> None:
    assert measured_faces(box) == faces
    square = box.size_m[0] == box.size_m[1]
    assert measured(box).model("rear").box.size_m == box.size_m
    if square:
        assert measured(box).model("left").forward_m == measured(box).model("rear").forward_m


def test_the_first_curve_is_what_missions_push_by() -> None:
    model = measured(curves=(0.2, 0.8)).model("rear")

    assert (model.w1, model.w2) == (0.2, 0.2)


def test_a_fall_ends_a_calibration_and_a_stop_too() -> None:
    planned = cells(("rear",), ((0.5, 0.5),), (0.05,), (1,))
    falling = FakeWorld(falls_in=lambda motion, n: isinstance(motion, Push) and n == 3)
    with pytest.raises(CalibrationError, match=r"fell as it pushed the rear face 0.05 m deep, FL"):
        calibrate([falling], NOMINAL, planned)
    stop = threading.Event()
    stop.set()
    with pytest.raises(StopRequestedError):
        calibrate([FakeWorld()], NOMINAL, planned, stop=stop)


def test_a_file_gives_the_map_again(tmp_path: Path) -> None:
    push_map, path = measured(), tmp_path / "map.json"
    write_push_map(push_map, path)

    assert load_push_map(path, replace(NOMINAL, mass_kg=0.9)) == push_map


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: "{", "expected a push map that `legpush calibrate` wrote"),
        (lambda text: text.replace("push map 1", "push map 7"), "expected a push map.*format"),
        (lambda text: text.replace('"face": "right"', '"face": "left"'), "at rear, right, none at right"),
        (lambda text: text.replace("0.5,\n   0.4", "0.6,\n   0.4"), "of a cuboid of 0.4 x 0.5 x 0.4 m, got that of a"),
    ],
)
def test_a_file_that_is_no_map_of_the_box_is_refused(
    change: Callable[[str], str], message: str, tmp_path: Path
) -> None:
    path = tmp_path / "map.json"
    write_push_map(measured(), path)
    text = change(path.read_text())
    assert text != path.read_text()
    path.write_text(text)

    with pytest.raises(ConfigError, match=message):
        load_push_map(path, NOMINAL)
    with pytest.raises(ConfigError, match="No such file"):
        load_push_map(tmp_path / "none.json", NOMINAL)


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
