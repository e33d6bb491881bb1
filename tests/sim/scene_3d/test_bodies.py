"""Meshes of the bodies, and where they are."""

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.history.timeline import Timeline
from legpush.messages.stepping import Appearance
from legpush.scene.conventions import LEGS
from legpush.scene.scenario import Rectangle, Room, Scenario
from sim_proc.scene_3d.bodies import Bodies


@pytest.fixture
def with_walls(at_the_box: Scenario) -> Scenario:
    """A wall, and one that appears."""
    walls = (
        Rectangle(x_min_m=1.0, x_max_m=1.5, y_min_m=8.0, y_max_m=9.0),
        Rectangle(x_min_m=4.0, x_max_m=4.5, y_min_m=8.0, y_max_m=9.0, appears_at_s=0.4),
    )
    return replace(at_the_box, room=Room(size_m=(12.0, 10.0), obstacles=walls))


def test_every_visible_body_has_a_mesh_of_its_size_and_the_floor_has_none(with_walls: Scenario) -> None:
    bodies = {body.name: body for body in Bodies(with_walls).all}
    links = {f"{leg}_{link}" for leg in LEGS for link in ("hip", "upper", "lower")}
    assert set(bodies) == {"walls_0", "trunk", "box", "goal", "wall_1", *links}
    length, width, height = np.ptp(bodies["box"].mesh.bounds, axis=0)
    assert (length, width) == pytest.approx(with_walls.box.size_m[:2])
    assert height == pytest.approx(with_walls.box.size_m[2], abs=0.003)
    (low, high) = bodies["walls_0"].mesh.bounds
    np.testing.assert_allclose([*low[:2], *high[:2]], [1.0, 8.0, 1.5, 9.0])


def test_bodies_are_where_qpos_says(timeline: Timeline) -> None:
    bodies = Bodies(timeline.scenario)
    index = {body.name: body.index for body in bodies.all}
    positions, quaternions = bodies.poses(timeline.qpos[-1])
    np.testing.assert_allclose(positions[index["trunk"]], timeline.qpos[-1, :3])
    np.testing.assert_allclose(quaternions[index["box"]], timeline.qpos[-1, 22:], atol=1e-12)
    assert np.linalg.norm(positions[index["FL_hip"]] - positions[index["trunk"]]) == pytest.approx(0.303, abs=0.001)


def test_only_an_obstacle_that_appears_is_hidden_until_its_tick(with_walls: Scenario) -> None:
    bodies = Bodies(with_walls)
    by_name = {body.name: body for body in bodies.all}
    appeared = (Appearance(obstacle=1, tick=20),)
    assert [name for name, body in by_name.items() if body.appears] == ["wall_1"]
    assert [bodies.is_there(by_name["wall_1"], appeared, tick) for tick in (0, 19, 20, 90)] == [
        False,
        False,
        True,
        True,
    ]
    assert not bodies.is_there(by_name["wall_1"], (), 90)
    assert bodies.is_there(by_name["box"], (), 0)
