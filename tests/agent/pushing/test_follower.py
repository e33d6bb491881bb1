"""Following a path of the box, in a world that moves it as the push model says."""

from math import cos, degrees, pi, radians, sin
from typing import Literal

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.frames.poses import box_error
from agent_proc.frames.push_view import PushView
from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.follower import LINE_AHEAD_M, Follower
from agent_proc.pushing.reference_stage import trailing
from agent_proc.pushing.stage import Stage
from agent_proc.reporting.mission_record import read_record
from agent_proc.reporting.report import box_path_rms_m
from legpush.geometry import Pose2
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, Reset
from legpush.scene.faces import FACES, TURN_RAD, pushed_box
from legpush.scene.names import Face
from legpush.scene.reference import Arcs, Left, Reference, Right, Sine, Straight, reference_curve
from legpush.scene.scenario import Goal, PoseDeg, PushSettings, Room, Scenario
from planner_proc.planning import make_plan
from tests.agent.fake_world import FakeWorld, make_scenario, make_state, scenario_at_station

AXLE_M = 0.146
START = Pose2(x_m=6.0, y_m=3.0, yaw_rad=0.0)
BEHIND = Pose2(x_m=-AXLE_M, y_m=0.0, yaw_rad=0.0)


def quarter(radius_m: float, straight_m: float) -> tuple[Pose2, ...]:
    """Box poses from `START`: an arc to the left about a point beside the axle, then straight on."""
    axle = START @ BEHIND
    angles = [pi / 2 * k / 60 for k in range(61)]
    arc = [axle @ Pose2(x_m=radius_m * sin(a), y_m=radius_m * (1 - cos(a)), yaw_rad=a) for a in angles]
    line = [arc[-1] @ Pose2(x_m=straight_m * k / 30, y_m=0.0, yaw_rad=0.0) for k in range(1, 31)]
    return tuple(pose @ Pose2(x_m=AXLE_M, y_m=0.0, yaw_rad=0.0) for pose in (*arc, *line))


def test_a_place_on_a_path_is_found_from_the_box_beside_it() -> None:
    path = Stage("rear", quarter(0.8, 0.5), AXLE_M)
    beside = path.pose(0.9) @ BEHIND @ Pose2(x_m=0.0, y_m=0.03, yaw_rad=radians(4.0))
    box = beside @ Pose2(x_m=AXLE_M, y_m=0.0, yaw_rad=0.0)

    deviation = path.deviation(box, 0.5, 1.2)

    assert path.length_m == pytest.approx(0.8 * pi / 2 + 0.5, rel=1e-3)
    assert deviation.distance_m == pytest.approx(0.9, abs=0.005)
    assert deviation.left_m == pytest.approx(0.03, abs=1e-3)
    assert degrees(deviation.heading_rad) == pytest.approx(4.0, abs=0.3)
    assert path.straight_until_m(0.5) == 0.5
    assert path.straight_until_m(1.4) == path.length_m
    assert path.pose(path.length_m) == path.end


@pytest.mark.parametrize("scale", [0.9, 1.0, 1.1])
def test_an_arc_and_a_line_are_followed_to_their_end(scale: float) -> None:
    scenario = scenario_at_station()
    poses = quarter(0.8, 0.6)
    end = poses[-1]
    goal = Goal(pose=PoseDeg(x_m=end.x_m, y_m=end.y_m, yaw_deg=degrees(end.yaw_rad)))
    scenario = replace(scenario, goal=goal)
    path, estimate = Stage("rear", poses, AXLE_M), PushEstimate(scenario.box)
    follower = Follower(path, ScriptedPolicy(), scenario, estimate)
    world = FakeWorld(push_scale=scale)
    state = world.step(Reset(scenario=scenario, seed=0)).world
    deviations = []
    for _ in range(120):
        decision = follower.decide(state)
        if decision.push is None:
            break
        before = planar_pose(state.box)
        state = world.step(decision.push).world
        estimate.learn(before, decision.push, planar_pose(state.box))
        deviations.append(abs(decision.deviation.left_m))

    assert decision.ending == "done"
    assert max(deviations) < 0.03
    assert box_error(state, scenario).within(goal)


def test_a_box_that_left_its_path_is_said_so() -> None:
    scenario = scenario_at_station()
    follower = Follower(
        Stage("rear", quarter(0.8, 0.5), AXLE_M), ScriptedPolicy(), scenario, PushEstimate(scenario.box)
    )
    aside = make_state(scenario.start.pose(), Pose2(x_m=6.1, y_m=3.2, yaw_rad=0.0))

    decision = follower.decide(aside)

    assert (decision.push, decision.ending) == (None, "left_path")


class Asked:
    """A policy that keeps the views that it is asked about."""

    def __init__(self) -> None:
        self.views: list[PushView] = []

    def decide(self, view: PushView) -> Push | None:
        self.views.append(view)
        return Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)


