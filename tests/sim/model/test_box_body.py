"""Boxes that are no cuboids: what they weigh, where, and that they can be pushed."""

from collections.abc import Callable

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, Reset
from legpush.scene.names import BoxShape
from legpush.scene.scenario import Box, PoseDeg, Scenario
from legpush.scene.solid import steps_to_surface
from sim_proc.control.push_cycle import contact_point
from sim_proc.model.world import build_model
from sim_proc.simulator import Simulator
from tests.robots import ROBOT
from tests.sim.conftest import standing_at_the_box

SHAPES: tuple[BoxShape, ...] = ("cuboid", "cylinder", "wedge", "l_shape")
LENGTH_M, WIDTH_M, HEIGHT_M = 0.4, 0.5, 0.3


def shaped(scenario: Scenario, shape: BoxShape, mass_kg: float = 0.6) -> Scenario:
    """The scenario with a box of that shape in the same place."""
    size_m = (LENGTH_M, LENGTH_M if shape == "cylinder" else WIDTH_M, HEIGHT_M)
    return replace(scenario, box=replace(scenario.box, shape=shape, size_m=size_m, mass_kg=mass_kg))


@pytest.mark.parametrize(
    ("shape", "com_m"),
    [
        ("cuboid", (0.0, 0.0, 0.0)),
        ("cylinder", (0.0, 0.0, 0.0)),
        ("wedge", (-LENGTH_M / 6, 0.0, -HEIGHT_M / 6)),
        ("l_shape", (-LENGTH_M / 12, WIDTH_M / 12, 0.0)),
    ],
)
def test_a_shape_has_its_mass_where_even_density_puts_it(
    at_the_box: Scenario, shape: BoxShape, com_m: tuple[float, float, float]
) -> None:
    model = build_model(shaped(at_the_box, shape))

    assert model.body("box").mass[0] == pytest.approx(0.6)
    np.testing.assert_allclose(model.body("box").ipos, com_m, atol=1e-6)


@pytest.mark.parametrize("shape", SHAPES)
def test_floor_and_feet_touch_every_part_of_a_shape(at_the_box: Scenario, shape: BoxShape) -> None:
    model = build_model(shaped(at_the_box, shape))
    parts = {model.geom(i).name for i in range(model.ngeom) if model.geom(i).bodyid[0] == model.body("box").id}
    pairs = {model.pair(i).name for i in range(model.npair)}

    touching = {name for name in parts if name != "box_heading"}
    assert touching == ({"box", "box_1"} if shape == "l_shape" else {"box"})
    assert {f"floor:{part}" for part in touching} | {f"FL_foot:{part}" for part in touching} <= pairs


@pytest.mark.parametrize("shape", SHAPES)
def test_a_shape_rests_on_the_floor_and_is_pushed_forward(at_the_box: Scenario, shape: BoxShape) -> None:
    simulator = Simulator()
    before = simulator.perform(Reset(scenario=shaped(at_the_box, shape), seed=0), with_trace=False).world.box
    after = [
        simulator.perform(Push(w1=0.5, w2=0.5, leg=leg, depth_m=0.05), with_trace=False).world for leg in ("FL", "FR")
    ][-1]

    assert after.push is not None
    assert after.push.touched
    assert after.push.peak_force_n > 0.1
    assert 0.04 < after.box.position_m[0] - before.position_m[0] < 0.12
    assert after.box.position_m[2] == pytest.approx(HEIGHT_M / 2, abs=2e-3)


def test_the_curve_ends_where_the_surface_of_the_shape_is(at_the_box: Scenario) -> None:
    pose = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)
    flat, round_ = (
        contact_point(ROBOT, shaped(at_the_box, shape).box, pose, "rear", "FL", 0.05)
        for shape in ("cuboid", "cylinder")
    )

    assert flat[0] == pytest.approx(-LENGTH_M / 2 + 0.05 - ROBOT.legs.foot_radius_m)
    on_surface = np.hypot(round_[0] - 0.05 + ROBOT.legs.foot_radius_m, round_[1])
    assert on_surface == pytest.approx(LENGTH_M / 2)


SOLIDS: dict[str, Callable[[float, float, float], bool]] = {
    "cuboid": lambda x, y, z: True,
    "cylinder": lambda x, y, z: bool(np.hypot(x, y) < LENGTH_M / 2),
    "wedge": lambda x, y, z: x / LENGTH_M + z / HEIGHT_M < 0.0,
    "l_shape": lambda x, y, z: not (x > 0.0 > y),
}


