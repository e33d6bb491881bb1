"""What the simulator reports of the world and of the ticks."""

import numpy as np
import pytest

from legpush.arrays import Floats
from legpush.messages.stepping import Trace
from legpush.scene.conventions import N_QPOS
from legpush.scene.scenario import Scenario
from sim_proc.control.plant import StepLog, TickLog
from sim_proc.measures.motion import Meter
from sim_proc.observation import trace, world_state
from sim_proc.physics.physics import Physics
from tests.robots import ROBOT

LEVEL = np.zeros(2)


def log(n: int, load_n: Floats, com_m: tuple[float, float, float] = (0.0, 0.0, 0.43)) -> TickLog:
    """A robot that stands on feet with these loads, (4,), for some ticks."""
    qpos = np.zeros((n, N_QPOS))
    qpos[:, 3] = qpos[:, 22] = 1.0
    tips, floor = np.zeros((n, 4, 3)), np.zeros((n, 4, 3))
    tips[:, :, :2] = ROBOT.stance.foot_rectangle_b()
    floor[:, :, 2] = load_n
    box, com, joints = np.ones((n, 4, 3)), np.tile(com_m, (n, 1)), np.zeros((n, 1, 12))
    return TickLog(
        qpos=qpos,
        tips_m=tips,
        floor_forces_n=floor,
        box_forces_n=box,
        com_m=com,
        ctrl=joints,
        steps=StepLog(
            tips_m=tips[:, None],
            floor_forces_n=floor[:, None],
            box_forces_n=box[:, None],
            com_m=com[:, None],
            com_velocity_m_s=np.zeros((n, 1, 3)),
            joint_positions_rad=joints,
            joint_velocities_rad_s=joints + 0.5,
            joint_torques_n_m=joints + 2.0,
            trunk_velocity_m_s=np.full((n, 1, 3), 0.1),
            imu_angular_velocity_rad_s=np.full((n, 1, 3), 0.2),
            imu_acceleration_m_s2=np.full((n, 1, 3), 9.0),
        ),
        touched_down=False,
    )


def traced(logs: list[TickLog], last_tick: int, downhill: Floats = LEVEL) -> Trace:
    return trace(logs, last_tick, Meter(ROBOT, downhill).measure(logs, n_footsteps=0))


def test_a_step_without_ticks_has_an_empty_trace() -> None:
    empty = trace([], 5, None)
    assert {name: getattr(empty, name) for name in Trace.__struct_fields__} == dict.fromkeys(
        Trace.__struct_fields__, ()
    )


def test_logs_are_joined_up_to_the_last_tick() -> None:
    joined = traced([log(2, np.ones(4)), log(3, np.ones(4))], 10)
    assert joined.tick == (6, 7, 8, 9, 10)
    assert {len(getattr(joined, name)) for name in Trace.__struct_fields__} == {5}
    assert isinstance(joined.tips_m[0][0][0], float)
    assert joined.joint_velocities_rad_s[-1] == (0.5,) * 12
    assert joined.joint_torques_n_m[-1] == (2.0,) * 12
    assert joined.trunk_velocity_m_s[-1] == (0.1,) * 3
    assert joined.imu_angular_velocity_rad_s[-1] == (0.2,) * 3
    assert joined.imu_acceleration_m_s2[-1] == (9.0,) * 3


def test_the_zmp_is_the_centre_of_pressure_of_the_feet() -> None:
    (zmp,) = traced([log(1, np.array([30.0, 10.0, 30.0, 10.0]))], 1).zmp_m
    np.testing.assert_allclose(zmp, [0.0, 0.3346 / 4])


def test_in_the_air_the_zmp_is_below_the_com() -> None:
    (zmp,) = traced([log(1, np.zeros(4), (0.1, -0.2, 0.6))], 1).zmp_m
    assert zmp == (0.1, -0.2)


def test_contact_forces_are_those_of_floor_and_box_together() -> None:
    (forces,) = traced([log(1, np.full(4, 80.0))], 1).contact_forces_n
    assert forces == ((1.0, 1.0, 81.0),) * 4


def test_on_a_slope_the_margin_is_that_of_the_point_where_the_plumb_line_ends() -> None:
    level, slope = (traced([log(1, np.full(4, 80.0))], 1, downhill) for downhill in (LEVEL, np.array([0.0, 0.1])))
    assert level.support_margin_m == pytest.approx((0.3346 / 2,))
    assert slope.support_margin_m == pytest.approx((0.3346 / 2 - 0.043,))


def test_the_state_of_the_world_is_that_of_the_physics(at_the_box: Scenario) -> None:
    physics = Physics(at_the_box, at_the_box.start.pose(), at_the_box.box.pose.pose())
    physics.data.qvel[:3] = [0.1, 0.2, 0.3]
    world = world_state(physics, 8, None, None, None)
    assert (world.tick, world.n_footsteps, world.fallen, world.path, world.push) == (0, 8, False, None, None)
    assert world.trunk.linear_velocity_m_s == (0.1, 0.2, 0.3)
    assert world.trunk.position_m == tuple(physics.data.qpos[:3])
    assert world.box.position_m == tuple(physics.data.qpos[19:22])
    np.testing.assert_allclose(np.ravel(world.joint_positions_rad), physics.joints_rad())
