"""Following a path of the box, in a world that moves it as the push model says."""

from math import degrees

import pytest
from msgspec.structs import replace

from agent_proc.frames.poses import box_error
from agent_proc.frames.push_view import PushView
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.follower import ENOUGH_M, LINE_AHEAD_M, Follower
from agent_proc.pushing.stage import Stage
from legpush.geometry import Pose2
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, Reset
from legpush.scene.faces import FACES, pushed_box
from legpush.scene.names import Face
from legpush.scene.scenario import Goal, PoseDeg, PushSettings
from tests.agent.fake_world import FakeWorld, make_state, scenario_at_station
from tests.agent.pushing.paths import AXLE_M, BEHIND, START, line, quarter


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


class Always:
    """Pushes on for ever."""

    def decide(self, _view: PushView) -> Push | None:
        return Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.01)


@pytest.mark.parametrize("is_last", [True, False])
@pytest.mark.parametrize("left_m", [ENOUGH_M - 0.002, ENOUGH_M + 0.002])
def test_a_line_that_another_stage_follows_is_over_a_little_before_its_end(left_m: float, is_last: bool) -> None:
    scenario = scenario_at_station()
    poses, _ = line("rear", 0.4)
    follower = Follower(Stage("rear", poses, AXLE_M), Always(), scenario, PushEstimate(scenario.box), is_last=is_last)
    box = Pose2(x_m=START.x_m + 0.4 - left_m, y_m=START.y_m + 0.02, yaw_rad=0.0)

    decision = follower.decide(make_state(scenario.start.pose(), box))

    assert (decision.ending == "done") == (left_m < ENOUGH_M and not is_last)
