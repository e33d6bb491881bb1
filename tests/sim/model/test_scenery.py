"""Floor, walls and goal of the room in the model."""

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.scene.scenario import Goal, PoseDeg, Rectangle, Room, Scenario
from sim_proc.model.scenery import wall_groups
from sim_proc.model.world import build_model


def test_every_obstacle_of_the_room_is_a_wall_in_its_place(at_the_box: Scenario) -> None:
    walls = (
        Rectangle(x_min_m=4.0, x_max_m=4.5, y_min_m=0.0, y_max_m=3.0),
        Rectangle(x_min_m=7.0, x_max_m=9.0, y_min_m=6.0, y_max_m=6.2),
    )
    model = build_model(replace(at_the_box, room=Room(size_m=(12.0, 10.0), obstacles=walls)))
    for index, wall in enumerate(walls):
        geom = model.geom(f"wall_{index}")
        low, high = geom.pos - geom.size, geom.pos + geom.size
        np.testing.assert_allclose(low[:2], [wall.x_min_m, wall.y_min_m])
        np.testing.assert_allclose(high[:2], [wall.x_max_m, wall.y_max_m])


def test_walls_near_each_other_are_one_body_and_far_ones_are_others(at_the_box: Scenario) -> None:
    near = [Rectangle(x_min_m=0.5 + i, x_max_m=1.0 + i, y_min_m=1.0, y_max_m=1.5) for i in range(3)]
    far = Rectangle(x_min_m=9.0, x_max_m=9.5, y_min_m=8.0, y_max_m=8.5)
    long = Rectangle(x_min_m=0.0, x_max_m=12.0, y_min_m=0.0, y_max_m=0.2)
    model = build_model(replace(at_the_box, room=Room(size_m=(12.0, 10.0), obstacles=(*near, far, long))))
    bodies = [model.body(model.geom(f"wall_{index}").bodyid[0]).name for index in range(5)]
    assert bodies == ["walls_0", "walls_0", "walls_0", "walls_1", "walls_2"]
    assert all(model.body(name).weldid[0] == 0 for name in bodies)


@pytest.mark.parametrize(
    ("n", "long_m", "extent_m"), [(1, 1.0, 10.0), (300, 1.0, 30.0), (300, 9.0, 30.0), (50, 1.0, 1e6)]
)
def test_there_are_few_groups_however_many_walls_a_room_has(n: int, long_m: float, extent_m: float) -> None:
    places = np.random.default_rng(0).uniform(0.0, extent_m, (n, 2)).tolist()
    walls = tuple(Rectangle(x_min_m=x, x_max_m=x + long_m, y_min_m=y, y_max_m=y + 0.1) for x, y in places)
    groups = wall_groups(Room(size_m=(30.0, 30.0), obstacles=walls))
    assert sorted(groups) == list(range(n))
    assert len(set(groups.values())) <= min(n, 6 * 6 + 16)


@pytest.mark.parametrize("appears_at_s", [0.0, 1.0])
def test_the_thinnest_and_lowest_walls_have_a_model(at_the_box: Scenario, appears_at_s: float) -> None:
    wall = Rectangle(x_min_m=-0.423, x_max_m=-0.4228, y_min_m=0.0, y_max_m=0.0002, appears_at_s=appears_at_s)
    room = Room(size_m=(12.0, 10.0), obstacles=5 * (wall,), wall_height_m=1e-6)
    assert build_model(replace(at_the_box, room=room)).geom("wall_4").size[2] == pytest.approx(5e-7)


def test_a_wall_that_appears_later_is_a_body_of_its_own_in_its_place(at_the_box: Scenario) -> None:
    later = Rectangle(x_min_m=4.0, x_max_m=4.5, y_min_m=0.0, y_max_m=3.0, appears_at_s=1.0)
    model = build_model(replace(at_the_box, room=Room(size_m=(12.0, 10.0), obstacles=(later,))))
    body = model.body("wall_0")
    assert body.mocapid[0] == 0
    np.testing.assert_allclose(body.pos[:2], [4.25, 1.5])
    assert model.geom("wall_0").bodyid[0] == body.id


def test_the_floor_is_as_large_as_the_room_and_begins_at_the_origin(at_the_box: Scenario) -> None:
    floor = build_model(at_the_box).geom("floor")
    np.testing.assert_allclose([*(floor.pos - floor.size)[:2], *(floor.pos + floor.size)[:2]], [0.0, 0.0, 12.0, 10.0])


def test_the_goal_is_the_outline_of_the_box_at_its_pose_and_touches_nothing(at_the_box: Scenario) -> None:
    goal = Goal(pose=PoseDeg(x_m=6.0, y_m=4.0, yaw_deg=90.0))
    model = build_model(replace(at_the_box, goal=goal))
    body = model.body("goal")
    np.testing.assert_allclose(body.pos, [6.0, 4.0, 0.0])
    np.testing.assert_allclose(body.quat, [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])
    length, width, _ = at_the_box.box.size_m
    assert model.geom("goal_front").pos[0] == pytest.approx(length / 2)
    assert model.geom("goal_left").pos[1] == pytest.approx(width / 2)
    for name in ("goal_front", "goal_rear", "goal_left", "goal_right", "goal_heading"):
        assert (model.geom(name).contype[0], model.geom(name).conaffinity[0]) == (0, 0)
