"""The compiled model against the tables that it is built from."""

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

from legpush.scene.conventions import BOX_QPOS, JOINT_QPOS, LEG_JOINTS, TRUNK_QPOS
from legpush.scene.scenario import Scenario
from sim_proc.model.world import build_model


def test_joints_and_actuators_come_in_the_order_of_the_legs(at_the_box: Scenario) -> None:
    model = build_model(at_the_box)
    assert [model.joint(i).name for i in range(model.njnt)] == ["trunk", *LEG_JOINTS, "box"]
    assert [model.actuator(i).name for i in range(model.nu)] == list(LEG_JOINTS)
    assert model.joint("trunk").qposadr[0] == TRUNK_QPOS.start
    assert model.joint("FL_hip_x").qposadr[0] == JOINT_QPOS.start
    assert model.joint("box").qposadr[0] == BOX_QPOS.start


def test_the_box_has_the_mass_size_and_friction_of_the_scenario(at_the_box: Scenario) -> None:
    box = replace(at_the_box.box, mass_kg=0.7, friction=0.35, size_m=(0.3, 0.6, 0.5))
    model = build_model(replace(at_the_box, box=box))
    assert model.body("box").mass[0] == pytest.approx(0.7)
    np.testing.assert_allclose(2 * model.geom("box").size, (0.3, 0.6, 0.5))
    for name in ("floor:box", "FL_foot:box"):
        assert model.pair(name).friction[0] == 0.35
    assert model.pair("floor:FL_foot").friction[0] == 1.0


def test_mujoco_is_the_version_that_the_numbers_were_measured_with() -> None:
    assert mujoco.__version__.startswith("4.")
