"""The robot of a scenario as URDF: links with masses and shapes, and joints with their limits.

Names of links and joints are those of the frames and joints of the Foxglove file. A capsule becomes a cylinder with a
sphere at each end, since URDF has none.
"""

from collections.abc import Iterator
from xml.etree import ElementTree as Xml

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import rpy_from_quaternion
from legpush.scene.conventions import LEG_JOINTS, LEGS
from legpush.scene.scenario import Scenario
from sim_proc.headless import mujoco
from sim_proc.model.shapes import Part, Shape, parts_of_model
from sim_proc.model.world import build_model

Solid = tuple[str, dict[str, str], Floats]
"""Tag and sizes of a shape of URDF, and where it is along the z axis of the shape of the model."""


def robot_urdf(scenario: Scenario) -> str:
    """Return the robot of a scenario, as control takes it to be, as the text of a URDF file."""
    model = build_model(scenario)
    parts = {part.name: part for part in parts_of_model(model)}
    robot = Xml.Element("robot", name="legpush")
    children = [model.body(int(model.joint(name).bodyid[0])).name for name in LEG_JOINTS]
    for name in ("trunk", *children):
        _add_link(robot, model, parts[name])
    joints = len(LEGS) * scenario.robot.joints.in_order()
    for name, child, numbers in zip(LEG_JOINTS, children, joints, strict=True):
        part = parts[child]
        joint = Xml.SubElement(robot, "joint", name=name, type="revolute")
        _add_origin(joint, part.position_m, part.quaternion_wxyz)
        Xml.SubElement(joint, "parent", link=part.parent)
        Xml.SubElement(joint, "child", link=child)
        Xml.SubElement(joint, "axis", xyz=_words(part.axis))
        low_rad, high_rad = numbers.limits_rad
        limits = (low_rad, high_rad, numbers.max_torque_n_m, numbers.max_speed_rad_s)
        names = ("lower", "upper", "effort", "velocity")
        Xml.SubElement(joint, "limit", dict(zip(names, map(_word, limits), strict=True)))
        Xml.SubElement(joint, "dynamics", damping=_word(numbers.damping_n_m_s_rad))
    Xml.indent(robot)
    return f'<?xml version="1.0"?>\n{Xml.tostring(robot, encoding="unicode")}\n'


def _add_link(robot: Xml.Element, model: mujoco.MjModel, part: Part) -> None:
    link, body = Xml.SubElement(robot, "link", name=part.name), model.body(part.name)
    inertial = Xml.SubElement(link, "inertial")
    _add_origin(inertial, body.ipos, body.iquat)
    Xml.SubElement(inertial, "mass", value=_word(float(body.mass[0])))
    moments = dict(zip(("ixx", "iyy", "izz"), map(_word, body.inertia.tolist()), strict=True))
    Xml.SubElement(inertial, "inertia", {**moments, "ixy": "0", "ixz": "0", "iyz": "0"})
    for kind in ("visual", "collision"):
        for shape in part.shapes:
            for tag, sizes, offset_m in _solids(shape):
                place = Xml.SubElement(link, kind)
                _add_origin(place, shape.position_m + _turned(offset_m, shape.quaternion_wxyz), shape.quaternion_wxyz)
                Xml.SubElement(Xml.SubElement(place, "geometry"), tag, sizes)
                if kind == "visual":
                    # Readers of URDF know a material by its name, so each colour has its own.
                    material = Xml.SubElement(place, "material", name="_".join(f"{round(255 * c)}" for c in shape.rgba))
                    Xml.SubElement(material, "color", rgba=_words(shape.rgba))


def _solids(shape: Shape) -> Iterator[Solid]:
    radius_m, half_m = float(shape.size_m[0]), float(shape.size_m[1])
    match shape.kind:
        case "box":
            yield "box", {"size": _words(2.0 * shape.size_m)}, np.zeros(3)
        case "sphere":
            yield "sphere", {"radius": _word(radius_m)}, np.zeros(3)
        case "capsule":
            yield "cylinder", {"radius": _word(radius_m), "length": _word(2.0 * half_m)}, np.zeros(3)
            for end in (half_m, -half_m):
                yield "sphere", {"radius": _word(radius_m)}, np.array([0.0, 0.0, end])
        case other:
            raise AssertionError(f"a robot has no {other}")


def _turned(vector: Floats, quaternion_wxyz: Floats) -> Floats:
    turned = np.zeros(3)
    mujoco.mju_rotVecQuat(turned, vector, quaternion_wxyz)
    return turned


def _add_origin(element: Xml.Element, position_m: Floats, quaternion_wxyz: Floats) -> None:
    Xml.SubElement(element, "origin", xyz=_words(position_m), rpy=_words(rpy_from_quaternion(quaternion_wxyz)))


def _words(numbers: object) -> str:
    return " ".join(map(_word, np.asarray(numbers, dtype=np.float64).tolist()))


def _word(number: float) -> str:
    return f"{number:.9g}"
