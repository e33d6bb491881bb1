"""Push maps: what is in them, and their files."""

import dataclasses
from collections.abc import Callable
from pathlib import Path

import pytest
from msgspec.structs import replace

from agent_proc.push_model.calibration import SERIES
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.push_model.map import load_push_map, measured_faces, write_push_map
from agent_proc.push_model.model import NOMINAL, PushModel
from legpush.errors import ConfigError
from legpush.messages.stepping import Push
from legpush.scene.faces import pushed_box
from legpush.scene.names import Face
from legpush.scene.scenario import Box
from tests.agent.push_model.maps import DEPTHS_M, measured


def test_a_map_has_what_pushes_did_by_face_leg_and_depth() -> None:
    push_map = measured()
    truth = PushModel()

    assert {(e.face, e.leg, e.depth_m) for e in push_map.effects} == {
        (face, leg, depth_m) for face in ("rear", "right") for leg in ("FL", "FR") for depth_m in DEPTHS_M
    }
    assert all(effect.n == len(SERIES) for effect in push_map.effects)
    model = push_map.model("rear")
    for depth_m in DEPTHS_M:
        index, expected = model.depth_m.index(depth_m), truth.depth_m.index(depth_m)
        assert model.forward_m[index] == pytest.approx(truth.forward_m[expected], abs=1e-4)
        assert model.left_m[index] == pytest.approx(truth.left_m[expected], abs=1e-4)
        assert model.turn_deg[index] == pytest.approx(truth.turn_deg[expected], abs=1e-2)
    assert push_map.model("front") == dataclasses.replace(model, box=pushed_box(NOMINAL, "front"))
    assert push_map.model("left").forward_m == push_map.model("right").forward_m
    assert (model.depth_m[0], model.forward_m[0], model.turn_deg[0]) == (0.0, 0.0, 0.0)


def test_circles_are_those_of_an_estimate_and_their_intervals_hold_them() -> None:
    push_map = measured()

    for circle in push_map.circles:
        estimate = PushEstimate(pushed_box(NOMINAL, circle.face))
        assert circle.radius_m.value == pytest.approx(estimate.turning_radius_m, rel=1e-3)
        assert circle.axle_m.value == pytest.approx(estimate.axle_m, rel=1e-3)
        low, high = circle.radius_m.ends
        assert low <= circle.radius_m.value <= high


def test_by_the_map_of_a_box_an_estimate_knows_it_at_once() -> None:
    push_map = measured(push_scale=0.8)

    by_map = PushEstimate(NOMINAL, push_map.model("rear"))
    assert by_map.after(NOMINAL.pose.pose(), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)).x_m == pytest.approx(
        0.8 * PushEstimate(NOMINAL).after(NOMINAL.pose.pose(), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)).x_m,
        rel=1e-3,
    )


@pytest.mark.parametrize(
    ("box", "faces"),
    [
        (NOMINAL, ("rear", "right")),
        (replace(NOMINAL, size_m=(0.4, 0.4, 0.4)), ("rear",)),
        (replace(NOMINAL, size_m=(0.4, 0.4, 0.4), shape="cylinder"), ("rear",)),
        (replace(NOMINAL, shape="l_shape"), ("rear", "left")),
        (replace(NOMINAL, shape="wedge"), ("rear",)),
    ],
)
def test_only_faces_that_differ_are_measured(box: Box, faces: tuple[Face, ...]) -> None:
    assert measured_faces(box) == faces
    square = box.size_m[0] == box.size_m[1]
    assert measured(box).model("rear").box.size_m == box.size_m
    if square:
        assert measured(box).model("left").forward_m == measured(box).model("rear").forward_m


def test_the_first_curve_is_what_missions_push_by() -> None:
    model = measured(curves=(0.2, 0.8)).model("rear")

    assert (model.w1, model.w2) == (0.2, 0.2)


def test_a_box_that_pushes_hardly_move_has_no_map() -> None:
    with pytest.raises(
        ConfigError, match=r"0.05 m deep at the rear face it moves 0.00 cm and turns 0.00°: push deeper"
    ):
        measured(push_scale=0.0)


def test_a_map_of_shallow_pushes_alone_is_refused(tmp_path: Path) -> None:
    push_map = measured()
    shallow = tuple(effect for effect in push_map.effects if effect.depth_m < 0.05)
    assert shallow
    write_push_map(replace(push_map, effects=shallow), tmp_path / "map.json")

    with pytest.raises(ConfigError, match=r"expected pushes of 0.05 m or more at the rear face"):
        load_push_map(tmp_path / "map.json", NOMINAL)


def test_a_file_gives_the_map_again(tmp_path: Path) -> None:
    push_map, path = measured(), tmp_path / "map.json"
    write_push_map(push_map, path)

    assert load_push_map(path, replace(NOMINAL, mass_kg=0.9)) == push_map


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: "{", "expected a push map that `legpush calibrate` wrote"),
        (
            lambda text: text.replace("push map 1", "push map 7").replace('"n":', '"m":', 1),
            r"map\.json:2: at `format`: expected one of legpush push map 1, got 'legpush push map 7'\n"
            r".*map\.json:\d+: at `effects\[0\]\.n`: expected a value, got nothing\n"
            r".*map\.json:\d+: at `effects\[0\]\.m`: unknown field",
        ),
        (lambda text: text.replace('"face": "right"', '"face": "left"'), "at rear, right, none at right"),
        (lambda text: text.replace("0.5,\n   0.4", "0.6,\n   0.4"), "of a cuboid of 0.4 x 0.5 x 0.4 m, got that of a"),
    ],
)
def test_a_file_that_is_no_map_of_the_box_is_refused(
    change: Callable[[str], str], message: str, tmp_path: Path
) -> None:
    path = tmp_path / "map.json"
    write_push_map(measured(), path)
    text = change(path.read_text())
    assert text != path.read_text()
    path.write_text(text)

    with pytest.raises(ConfigError, match=message):
        load_push_map(path, NOMINAL)
    with pytest.raises(ConfigError, match="No such file"):
        load_push_map(tmp_path / "none.json", NOMINAL)