def line(face: Face, length_m: float) -> tuple[tuple[Pose2, ...], Pose2]:
    """Box poses straight ahead along x, pushed at a face, and the pushed frame at their end."""
    pushed = [START @ Pose2(x_m=length_m * k / 30, y_m=0.0, yaw_rad=0.0) for k in range(31)]
    turned = Pose2(x_m=0.0, y_m=0.0, yaw_rad=-TURN_RAD[face])
    return tuple(pose @ turned for pose in pushed), pushed[-1]


@pytest.mark.parametrize("face", FACES)
def test_a_policy_is_asked_about_the_pushed_frame_and_the_end_of_the_stage(face: Face) -> None:
    scenario, asked = scenario_at_station(), Asked()
    poses, end = line(face, 0.8)
    follower = Follower(Stage(face, poses, AXLE_M), asked, scenario, PushEstimate(scenario.box))
    world = make_state(scenario.start.pose(), poses[0])

    decision = follower.decide(world)

    (view,) = asked.views
    assert decision.push is not None
    assert decision.push.face == face
    assert (view.box_g.x_m, view.box_g.y_m, view.box_g.yaw_rad) == pytest.approx((-0.8, 0.0, 0.0), abs=1e-9)
    assert view.goal.pose.pose().xy() == pytest.approx(end.xy())
    assert view.goal.position_tolerance_m == scenario.goal.position_tolerance_m
    assert view.box == pushed_box(scenario.box, face)
    assert (view.world, view.scenario) == (world, scenario)


def test_a_policy_is_asked_about_a_point_ahead_where_an_arc_follows() -> None:
    scenario, asked = scenario_at_station(), Asked()
    straight, _ = line("rear", 0.7)
    arc = [straight[-1] @ BEHIND @ (START @ BEHIND).inverse() @ pose for pose in quarter(0.8, 0.5)]
    follower = Follower(Stage("rear", (*straight, *arc), AXLE_M), asked, scenario, PushEstimate(scenario.box))

    follower.decide(make_state(scenario.start.pose(), START))

    (view,) = asked.views
    assert view.box_g.x_m == pytest.approx(-LINE_AHEAD_M)


def test_in_an_open_loop_a_policy_is_asked_about_a_level_box_where_the_push_model_has_it() -> None:
    scenario = replace(scenario_at_station(), pushing=PushSettings(composition="open_loop"))
    asked, estimate = Asked(), PushEstimate(scenario.box)
    poses, _ = line("rear", 0.8)
    follower = Follower(Stage("rear", poses, AXLE_M), asked, scenario, estimate)
    world = make_state(scenario.start.pose(), poses[0])

    first, _ = (follower.decide(world) for _ in range(2))

    assert first.push is not None
    believed = estimate.after(poses[0], first.push)
    seen = asked.views[1].box_w
    assert (seen.x_m, seen.y_m, seen.yaw_rad) == pytest.approx((believed.x_m, believed.y_m, believed.yaw_rad))
    assert asked.views[1].box_state.position_m[2] == world.box.position_m[2]


def anywhere(x_m: float, y_m: float, yaw_deg: float) -> Scenario:
    scenario = make_scenario(room=Room(size_m=(12.0, 6.0)))
    return replace(scenario, goal=Goal(pose=PoseDeg(x_m=x_m, y_m=y_m, yaw_deg=yaw_deg)))


@pytest.mark.parametrize(
    ("x_m", "y_m", "yaw_deg", "expected"),
    [
        (5.0, 3.0, 0.0, {"front"}),
        (6.0, 4.0, 0.0, {"right"}),
        (7.0, 3.6, 0.0, {"rear", "right"}),
        (8.0, 4.0, 90.0, {"rear"}),
    ],
)
def test_a_mission_reaches_goals_anywhere(x_m: float, y_m: float, yaw_deg: float, expected: set[str]) -> None:
    scenario = anywhere(x_m, y_m, yaw_deg)
    world = FakeWorld(planner=make_plan)

    result = run_mission(world, scenario, 3, ScriptedPolicy())

    assert result.reason == "success"
    assert {push.face for push in world.motions(Push) if isinstance(push, Push)} == expected
    assert box_error(world.records[-1][1].world, scenario).within(scenario.goal)  # type: ignore[union-attr]


def test_faces_that_may_not_be_pushed_are_not() -> None:
    scenario = replace(anywhere(7.0, 3.6, 0.0), pushing=PushSettings(faces=("rear",)))
    world = FakeWorld(planner=make_plan)

    run_mission(world, scenario, 3, ScriptedPolicy())

    assert {push.face for push in world.motions(Push) if isinstance(push, Push)} <= {"rear"}
    assert all(len(query.sides) == 1 for query in world.box_queries())


