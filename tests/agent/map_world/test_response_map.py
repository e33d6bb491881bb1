"""The response map: many pushes at once, and its file."""

import json
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.map_world.response_map import load_response_map, require_symmetric, write_response_map
from agent_proc.push_model.model import NOMINAL, PushModel
from legpush.errors import ConfigError
from legpush.geometry import Pose2
from legpush.scenarios.file import load_scenario
from legpush.scene.faces import FACES
from legpush.scene.names import BoxShape
from legpush.scene.robot import RobotSpec
from tests.agent.map_world.fake_maps import fake_world_map, known_map

N = 40


def test_the_map_of_a_world_moves_boxes_as_that_world_does() -> None:
    response_map, model = fake_world_map(), PushModel()
    rng = np.random.default_rng(0)
    poses = rng.uniform(-1.0, 1.0, (N, 3))
    mirror, depth = rng.choice([-1.0, 1.0], N), rng.uniform(0.005, 0.12, N)

    mapped = response_map.push(poses, mirror, depth, rng.uniform(size=N), rng.uniform(size=N))
    assert np.abs(mapped - model.push(poses, mirror, depth)).max() < 2e-3


def test_a_push_moves_the_box_in_its_own_frame() -> None:
    response_map = known_map()
    rng = np.random.default_rng(1)
    mirror, depth, normal = rng.choice([-1.0, 1.0], N), rng.uniform(0.005, 0.12, N), rng.standard_normal((N, 3))
    w1, w2 = rng.uniform(size=(2, N))
    poses = rng.uniform(-1.0, 1.0, (N, 3))

    at_origin = response_map.push(np.zeros((N, 3)), mirror, depth, w1, w2, normal=normal)
    mapped = response_map.push(poses, mirror, depth, w1, w2, normal=normal)
    for before, moved, after in zip(poses, at_origin, mapped, strict=True):
        expected = pose(before) @ pose(moved)
        assert (expected.x_m, expected.y_m) == pytest.approx((after[0], after[1]))
        assert expected.yaw_rad == pytest.approx(after[2])


def pose(row: np.ndarray) -> Pose2:
    x_m, y_m, yaw_rad = row.tolist()
    return Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)


def test_faces_that_behave_alike_share_a_surface() -> None:
    response_map = known_map()

    assert [response_map.surface(face).face for face in FACES] == ["rear", "right", "rear", "right"]
    rear_alone = replace(response_map, surfaces=response_map.surfaces[:1])
    with pytest.raises(ConfigError, match="Expected a face among rear of the map, got left"):
        rear_alone.surface("left")


def test_a_map_comes_back_from_its_file(tmp_path: Path) -> None:
    robot = replace(RobotSpec(), stance=replace(RobotSpec().stance, height_m=0.46))
    for response_map in (known_map(), replace(known_map(), robot=robot)):
        write_response_map(response_map, tmp_path / "map.json")
        assert load_response_map(tmp_path / "map.json") == response_map
    assert json.loads((tmp_path / "map.json").read_text())["robot"] == {"stance": {"height_m": 0.46}}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, r"expected a map that `legpush calibrate --random-pushes` wrote \(No such file"),
        ("[", "expected a map that `legpush calibrate --random-pushes` wrote"),
        ("[" * 10**5, "expected a map that `legpush calibrate --random-pushes` wrote"),
        ("{}", "expected a field called `box`|`box`"),
        ('{"format": "legpush push map 1"}', "format"),
    ],
)
def test_a_file_that_is_no_map_is_refused(text: str | None, message: str, tmp_path: Path) -> None:
    file = tmp_path / "map.json"
    if text is not None:
        file.write_text(text)

    with pytest.raises(ConfigError, match=message):
        load_response_map(file)


def test_a_wrong_number_is_told_with_its_line(tmp_path: Path) -> None:
    file = tmp_path / "map.json"
    write_response_map(known_map(), file)
    lines = file.read_text().splitlines()
    (number,) = (index for index, line in enumerate(lines, 1) if '"ticks_per_push"' in line)
    file.write_text("\n".join(lines).replace('"ticks_per_push": 140', '"ticks_per_push": "many"'))

    with pytest.raises(ConfigError, match=rf"map\.json:{number}: at `ticks_per_push`"):
        load_response_map(file)


def test_the_map_that_comes_with_the_package_is_that_of_the_default_box_and_robot() -> None:
    response_map, scenario = load_response_map(), load_scenario("push")

    assert replace(response_map.box, pose=scenario.box.pose) == scenario.box
    assert response_map.robot == scenario.robot
    assert response_map.command.startswith("legpush calibrate --random-pushes 600 ")
    for surface in response_map.surfaces:
        assert surface.quality.n >= 600
        forward, left, turn = surface.quality.r_squared
        assert (forward > 0.99, left > 0.9, turn > 0.9) == (True, True, True)


@pytest.mark.parametrize(
    ("shape", "usable"), [("cuboid", True), ("cylinder", True), ("wedge", False), ("l_shape", False)]
)
def test_only_boxes_that_are_their_own_mirror_image_are_measured(shape: BoxShape, usable: bool) -> None:
    box = replace(NOMINAL, shape=shape, size_m=(0.4, 0.4, 0.4))

    if usable:
        require_symmetric(box)
    else:
        with pytest.raises(ConfigError, match=f"Expected a box of the shape cuboid or cylinder .*, got {shape}"):
            require_symmetric(box)
