"""The robot as URDF: MuJoCo's own reader of URDF finds the same masses, joints and places in it."""

from xml.etree import ElementTree as Xml

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.scenarios.file import load_scenario
from legpush.scene.conventions import JOINT_QPOS, LEG_JOINTS, LEGS, TRUNK_QPOS
from sim_proc.export.urdf import robot_urdf
from sim_proc.headless import mujoco
from sim_proc.model.world import build_model
from tests.robots import ROBOT, scaled_robot

SCENARIO = load_scenario("push")


def read(text: str) -> "mujoco.MjModel":
    """Compile a URDF with all of its links and the given inertias."""
    options = '<mujoco><compiler fusestatic="false" discardvisual="false" balanceinertia="false"/></mujoco>'
    return mujoco.MjModel.from_xml_string(text.replace("</robot>", f"{options}</robot>"))


@pytest.fixture(scope="module")
def model() -> "mujoco.MjModel":
    return read(robot_urdf(SCENARIO))


def test_links_have_the_masses_and_inertias_of_the_robot(model: "mujoco.MjModel") -> None:
    ours = build_model(SCENARIO)
    for name in (f"{leg}_{link}" for leg in LEGS for link in ("hip", "upper", "lower")):
        theirs, mine = model.body(name), ours.body(name)
        np.testing.assert_allclose(theirs.mass, mine.mass, rtol=1e-6)
        np.testing.assert_allclose(np.sort(theirs.inertia), np.sort(mine.inertia), rtol=1e-5)
        np.testing.assert_allclose(theirs.ipos, mine.ipos, atol=1e-7)


def test_joints_have_the_limits_of_the_robot(model: "mujoco.MjModel") -> None:
    text = Xml.fromstring(robot_urdf(SCENARIO))
    limits = {joint.get("name"): joint.find("limit") for joint in text.iter("joint")}
    assert tuple(limits) == LEG_JOINTS
    for name, numbers in zip(LEG_JOINTS, 4 * ROBOT.joints.in_order(), strict=True):
        np.testing.assert_allclose(model.joint(name).range, numbers.limits_rad, atol=1e-6)
        limit = limits[name]
        assert limit is not None
        assert float(limit.get("effort", "0")) == pytest.approx(numbers.max_torque_n_m)
        assert float(limit.get("velocity", "0")) == pytest.approx(numbers.max_speed_rad_s)


@pytest.mark.parametrize("seed", range(5))
def test_feet_are_where_the_simulated_robot_has_them(model: "mujoco.MjModel", seed: int) -> None:
    low, high = np.array([joint.limits_rad for joint in 4 * ROBOT.joints.in_order()]).T
    joints = np.random.default_rng(seed).uniform(low, high)
    data = mujoco.MjData(model)
    for name, angle in zip(LEG_JOINTS, joints, strict=True):
        data.joint(name).qpos[0] = angle
    mujoco.mj_kinematics(model, data)
    simulated = build_model(SCENARIO)
    ours = mujoco.MjData(simulated)
    ours.qpos[TRUNK_QPOS], ours.qpos[JOINT_QPOS] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], joints
    mujoco.mj_kinematics(simulated, ours)
    for leg in LEGS:
        lower = data.body(f"{leg}_lower")
        foot = lower.xpos + lower.xmat.reshape(3, 3) @ [0.0, 0.0, -ROBOT.legs.lower_length_m]
        np.testing.assert_allclose(foot, ours.site(f"{leg}_tip").xpos, atol=1e-6)


def test_shapes_are_visible_and_collide_alike() -> None:
    text = Xml.fromstring(robot_urdf(SCENARIO))
    for link in text.iter("link"):
        assert len(link.findall("visual")) == len(link.findall("collision")) > 0
    lower = next(link for link in text.iter("link") if link.get("name") == "FL_lower")
    kinds = [geometry[0].tag for geometry in lower.iter("geometry")]
    assert kinds == 2 * ["cylinder", "sphere", "sphere", "sphere"]


def test_another_robot_has_another_urdf() -> None:
    small = read(robot_urdf(replace(SCENARIO, robot=scaled_robot(0.7))))
    assert small.body("FL_upper").mass[0] < read(robot_urdf(SCENARIO)).body("FL_upper").mass[0]
