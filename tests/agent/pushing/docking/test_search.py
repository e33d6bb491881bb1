"""Sequences of pushes and walks that bring a box to its goal, against all short sequences."""

from collections.abc import Sequence
from itertools import product
from math import hypot, inf, radians

import numpy as np
import pytest

from agent_proc.pushing.docking.moves import PUSH_S, DockMove, DockPush, DockWalk, dock_pushes, walk_s
from agent_proc.pushing.docking.search import WEIGHT, DockSearch
from legpush.geometry import Pose2
from legpush.scene.faces import FACES
from legpush.scene.names import Face
from tests.agent.pushing.docking.boxes import estimates

PUSHES = dock_pushes(estimates())
NEAR_M, NEAR_RAD = 0.01, radians(1.0)
SEARCH = DockSearch(PUSHES, NEAR_M, NEAR_RAD)


def anywhere(_box: Pose2, _face: Face) -> bool:
    return True


def pose(x_m: float, y_m: float, yaw_deg: float) -> Pose2:
    return Pose2(x_m=x_m, y_m=y_m, yaw_rad=radians(yaw_deg))


def is_there(box: Pose2) -> bool:
    return hypot(box.x_m, box.y_m) <= NEAR_M and abs(box.yaw_rad) <= NEAR_RAD


def carried_out(box: Pose2, face: Face | None, moves: Sequence[DockMove]) -> tuple[Pose2, float]:
    """Where the box ends, and after how long; pushes are at the face where the robot stands."""
    took_s = 0.0
    for move in moves:
        if isinstance(move, DockWalk):
            took_s += walk_s(face, move.face)
            face = move.face
        else:
            assert move.face == face
            box, took_s = move.after(box), took_s + PUSH_S
    return box, took_s


def test_what_is_found_brings_the_box_to_its_goal() -> None:
    rng, n_found = np.random.default_rng(1), 0
    for index, face in enumerate((*FACES, None) * 4):
        x_m, y_m, yaw_deg = rng.uniform((-0.1, -0.1, -5.0), (0.1, 0.1, 5.0)).tolist()
        start = pose(x_m, y_m, yaw_deg)
        moves = SEARCH.find(start, face, anywhere)
        if moves is not None:
            end, _ = carried_out(start, face, moves)
            assert is_there(end), index
            n_found += 1
    assert n_found >= 18


@pytest.mark.parametrize(
    ("x_m", "y_m", "yaw_deg"), [(-0.03, 0.0, 0.0), (0.02, 0.0, 0.0), (0.0, 0.025, 1.0), (-0.04, 0.012, -4.0)]
)
def test_no_short_sequence_is_much_quicker(x_m: float, y_m: float, yaw_deg: float) -> None:
    """Against all sequences of up to three pushes with a walk before, after the first of them, or none."""
    start = pose(x_m, y_m, yaw_deg)
    best_s = inf
    for first, last in product(FACES, repeat=2):
        walk_between: list[DockMove] = [DockWalk(face=last)] if last != first else []
        walk_before: list[DockMove] = [DockWalk(face=first)] if first != "rear" else []
        for n_first, n_last in ((1, 0), (0, 1), (1, 1), (1, 2), (2, 1)):
            for pushes in product(*[PUSHES[first]] * n_first, *[PUSHES[last]] * n_last):
                moves = [*walk_before, *pushes[:n_first], *walk_between, *pushes[n_first:]]
                end, took_s = carried_out(start, "rear", moves)
                if took_s < best_s and is_there(end):
                    best_s = took_s
    found = SEARCH.find(start, "rear", anywhere)
    assert found is not None
    assert carried_out(start, "rear", found)[1] <= WEIGHT * best_s + 1e-9


def test_a_box_at_its_goal_needs_no_move() -> None:
    assert SEARCH.find(pose(0.005, 0.0, 0.5), "rear", anywhere) == ()


def test_a_box_beyond_its_goal_is_pushed_back_from_the_opposite_face() -> None:
    moves = SEARCH.find(pose(0.05, 0.0, 0.0), "rear", anywhere)
    assert moves is not None
    assert moves[0] == DockWalk(face="front")
    assert all(isinstance(move, DockPush) and move.face == "front" for move in moves[1:])


def test_where_there_is_no_space_nothing_is_pushed() -> None:
    beyond = pose(0.05, 0.0, 0.0)
    assert SEARCH.find(beyond, "rear", lambda _box, face: face == "rear") is None


def test_the_last_pose_needs_space_as_well() -> None:
    assert SEARCH.find(pose(-0.03, 0.0, 0.0), "rear", lambda box, _face: not is_there(box)) is None


def test_with_one_face_a_box_beyond_its_goal_cannot_come_back() -> None:
    search = DockSearch({"rear": PUSHES["rear"]}, NEAR_M, NEAR_RAD)
    assert search.find(pose(0.05, 0.0, 0.0), "rear", anywhere) is None
    assert search.find(pose(-0.05, 0.0, 0.0), "rear", anywhere)
