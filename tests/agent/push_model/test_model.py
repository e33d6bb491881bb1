"""The push model: what one push does to the box."""

import csv
from math import cos, radians, sin
from pathlib import Path

import numpy as np
import pytest

from agent_proc.map_world.response_map import load_response_map
from agent_proc.push_model.model import MIRROR, NOMINAL, ON_ITS_SIDE, PushModel, nearest_model
from legpush.messages.stepping import Push
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.faces import pushed_box
from legpush.scene.names import Face

MODEL = PushModel()


def test_one_leg_is_the_mirror_image_of_the_other_in_the_model() -> None:
    depth = np.linspace(0.0, 0.12, 13)
    pose = np.zeros((13, 3))

    left = MODEL.push(pose, np.full(13, MIRROR["FL"]), depth)
    right = MODEL.push(pose, np.full(13, MIRROR["FR"]), depth)

    np.testing.assert_allclose(right, left * [1.0, -1.0, -1.0])
    assert (np.diff(left[:, 0]) > 0.0).all()
    assert (np.diff(left[:, 2]) < 0.0).all()


def test_a_push_of_the_model_moves_along_the_heading_of_the_box() -> None:
    pose = np.array([[1.0, 2.0, radians(30.0)]])
    at_origin = MODEL.push(np.zeros((1, 3)), np.array([1.0]), np.array([0.05]))[0]

    x, y, yaw = MODEL.push(pose, np.array([1.0]), np.array([0.05]))[0]

    c, s = cos(radians(30.0)), sin(radians(30.0))
    assert (x, y) == pytest.approx(
        (1.0 + c * at_origin[0] - s * at_origin[1], 2.0 + s * at_origin[0] + c * at_origin[1])
    )
    assert yaw == pytest.approx(radians(30.0) + at_origin[2])


def test_the_depth_for_a_travel_is_the_inverse_of_the_model() -> None:
    depth = np.array([0.02, 0.045, 0.09])
    travel = MODEL.push(np.zeros((3, 3)), np.ones(3), depth)[:, 0]

    np.testing.assert_allclose(MODEL.depth_for(travel), depth)


@pytest.mark.parametrize("model", [PushModel(), ON_ITS_SIDE])
def test_a_push_model_holds_what_was_measured(model: PushModel) -> None:
    """The model has the numbers of the first measurement. Under the numerics profile each is within two percent,
    or half a millimetre, or a twentieth of a degree.
    """
    table = Path(__file__).parents[3] / "experiments" / "results" / "push_effect.csv"
    with table.open(newline="") as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    length_m, width_m, _ = model.box.size_m
    box = {"length_m": length_m, "width_m": width_m, "mass_kg": 0.1, "friction": 0.5}
    curve = {**box, "w1": model.w1, "w2": model.w2}
    measured = [row for row in rows if curve.items() <= row.items()]
    assert len(measured) == 8
    for name in ("depth_m", "forward_m", "left_m", "turn_deg"):
        least = 0.05 if name == "turn_deg" else 0.0005
        assert getattr(model, name) == pytest.approx((0.0, *(row[name] for row in measured)), rel=0.02, abs=least)


@pytest.mark.parametrize(("model", "face"), [(PushModel(), "rear"), (ON_ITS_SIDE, "right")])
def test_the_effect_of_w1_and_w2_is_that_of_the_response_map(model: PushModel, face: Face) -> None:
    surface = load_response_map().surface(face)
    assert np.array(model.curve) == pytest.approx(np.array(surface.curve), abs=5e-5)
    depth_m = np.array([0.02, 0.09])
    for leg in FRONT_LEGS:
        mirror, usual = np.full(2, MIRROR[leg]), np.full(2, 0.5)
        for w1, w2 in ((0.5, 0.5), (0.1, 0.9), (1.0, 0.2)):
            there, here = (
                surface.displacement(mirror, depth_m, *each)
                for each in ((np.full(2, w1), np.full(2, w2)), (usual, usual))
            )
            found = np.stack(model.beyond_usual_curve(Push(w1=w1, w2=w2, leg=leg, depth_m=0.1), depth_m), axis=1)
            assert found == pytest.approx(there - here, abs=1e-5)


def test_the_model_of_a_box_is_the_one_that_was_measured_with_the_same_side() -> None:
    assert nearest_model(NOMINAL) == PushModel()
    assert nearest_model(pushed_box(NOMINAL, "left")) == ON_ITS_SIDE
