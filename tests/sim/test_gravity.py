"""A floor that slopes: gravity is tilted, and the robot leans against it."""

from math import radians, sin

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Follow, Push, Reset, Trace, Walk
from legpush.scene.conventions import BOX_QPOS
from legpush.scene.scenario import Room, Scenario
from sim_proc.gravity import GRAVITY_M_S2, gravity_m_s2
from sim_proc.model.world import build_model
from sim_proc.simulator import Simulator


def test_a_level_floor_has_gravity_along_its_normal_to_the_last_bit() -> None:
    assert str(gravity_m_s2(Room(size_m=(1.0, 1.0)))) == "(0.0, 0.0, -9.81)"
    assert str(gravity_m_s2(Room(size_m=(1.0, 1.0), uphill_deg=120.0))) == "(0.0, 0.0, -9.81)"


@pytest.mark.parametrize(("uphill_deg", "downhill"), [(0.0, (-1.0, 0.0)), (90.0, (0.0, -1.0)), (180.0, (1.0, 0.0))])
def test_gravity_pulls_downhill(at_the_box: Scenario, uphill_deg: float, downhill: tuple[float, float]) -> None:
    room = replace(at_the_box.room, slope_deg=5.0, uphill_deg=uphill_deg)
    gravity = build_model(replace(at_the_box, room=room)).opt.gravity

    np.testing.assert_allclose(gravity[:2], np.multiply(GRAVITY_M_S2 * sin(radians(5.0)), downhill), atol=1e-12)
    assert np.linalg.norm(gravity) == pytest.approx(GRAVITY_M_S2)


@pytest.mark.parametrize("uphill_deg", [0.0, 90.0, 180.0])
def test_pushing_on_a_slope_keeps_the_robot_level_with_the_floor_and_its_support(
    at_the_box: Scenario, uphill_deg: float
) -> None:
    traces = pushed(replace(at_the_box, room=replace(at_the_box.room, slope_deg=5.0, uphill_deg=uphill_deg)))

    assert np.degrees(max(np.abs(trace.roll_pitch_rad).max() for trace in traces)) < 1.5
    assert min(min(trace.support_margin_m) for trace in traces) > 0.0


def test_on_a_slope_the_com_stands_uphill_of_where_it_stands_on_the_level(at_the_box: Scenario) -> None:
    level = pushed(at_the_box)[-1]
    slope = pushed(replace(at_the_box, room=replace(at_the_box.room, slope_deg=5.0)))[-1]

    shift_m = np.mean(slope.com_m, axis=0)[0] - np.mean(slope.tips_m, axis=(0, 1))[0]
    shift_m -= np.mean(level.com_m, axis=0)[0] - np.mean(level.tips_m, axis=(0, 1))[0]
    assert 0.02 < shift_m < 0.06


def test_deep_pushes_up_a_steep_slope_fold_the_leg_on_its_way_and_are_carried_out(at_the_box: Scenario) -> None:
    scenario = replace(at_the_box, room=replace(at_the_box.room, slope_deg=10.0))
    for trace in pushed(scenario, depth_m=0.1):
        box_x_m = np.array(trace.qpos)[:, BOX_QPOS][:, 0]
        assert box_x_m[-1] - box_x_m[0] > 0.05


@pytest.mark.parametrize("uphill_deg", [0.0, 90.0, 270.0])
def test_after_a_push_on_a_slope_the_trunk_is_where_it_would_be_on_the_level_although_it_leans_uphill(
    at_the_box: Scenario, uphill_deg: float
) -> None:
    on_slope = replace(at_the_box, room=replace(at_the_box.room, slope_deg=5.0, uphill_deg=uphill_deg))

    np.testing.assert_allclose(after_a_push(on_slope), after_a_push(at_the_box), atol=0.02)


def test_the_robot_walks_up_a_slope(at_the_box: Scenario) -> None:
    scenario = replace(
        at_the_box,
        room=replace(at_the_box.room, slope_deg=5.0),
        box=replace(at_the_box.box, pose=replace(at_the_box.box.pose, y_m=8.0)),
    )
    simulator = Simulator()
    simulator.perform(Reset(scenario=scenario, seed=0), with_trace=False)
    path = tuple(Pose2(x_m=x, y_m=5.0, yaw_rad=0.0) for x in np.linspace(2.0, 3.0, 21).tolist())
    outcome = simulator.perform(Follow(waypoints=path), with_trace=False)
    n_cycles = 0
    while outcome.world.path is not None and not outcome.world.path.done:
        outcome = simulator.perform(Walk(), with_trace=False)
        n_cycles += 1

    assert 1 < n_cycles < 20
    assert not outcome.world.fallen
    assert np.mean(outcome.world.tips_m, axis=0)[0] == pytest.approx(3.0, abs=0.03)


def after_a_push(scenario: Scenario) -> Floats:
    """Where the trunk stands after one push, (2,), from the box."""
    simulator = Simulator()
    simulator.perform(Reset(scenario=scenario, seed=0), with_trace=False)
    world = simulator.perform(Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05), with_trace=False).world
    return (planar_pose(world.box).inverse() @ planar_pose(world.trunk)).xy()


def pushed(scenario: Scenario, depth_m: float = 0.05) -> list[Trace]:
    """What happens in a few push cycles."""
    simulator = Simulator()
    simulator.perform(Reset(scenario=scenario, seed=0), with_trace=False)
    traces = []
    for leg in ("FL", "FR", "FL"):
        outcome = simulator.perform(Push(w1=0.5, w2=0.5, leg=leg, depth_m=depth_m), with_trace=True)
        assert outcome.trace is not None
        traces.append(outcome.trace)
    return traces
