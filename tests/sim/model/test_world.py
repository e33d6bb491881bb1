"""The compiled model against the tables that it is built from."""

from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

from legpush.scene.conventions import BOX_QPOS, JOINT_QPOS, LEG_JOINTS, TRUNK_QPOS
from legpush.scene.names import BoxShape
from legpush.scene.scenario import Rectangle, Scenario
from sim_proc.model.world import build_model, model_xml


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


BOXES: tuple[tuple[BoxShape, tuple[float, float, float]], ...] = (
    ("cuboid", (0.4, 0.5, 0.4)),
    ("cuboid", (10.0, 10.0, 0.05)),
    ("cylinder", (0.4, 0.4, 0.3)),
    ("wedge", (0.05, 10.0, 0.4)),
    ("l_shape", (0.4, 0.6, 0.4)),
)


@pytest.mark.parametrize(("shape", "size_m"), BOXES)
def test_the_mjcf_is_the_simulated_model_for_readers_that_know_less(
    shape: BoxShape, size_m: tuple[float, float, float], at_the_box: Scenario
) -> None:
    walls = (Rectangle(x_min_m=1, x_max_m=2, y_min_m=1, y_max_m=2, appears_at_s=1.0),)
    scenario = replace(
        at_the_box,
        room=replace(at_the_box.room, obstacles=walls),
        box=replace(at_the_box.box, shape=shape, size_m=size_m),
    )
    simulated, xml = build_model(scenario), model_xml(scenario)
    model = mujoco.MjModel.from_xml_string(xml)

    assert {model.pair(i).name for i in range(model.npair)} == {simulated.pair(i).name for i in range(simulated.npair)}
    for kind, n in (("joint", "njnt"), ("actuator", "nu"), ("sensor", "nsensor")):
        both = [[getattr(each, kind)(i).name for i in range(getattr(each, n))] for each in (model, simulated)]
        assert both[0] == both[1] != []
    assert {model.body(i).name for i in range(model.nbody)} == {simulated.body(i).name for i in range(simulated.nbody)}
    for name in [model.body(model.joint(i).bodyid[0]).name for i in range(model.njnt)]:
        one, other = model.body(name), simulated.body(name)
        np.testing.assert_allclose(one.mass, other.mass, rtol=1e-5)
        np.testing.assert_allclose(one.inertia, other.inertia, rtol=1e-5)
        np.testing.assert_allclose(one.ipos, other.ipos, atol=1e-5)
        assert abs(np.dot(one.iquat, other.iquat)) == pytest.approx(1.0, abs=1e-5)

    world = ElementTree.fromstring(xml).find("worldbody")
    assert world is not None
    assert [body.get("name") for body in world.findall("body")][:2] == ["trunk", "box"]
    movable = [body for body in world.iter("body") if {"joint", "freejoint"} & {part.tag for part in body}]
    assert len(movable) == 2 + len(LEG_JOINTS)
    assert all(body.find("inertial") is not None for body in movable)
