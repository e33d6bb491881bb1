"""The simulator as its users see it: motions in, outcomes out."""

from collections.abc import Sequence
from math import cos, degrees, pi, radians, sin

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.errors import MotionError
from legpush.geometry import Pose2, rpy_from_quaternion
from legpush.messages import codec
from legpush.messages.stepping import Alter, Follow, Motion, Outcome, Push, Reset, Walk
from legpush.scene.conventions import FRONT_LEGS, JOINT_QPOS, FrontLeg
from legpush.scene.scenario import Rectangle, Room, Scenario
from sim_proc.simulator import SimulatedEpisode, Simulator
from tests.robots import ROBOT
from tests.sim.commands import held


def pose(x: float, y: float, yaw: float) -> Pose2:
    return Pose2(x_m=x, y_m=y, yaw_rad=yaw)


def around_a_corner() -> list[Pose2]:
    """From (2, 5): 1 m ahead, a quarter circle to the left of radius 0.8 m, then a turn on the spot to the right."""
    straight = [pose(2 + s, 5, 0) for s in np.linspace(0, 1, 20)]
    arc = [pose(3 + 0.8 * sin(a), 5 + 0.8 * (1 - cos(a)), a) for a in np.linspace(0.05, pi / 2, 30)]
    return [*straight, *arc, replace(arc[-1], yaw_rad=0.0)]


def box_pose(outcome: Outcome) -> Pose2:
    box = outcome.world.box
    yaw = float(rpy_from_quaternion(box.orientation_wxyz)[2])
    return pose(box.position_m[0], box.position_m[1], yaw)


def perform(simulator: Simulator, motions: Sequence[Motion]) -> list[Outcome]:
    return [simulator.perform(motion, with_trace=True) for motion in motions]


def walk(simulator: Simulator, waypoints: Sequence[Pose2]) -> list[Outcome]:
    outcomes = perform(simulator, [Follow(waypoints=tuple(waypoints))])
    while not outcomes[-1].world.path.done:  # type: ignore[union-attr]
        outcomes += perform(simulator, [Walk()])
        assert len(outcomes) < 100
    return outcomes


def test_a_push_along_two_control_points_is_that_of_the_message_and_another_degree_is_not(at_the_box: Scenario) -> None:
    push = Push(w1=0.3, w2=0.6, leg="FL", depth_m=0.05)
    episodes = [SimulatedEpisode(Reset(scenario=at_the_box, seed=0)) for _ in range(3)]

    usual, cubic, quadratic = (
        episodes[0].perform(push, with_trace=False),
        episodes[1].push(push, (0.3, 0.6), with_trace=False),
        episodes[2].push(push, (0.5,), with_trace=False),
    )

    assert usual.state_crc == cubic.state_crc != quadratic.state_crc
    assert box_pose(quadratic).x_m == pytest.approx(box_pose(cubic).x_m, abs=0.01)


def test_a_path_with_curve_and_turn_is_walked_upright_and_ends_where_it_ends(at_the_box: Scenario) -> None:
    simulator = Simulator()
    far = replace(at_the_box, box=replace(at_the_box.box, pose=replace(at_the_box.box.pose, x_m=10.0)))
    perform(simulator, [Reset(scenario=far, seed=0)])
    path = around_a_corner()
    outcomes = walk(simulator, path)
    last = outcomes[-1].world
    end = path[-1]
    assert np.hypot(last.trunk.position_m[0] - end.x_m, last.trunk.position_m[1] - end.y_m) < 0.02
    assert abs(degrees(rpy_from_quaternion(last.trunk.orientation_wxyz)[2])) < 1.0
    corners = end.apply(ROBOT.stance.foot_rectangle_b())
    np.testing.assert_allclose(np.array(last.tips_m)[:, :2], corners, atol=0.015)
    traces = [outcome.trace for outcome in outcomes[1:] if outcome.trace is not None]
    assert len(traces) == len(outcomes) - 1
    assert max(np.abs(trace.roll_pitch_rad).max() for trace in traces) < np.radians(2.0)
    assert min(min(trace.support_margin_m) for trace in traces) > 0.0
    assert last.n_footsteps == 4 * len(traces)
    assert not last.fallen


