"""Trees of pushes, from the start and to the goal."""

from itertools import pairwise
from math import inf

import numpy as np
import pytest

from legpush.geometry import Pose2
from legpush.scene.scenario import Rectangle, Room
from planner_proc.box.pushes import Pushes
from planner_proc.box.tree import TURN_M_PER_RAD, Node, Tree
from planner_proc.clearance.field import ClearanceField
from tests.planner.boxes import OPEN, query
from tests.planner.maps import pose

WALL = Room(size_m=(8.0, 8.0), obstacles=(Rectangle(x_min_m=4.6, x_max_m=4.8, y_min_m=0.0, y_max_m=8.0),))
ROOT = pose(4.0, 4.0)


def tree_in(room: Room, *, backward: bool = False, root: Pose2 = ROOT, side: int | None = 0) -> tuple[Tree, Pushes]:
    asked = query(room, root, root)
    pushes = Pushes(asked, ClearanceField(asked.grid))
    tree = Tree(pushes, 60, backward=backward)
    tree.add(Node(pose=root, parent=None, stage=None, side=side))
    return tree, pushes


@pytest.mark.parametrize("backward", [False, True])
def test_a_way_leads_along_free_steps_between_the_root_and_the_node(backward: bool) -> None:
    tree, pushes = tree_in(OPEN, backward=backward)
    random = np.random.default_rng(0)
    for _ in range(40):
        tree.grow(pose(*random.uniform([1.5, 1.5, -3.0], [6.5, 6.5, 3.0]).tolist()), 0.6)

    assert len(tree.nodes) > 20
    for index, node in enumerate(tree.nodes[1:], start=1):
        way = tree.way(index)
        assert (way[0].begin, way[-1].end) == ((node.pose, ROOT) if backward else (ROOT, node.pose))
        assert all(a.end == b.begin for a, b in pairwise(way))
        assert max(stage.length_m for stage in way) <= 0.6
        assert all(pushes.sides[stage.side].seems_free(stage, 0.0) for stage in way)
        assert node.parent is not None
        assert node.parent < index
    assert tree.way(0) == ()


def test_a_step_through_a_wall_is_not_added() -> None:
    tree, _ = tree_in(WALL)

    assert tree.grow(pose(5.5, 4.0), 2.0) is None
    assert len(tree.nodes) == 1
    node = tree.grow(pose(5.5, 4.0), 0.2)
    assert node is not None
    assert node.pose.xy() == pytest.approx([4.2, 4.0])
    assert (node.parent, node.side) == (0, 0)


def test_backward_a_step_ends_at_the_node_and_begins_toward_the_target() -> None:
    tree, _ = tree_in(OPEN, backward=True)
    node = tree.grow(pose(2.0, 4.0), 0.5)

    assert node is not None
    assert node.stage is not None
    assert node.pose.xy() == pytest.approx([3.5, 4.0])
    assert (node.stage.begin, node.stage.end, node.stage.length_m) == (node.pose, ROOT, 0.5)


def test_the_nearest_node_is_so_in_place_and_heading() -> None:
    tree, _ = tree_in(OPEN)
    tree.add(Node(pose=pose(4.0, 4.0, 1.0), parent=0, stage=None, side=0))
    tree.add(Node(pose=pose(4.0 + 0.9 * TURN_M_PER_RAD, 4.0), parent=0, stage=None, side=0))
    tree.add(Node(pose=pose(4.0, 4.0, 2 * np.pi - 0.1), parent=0, stage=None, side=0))

    assert tree.nearest(ROOT, 4) == [0, 3, 2, 1]
    assert tree.nearest(pose(4.0, 4.0, 1.1), 1) == [1]


@pytest.mark.parametrize("side", [0, 1])
def test_of_pushes_of_about_equal_length_the_cheapest_is_from_the_side_where_the_robot_stands(side: int) -> None:
    tree, _ = tree_in(OPEN, side=side)
    node = tree.grow(pose(5.2, 5.2), inf)

    assert node is not None
    assert node.side == side