@given(
    st.sampled_from(SHAPES),
    st.tuples(*[st.floats(-1.0, 1.0).filter(lambda part: abs(part) > 0.01)] * 3),
    st.floats(0.01, 0.89),
)
@settings(max_examples=60, deadline=None)
def test_a_load_at_the_surface_puts_the_centre_of_mass_where_the_offset_says(
    shape: BoxShape, direction: tuple[float, float, float], share: float
) -> None:
    scenario = shaped(standing_at_the_box(), shape)
    steps = steps_to_surface(shape, scenario.box.size_m, direction)
    x, y, z = (share * steps * part for part in direction)
    box = replace(scenario.box, com_offset_m=(x, y, z))
    model, even = build_model(replace(scenario, box=box)), build_model(scenario)
    body = model.body("box")

    assert body.mass[0] == pytest.approx(0.6)
    np.testing.assert_allclose(body.ipos, even.body("box").ipos + np.array([x, y, z]), atol=1e-6)
    np.testing.assert_allclose(body.ipos, box.com_m, atol=1e-6)
    load = model.geom("box_load")
    assert box.load_share == pytest.approx(share)
    assert (load.contype[0], load.conaffinity[0]) == (0, 0)
    half = np.array(scenario.box.size_m) / 2
    for inside in (0.999, 1.001):
        place = even.body("box").ipos + inside * (load.pos - even.body("box").ipos)
        assert (bool((np.abs(place) < half).all()) and bool(SOLIDS[shape](*place))) == (inside < 1.0)


def test_the_load_adds_its_moments_of_inertia(at_the_box: Scenario) -> None:
    box = replace(at_the_box.box, mass_kg=2.0, com_offset_m=(0.0, 0.1, 0.0))
    model = build_model(replace(at_the_box, box=box))
    (length, width, height), share = box.size_m, 0.4
    even = 2.0 * (1 - share) / 12 * np.array([width**2 + height**2, length**2 + height**2, length**2 + width**2])
    apart = 2.0 * (share * (width / 2 - 0.1) ** 2 + (1 - share) * 0.1**2)

    assert box.load_share == pytest.approx(share)
    inertia = even + apart * np.array([1.0, 0.0, 1.0])
    np.testing.assert_allclose(np.sort(model.body("box").inertia), np.sort(inertia), rtol=1e-2)


@pytest.mark.parametrize("shape", SHAPES)
def test_a_centre_of_mass_at_the_surface_is_refused(at_the_box: Scenario, shape: BoxShape) -> None:
    box = shaped(at_the_box, shape).box
    step = (0.1, -0.1, 0.1)
    steps = steps_to_surface(shape, box.size_m, step)
    x, y, z = (0.91 * steps * part for part in step)
    with pytest.raises(
        ValueError, match=rf"com_offset_m at most 0.9 of the way to the surface of the {shape}.*0.91 of"
    ):
        replace(box, com_offset_m=(x, y, z))


def test_a_load_on_one_side_turns_a_box_that_is_pushed_in_the_middle_of_its_face(at_the_box: Scenario) -> None:
    def turn_rad(offset_m: float) -> float:
        simulator, box = Simulator(), replace(at_the_box.box, mass_kg=2.0, com_offset_m=(0.0, offset_m, 0.0))
        simulator.perform(Reset(scenario=replace(at_the_box, box=box), seed=0), with_trace=False)
        for leg in ("FL", "FR"):
            outcome = simulator.perform(Push(w1=0.5, w2=0.5, leg=leg, depth_m=0.05), with_trace=False)
        return planar_pose(outcome.world.box).yaw_rad

    even, left = turn_rad(0.0), turn_rad(0.1)
    assert left > even + 0.01


def test_the_mesh_of_a_wedge_is_as_large_as_it_should_be(at_the_box: Scenario) -> None:
    model = build_model(shaped(at_the_box, "wedge"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    geom, mesh = model.geom("box"), model.mesh("wedge")
    corners = model.mesh_vert[mesh.vertadr[0] : mesh.vertadr[0] + mesh.vertnum[0]]
    seen = data.geom_xpos[geom.id] + corners @ data.geom_xmat[geom.id].reshape(3, 3).T - data.body("box").xpos

    np.testing.assert_allclose(seen.min(axis=0), (-LENGTH_M / 2, -WIDTH_M / 2, -HEIGHT_M / 2), atol=1e-6)
    np.testing.assert_allclose(seen.max(axis=0), (LENGTH_M / 2, WIDTH_M / 2, HEIGHT_M / 2), atol=1e-6)
    assert seen[seen[:, 0] > 0.0][:, 2].max() == pytest.approx(-HEIGHT_M / 2, abs=1e-6)


def test_a_cylinder_that_is_not_round_is_refused() -> None:
    with pytest.raises(ValueError, match=r"equal length and width of a cylinder in size_m, got 0.4 and 0.5"):
        Box(pose=PoseDeg(x_m=0.0, y_m=0.0, yaw_deg=0.0), shape="cylinder", size_m=(0.4, 0.5, 0.4))