@pytest.mark.parametrize("leg", FRONT_LEGS)
def test_a_push_moves_the_box_ahead_turns_it_away_and_leaves_the_robot_at_its_station(
    at_the_box: Scenario, leg: FrontLeg
) -> None:
    simulator = Simulator()
    reset, *pushes = perform(
        simulator,
        [Reset(scenario=at_the_box, seed=0), *[Push(w1=0.5, w2=0.5, leg=leg, depth_m=0.05)] * 2],
    )
    moved = box_pose(reset).inverse() @ box_pose(pushes[0])
    assert 0.03 < moved.x_m < 0.045
    away = -1.0 if leg == "FL" else 1.0
    assert 2.0 < away * degrees(moved.yaw_rad) < 7.0
    for push in pushes:
        assert push.world.push is not None
        assert push.world.push.touched
        assert push.world.push.leg == leg
        assert push.world.tick * 0.02 <= 3.0 * len(pushes)
        station = box_pose(push) @ pose(-0.2 - 0.12 - 0.5963 / 2, 0, 0)
        corners = station.apply(ROBOT.stance.foot_rectangle_b())
        np.testing.assert_allclose(np.array(push.world.tips_m)[:, :2], corners, atol=0.015)


@pytest.mark.parametrize("turn_deg", [0.0, 60.0])
@pytest.mark.parametrize("direction_deg", [60.0, -90.0, 115.0, 150.0])
def test_a_path_that_leads_sideways_is_walked_upright(
    direction_deg: float, turn_deg: float, at_the_box: Scenario
) -> None:
    simulator = Simulator()
    start = replace(at_the_box.start, x_m=5.0)
    perform(simulator, [Reset(scenario=replace(at_the_box, start=start), seed=0)])
    x, y = cos(radians(direction_deg)), sin(radians(direction_deg))
    outcomes = walk(
        simulator, [pose(5.0 + d * x, 5.0 + d * y, d * radians(turn_deg)) for d in np.linspace(0.0, 1.5, 31)]
    )
    traces = [outcome.trace for outcome in outcomes[1:] if outcome.trace is not None]
    assert max(np.abs(trace.roll_pitch_rad).max() for trace in traces) < np.radians(1.5)
    assert min(min(trace.support_margin_m) for trace in traces) > -0.04
    assert not outcomes[-1].world.fallen


def test_left_and_right_pushes_mirror_each_other(at_the_box: Scenario) -> None:
    moved = []
    for leg in FRONT_LEGS:
        simulator = Simulator()
        reset, push = perform(
            simulator, [Reset(scenario=at_the_box, seed=0), Push(w1=0.4, w2=0.6, leg=leg, depth_m=0.06)]
        )
        moved.append(box_pose(reset).inverse() @ box_pose(push))
    left, right = moved
    np.testing.assert_allclose([right.x_m, -right.y_m, -right.yaw_rad], [left.x_m, left.y_m, left.yaw_rad], atol=1e-3)


def test_the_depth_of_a_push_is_how_far_the_box_goes(at_the_box: Scenario) -> None:
    distances = []
    for depth in (0.0, 0.02, 0.06, 0.1):
        simulator = Simulator()
        reset, push = perform(
            simulator, [Reset(scenario=at_the_box, seed=0), Push(w1=0.5, w2=0.5, leg="FL", depth_m=depth)]
        )
        distances.append((box_pose(reset).inverse() @ box_pose(push)).x_m)
    assert distances[0] < 0.003
    assert (np.diff(distances) > 0.005).all()


def test_random_pushes_never_make_the_robot_fall(at_the_box: Scenario) -> None:
    rng = np.random.default_rng(7)
    simulator = Simulator()
    perform(simulator, [Reset(scenario=at_the_box, seed=0)])
    for _ in range(30):
        w1, w2, depth = rng.uniform(0, [1, 1, 0.15])
        locus = rng.choice(["swing", "published"])
        push = Push(w1=w1, w2=w2, leg=str(rng.choice(["FL", "FR"])), depth_m=depth, locus=str(locus))  # type: ignore[arg-type]
        outcome = simulator.perform(push, with_trace=True)
        assert not outcome.world.fallen
        assert outcome.trace is not None
        assert np.abs(outcome.trace.roll_pitch_rad).max() < np.radians(5.0)


