"""Bodies and shapes of a model as numbers."""

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.scene.conventions import JOINT_QPOS, LEGS
from legpush.scene.scenario import Scenario
from sim_proc.model.shapes import FLOOR_GREY, Part, parts_of


@pytest.fixture
def parts(at_the_box: Scenario) -> dict[str, Part]:
    return {part.name: part for part in parts_of(at_the_box)}


def test_every_body_comes_after_its_parent(parts: dict[str, Part]) -> None:
    names = list(parts)
    assert names[0] == "world"
    assert all(names.index(part.parent) < names.index(part.name) for part in list(parts.values())[1:])
    assert parts["FL_lower"].parent == "FL_upper"


def test_joints_and_their_columns_are_those_of_qpos(parts: dict[str, Part]) -> None:
    assert {name: part.joint for name, part in parts.items() if part.joint == "free"} == {
        "trunk": "free",
        "box": "free",
    }
    hinges = [part for part in parts.values() if part.joint == "hinge"]
    assert [part.qpos for part in hinges] == list(range(JOINT_QPOS.start, JOINT_QPOS.stop))
    assert [part.name.partition("_")[0] for part in hinges[::3]] == list(LEGS)
    assert (parts["goal"].joint, parts["goal"].qpos) == ("none", -1)


def test_shapes_have_the_sizes_and_colours_of_their_geoms(parts: dict[str, Part], at_the_box: Scenario) -> None:
    (box,) = (shape for shape in parts["box"].shapes if shape.name == "box")
    assert box.kind == "box"
    np.testing.assert_allclose(2 * box.size_m, at_the_box.box.size_m)
    (floor,) = (shape for shape in parts["world"].shapes if shape.name == "floor")
    assert (floor.kind, floor.rgba) == ("plane", FLOOR_GREY)
    kinds = {shape.kind for part in parts.values() for shape in part.shapes}
    assert kinds == {"plane", "box", "capsule", "sphere"}


def test_a_mesh_brings_its_triangles_and_other_shapes_none(at_the_box: Scenario) -> None:
    wedge = replace(at_the_box, box=replace(at_the_box.box, shape="wedge"))
    shapes = {shape.name: shape for part in parts_of(wedge) for shape in part.shapes}
    assert shapes["box"].kind == "mesh"
    assert shapes["box"].triangles_m.shape == (8, 3, 3)
    assert shapes["floor"].triangles_m.shape == (0, 3, 3)