def test_an_open_loop_plans_once_and_corrects_nothing() -> None:
    scenario = replace(anywhere(8.0, 4.0, 90.0), pushing=PushSettings(composition="open_loop", faces=("rear",)))
    exact, weak = FakeWorld(planner=make_plan), FakeWorld(planner=make_plan, push_scale=0.8)
    results = [run_mission(world, scenario, 3, ScriptedPolicy()) for world in (exact, weak)]

    pushes = [[replace(push, face="rear") for push in world.motions(Push)] for world in (exact, weak)]
    assert pushes[0] == pushes[1]
    assert results[0].success
    assert results[1].reason == "tolerance_missed"


def test_an_estimate_learns_how_much_a_box_turns() -> None:
    box = scenario_at_station().box
    estimate = PushEstimate(box)
    radius_m = estimate.turning_radius_m
    model = PushEstimate(pushed_box(box, "rear"))
    for _ in range(20):
        push = Push(w1=0.5, w2=0.5, leg="FR", depth_m=0.05)
        after = model.after(START, push)
        turned = Pose2(x_m=after.x_m, y_m=after.y_m, yaw_rad=1.2 * after.yaw_rad)
        estimate.learn(START, push, turned)

    assert estimate.turn_scale == pytest.approx(1.2, abs=0.03)
    assert estimate.turning_radius_m == pytest.approx(radius_m / 1.2, rel=0.03)


EIGHT = Arcs(
    radius_m=0.9,
    segments=(
        Straight(length_m=0.9),
        Right(angle_deg=90.0),
        Straight(length_m=0.5),
        Left(angle_deg=180.0),
        Straight(length_m=0.7),
    ),
)


def along(reference: Reference, composition: Literal["closed_loop", "open_loop"] = "closed_loop") -> Scenario:
    """Pushed along the reference, in a room that is large enough."""
    scenario = scenario_at_station()
    x_m, y_m, yaw_rad = reference_curve(reference, scenario.box.pose.pose())[-1].tolist()
    goal = Goal(pose=PoseDeg(x_m=x_m, y_m=y_m, yaw_deg=degrees(yaw_rad)))
    return replace(scenario, goal=goal, reference=reference, pushing=PushSettings(composition=composition))


@pytest.mark.parametrize("reference", [EIGHT, Sine(amplitude_m=0.3, wavelength_m=3.0, n_periods=1.0)])
def test_a_reference_is_followed_to_its_end_without_asking_for_a_path(reference: Reference) -> None:
    world = FakeWorld(push_scale=0.95)
    scenario = along(reference)

    result = run_mission(world, scenario, 3, ScriptedPolicy())

    assert result.success, result.detail
    rms_m = box_path_rms_m(read_record(iter(world.records)).steps)
    assert rms_m is not None
    assert rms_m < 0.015
    assert {push.face for push in world.motions(Push) if isinstance(push, Push)} == {"rear"}


def test_a_loop_is_pushed_though_the_box_begins_at_its_goal() -> None:
    loop = Arcs(radius_m=0.8, segments=(Left(angle_deg=350.0), Straight(length_m=0.1), Left(angle_deg=10.0)))
    world = FakeWorld()

    run_mission(world, along(loop), 3, ScriptedPolicy())

    assert len(world.motions(Push)) > 100


def test_a_reference_in_an_open_loop_is_pushed_the_same_whatever_the_box_does() -> None:
    exact, weak = FakeWorld(), FakeWorld(push_scale=0.8)
    results = [run_mission(world, along(EIGHT, "open_loop"), 3, ScriptedPolicy()) for world in (exact, weak)]

    assert exact.motions(Push) == weak.motions(Push)
    assert results[0].success
    assert results[1].reason == "tolerance_missed"
    assert not exact.box_queries()


def test_a_reference_that_turns_too_tightly_is_refused_before_the_robot_moves() -> None:
    world = FakeWorld()

    result = run_mission(world, along(Arcs(radius_m=0.3, segments=(Left(angle_deg=90.0),))), 3, ScriptedPolicy())

    assert result.reason == "no_path"
    assert "turns on a radius of 0.30 m, the box on no less than 0.5" in result.detail
    assert not world.motions(Push)


def test_a_box_that_leaves_its_reference_ends_the_mission() -> None:
    world = FakeWorld(sideways_m=0.02)

    result = run_mission(world, along(EIGHT), 3, ScriptedPolicy())

    assert result.reason == "left_reference"
    assert "the box left its reference after" in result.detail


@pytest.mark.parametrize("axle_m", [0.0, 0.15, 0.3])
def test_headings_along_a_curve_are_those_of_a_box_that_does_not_slip(axle_m: float) -> None:
    curve = reference_curve(EIGHT, START)
    headings = trailing(curve, axle_m)

    axles = curve[:, :2] - axle_m * np.stack([np.cos(headings), np.sin(headings)], axis=1)
    steps = np.diff(axles, axis=0)
    middle = (headings[1:] + headings[:-1]) / 2
    sideways = np.cos(middle) * steps[:, 1] - np.sin(middle) * steps[:, 0]
    assert np.abs(sideways).max() < 1e-5