def test_equal_motions_give_equal_states_bit_for_bit(at_the_box: Scenario) -> None:
    motions: list[Motion] = [
        Reset(scenario=at_the_box, seed=3),
        Push(w1=0.3, w2=0.7, leg="FL", depth_m=0.05),
        Push(w1=0.3, w2=0.7, leg="FR", depth_m=0.05),
    ]
    used = Simulator()
    first = perform(used, motions)
    again = perform(used, motions)
    fresh = perform(Simulator(), motions)
    assert first == again == fresh
    assert len({outcome.state_crc for outcome in first}) == len(motions)


def test_the_trace_has_a_row_for_every_tick_and_changes_nothing(at_the_box: Scenario) -> None:
    motions: list[Motion] = [Reset(scenario=at_the_box, seed=3), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)]
    _, traced = perform(Simulator(), motions)
    bare_simulator = Simulator()
    bare = [bare_simulator.perform(motion, with_trace=False) for motion in motions][-1]
    assert bare.trace is None
    assert replace(traced, trace=None) == bare
    trace = traced.trace
    assert trace is not None
    assert trace.tick == tuple(range(1, traced.world.tick + 1))
    for name in trace.__struct_fields__:
        assert len(getattr(trace, name)) == traced.world.tick
    np.testing.assert_array_equal(trace.qpos[-1][:3], traced.world.trunk.position_m)


def test_every_outcome_passes_the_codec(at_the_box: Scenario) -> None:
    for outcome in perform(Simulator(), [Reset(scenario=at_the_box, seed=0), Push(w1=0, w2=1, leg="FL", depth_m=0.1)]):
        assert codec.decode(codec.encode(outcome), Outcome) == outcome


def test_a_robot_that_is_tipped_over_is_reported_as_fallen_and_refuses_to_go_on(at_the_box: Scenario) -> None:
    simulator = Simulator()
    perform(simulator, [Reset(scenario=at_the_box, seed=0)])
    episode = simulator.episode
    assert episode is not None
    episode.physics.data.qvel[2:4] = [3.0, 20.0]
    fallen = simulator.perform(Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05), with_trace=True)
    assert fallen.world.fallen
    with pytest.raises(MotionError, match="has fallen"):
        simulator.perform(Walk(), with_trace=False)


def test_motions_out_of_place_are_refused(at_the_box: Scenario) -> None:
    simulator = Simulator()
    with pytest.raises(MotionError, match="Expected `reset` as the first motion of an episode, got `walk`"):
        simulator.perform(Walk(), with_trace=False)
    perform(simulator, [Reset(scenario=at_the_box, seed=0)])
    with pytest.raises(MotionError, match="Expected `follow`"):
        simulator.perform(Walk(), with_trace=False)
    walk(simulator, [pose(2, 5, 0), pose(1.9, 5, 0)])
    with pytest.raises(MotionError, match="walked to its end"):
        simulator.perform(Walk(), with_trace=False)


def test_a_wall_stops_the_box(at_the_box: Scenario) -> None:
    front_m = at_the_box.box.pose.x_m + 0.2
    wall = Rectangle(x_min_m=front_m + 0.03, x_max_m=front_m + 0.5, y_min_m=3.0, y_max_m=7.0)
    simulator = Simulator()
    scenario = replace(at_the_box, room=Room(size_m=(12.0, 10.0), obstacles=(wall,)))
    perform(simulator, [Reset(scenario=scenario, seed=0)])
    for leg in FRONT_LEGS * 2:
        push = Push(w1=0.5, w2=0.5, leg=leg, depth_m=0.03)
        last = simulator.perform(push, with_trace=False)
    corners = box_pose(last).apply([[0.2, 0.25], [0.2, -0.25]])
    assert corners[:, 0].max() < wall.x_min_m + 0.005


