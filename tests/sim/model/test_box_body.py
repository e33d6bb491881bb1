"""Boxes that are no cuboids: what they weigh, where, and that they can be pushed."""

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.messages.stepping import Push, Reset
from legpush.scene.names import BoxShape
from legpush.scene.scenario import Box, PoseDeg, Scenario
from sim_proc.control.push_cycle import contact_point
from sim_proc.model.world import build_model
from sim_proc.simulator import Simulator
from tests.robots import ROBOT

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
        contact_point(ROBOT, pose, shaped(at_the_box, shape).box, "FL", 0.05) for shape in ("cuboid", "cylinder")
    )

    assert flat[0] == pytest.approx(-LENGTH_M / 2 + 0.05 - ROBOT.legs.foot_radius_m)
    on_surface = np.hypot(round_[0] - 0.05 + ROBOT.legs.foot_radius_m, round_[1])
    assert on_surface == pytest.approx(LENGTH_M / 2)


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
