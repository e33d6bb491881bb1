"""The seam between control and the robot: what fulfils `Plant`, with and without physics."""

import numpy as np
import pytest

from legpush.geometry import Pose2
from legpush.scene.conventions import N_QPOS
from legpush.scene.scenario import Scenario
from sim_proc.control.joint_commands import COMMANDS_PER_TICK
from sim_proc.control.plant import Plant, StepLog, TickLog
from sim_proc.physics.physics import Physics
from tests.sim.commands import held
from tests.sim.control.kinematic_plant import KinematicPlant

MEMBERS = {*Plant.__annotations__, *(name for name in vars(Plant) if not name.startswith("_"))}
SHAPES = {
    "qpos": (N_QPOS,),
    "tips_m": (4, 3),
    "floor_forces_n": (4, 3),
    "box_forces_n": (4, 3),
    "com_m": (3,),
    "ctrl": (COMMANDS_PER_TICK, 12),
}
"""Shape of a row of each array of a `TickLog`."""
STEP_SHAPES = {
    "tips_m": (4, 3),
    "floor_forces_n": (4, 3),
    "box_forces_n": (4, 3),
    "com_m": (3,),
    "com_velocity_m_s": (3,),
    "joint_positions_rad": (12,),
    "joint_velocities_rad_s": (12,),
    "joint_torques_n_m": (12,),
    "trunk_velocity_m_s": (3,),
    "imu_angular_velocity_rad_s": (3,),
    "imu_acceleration_m_s2": (3,),
}
"""Shape of a row of each array of a `StepLog`."""


def physics(scenario: Scenario) -> Plant:
    plant: Plant = Physics(scenario, scenario.start.pose(), scenario.box.pose.pose())  # mypy checks the signatures
    return plant


def kinematic(scenario: Scenario) -> Plant:
    plant: Plant = KinematicPlant(scenario.start.pose(), scenario.box)
    return plant


@pytest.fixture(params=[physics, kinematic])
def plant(request: pytest.FixtureRequest, at_the_box: Scenario) -> Plant:
    made: Plant = request.param(at_the_box)
    return made


def test_a_plant_has_every_member_of_the_protocol(plant: Plant) -> None:
    assert {"fallen", "mass_kg", "downhill", "run"} < MEMBERS
    assert {name for name in MEMBERS if not hasattr(plant, name)} == set()


def test_a_plant_measures_a_robot_that_stands_at_the_box(plant: Plant, at_the_box: Scenario) -> None:
    assert plant.fallen is False
    assert plant.mass_kg == pytest.approx(32.0, abs=0.5)
    np.testing.assert_array_equal(plant.downhill, np.zeros(2))
    for pose, expected in (
        (plant.trunk_pose(), at_the_box.start.pose()),
        (plant.box_pose(), at_the_box.box.pose.pose()),
    ):
        assert isinstance(pose, Pose2)
        np.testing.assert_allclose([*pose.xy(), pose.yaw_rad], [*expected.xy(), expected.yaw_rad])
    assert plant.joints_rad().shape == (12,)
    assert plant.com_m().shape == (3,)
    np.testing.assert_allclose(plant.tips_m()[:, 2], 0.02, atol=1e-6)


def test_a_plant_logs_one_row_for_each_command(plant: Plant) -> None:
    commands = np.repeat(plant.joints_rad()[None], 7, axis=0)

    log = plant.run(held(commands))

    assert {*SHAPES, "steps", "touched_down", "not_down", "left_plan"} == set(TickLog.__dataclass_fields__)
    assert (log.touched_down, log.not_down) == (False, None)
    assert {name: getattr(log, name).shape for name in SHAPES} == {name: (7, *row) for name, row in SHAPES.items()}
    assert all(np.isfinite(getattr(log, name)).all() for name in SHAPES)
    assert set(STEP_SHAPES) == set(StepLog.__dataclass_fields__)
    for name, row in STEP_SHAPES.items():
        steps = getattr(log.steps, name)
        assert steps.shape == (7, COMMANDS_PER_TICK, *row)
        assert np.isfinite(steps).all()


def test_a_row_of_a_tick_is_its_last_physics_step(plant: Plant) -> None:
    log = plant.run(held(np.repeat(plant.joints_rad()[None], 4, axis=0)))
    for name in SHAPES.keys() & STEP_SHAPES.keys():
        np.testing.assert_array_equal(getattr(log, name), getattr(log.steps, name)[:, -1])


def test_what_a_plant_measured_does_not_change_when_it_moves_on(plant: Plant) -> None:
    before = plant.joints_rad()
    kept = before.copy()
    lifted = before.copy()
    lifted[2] += 0.05
    commands = np.linspace(before, lifted, 5)

    plant.run(held(commands))

    np.testing.assert_array_equal(before, kept)
    assert np.abs(plant.joints_rad() - kept).max() > 0.0