def test_a_path_that_begins_elsewhere_and_a_push_from_afar_are_refused(at_the_box: Scenario) -> None:
    simulator = Simulator()
    perform(simulator, [Reset(scenario=at_the_box, seed=0)])
    before = simulator.perform(Follow(waypoints=(pose(2, 5, 0),)), with_trace=False)
    with pytest.raises(MotionError, match=r"path that begins at most 0\.35 m and 45° from the trunk, got 4\.00 m"):
        simulator.perform(Follow(waypoints=(pose(6, 5, 0),)), with_trace=False)
    far = replace(at_the_box, box=replace(at_the_box.box, pose=replace(at_the_box.box.pose, x_m=9.0)))
    away = Simulator()
    perform(away, [Reset(scenario=far, seed=0)])
    with pytest.raises(MotionError, match=r"Expected the place to push from at most 0\.35 m"):
        away.perform(Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05), with_trace=False)
    assert simulator.perform(Follow(waypoints=(pose(2, 5, 0),)), with_trace=False).state_crc == before.state_crc


@pytest.mark.parametrize("heading_deg", [0.0, 15.0, 30.0, 45.0, 90.0])
def test_the_floor_slows_the_box_down_alike_in_every_direction(at_the_box: Scenario, heading_deg: float) -> None:
    simulator = Simulator()
    perform(simulator, [Reset(scenario=at_the_box, seed=0)])
    assert simulator.episode is not None
    physics = simulator.episode.physics
    heading = np.radians(heading_deg)
    physics.data.qvel[18:20] = [cos(heading), sin(heading)]
    targets = np.repeat(physics.data.qpos[JOINT_QPOS][None], 5, axis=0)
    physics.run(held(targets))
    speed = float(np.hypot(*physics.data.qvel[18:20]))
    assert (1.0 - speed) / (5 * 0.02 * 9.81) == pytest.approx(0.5, rel=0.1)
    assert degrees(np.arctan2(physics.data.qvel[19], physics.data.qvel[18])) == pytest.approx(heading_deg, abs=3.0)


def test_a_box_that_slides_out_of_reach_is_not_followed(at_the_box: Scenario) -> None:
    slippery = replace(at_the_box, box=replace(at_the_box.box, friction=0.01))
    simulator = Simulator()
    perform(simulator, [Reset(scenario=slippery, seed=0)])
    push = simulator.perform(Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.15), with_trace=False)
    assert box_pose(push).x_m - slippery.box.pose.x_m > 0.4
    assert not push.world.fallen
    assert abs(push.world.trunk.position_m[0] - 2.0) < 0.1


def test_another_box_is_felt_from_the_next_motion_on_and_not_before(at_the_box: Scenario) -> None:
    push = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.08)
    start: list[Motion] = [Reset(scenario=at_the_box, seed=0), push]

    def after(*motions: Motion) -> list[int]:
        return [outcome.state_crc for outcome in perform(Simulator(), [*start, *motions])[len(start) - 1 :]]

    heavy = after(Alter(box_mass_kg=0.9), push)
    assert heavy == after(Alter(box_mass_kg=0.9), push)
    assert heavy[0] == heavy[1]
    assert heavy[2] != after(Alter(), push)[2] == after(push)[1]
    slippery = after(Alter(box_friction=0.2), push)
    assert len({heavy[2], slippery[2], after(Alter(box_mass_kg=0.9), Alter(box_friction=0.2), push)[3]}) == 3


def test_the_box_of_an_alteration_is_the_one_that_a_reset_builds(at_the_box: Scenario) -> None:
    push = Push(w1=0.5, w2=0.5, leg="FR", depth_m=0.08)
    heavy = replace(at_the_box, box=replace(at_the_box.box, mass_kg=0.9, friction=0.3))
    built = perform(Simulator(), [Reset(scenario=heavy, seed=0), push])
    altered = perform(Simulator(), [Reset(scenario=at_the_box, seed=0), Alter(box_mass_kg=0.9, box_friction=0.3), push])
    moved_mm = [
        1000 * (outcomes[-1].world.box.position_m[0] - at_the_box.box.pose.x_m) for outcomes in (built, altered)
    ]
    assert abs(moved_mm[0] - moved_mm[1]) < 1.0
