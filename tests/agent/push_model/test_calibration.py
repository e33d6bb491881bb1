"""Calibration: series of pushes at the faces of a box, in one world or several."""

import threading
from math import degrees

import pytest

from agent_proc.push_model.calibration import (
    SERIES,
    CalibrationError,
    Cell,
    cell_samples,
    cells,
    in_worlds,
    open_floor,
)
from agent_proc.push_model.map import Sample
from agent_proc.push_model.model import NOMINAL
from legpush.errors import StopRequestedError
from legpush.lockstep.world import SteppingWorld
from legpush.messages.stepping import Push
from legpush.scene.faces import FACES, pushed_box, pushed_pose
from legpush.scene.names import Face
from legpush.scene.station import at_station
from tests.agent.fake_world import FakeWorld
from tests.robots import ROBOT


@pytest.mark.parametrize("face", FACES)
def test_the_robot_stands_ready_at_the_face_that_is_measured(face: Face) -> None:
    scenario = open_floor(ROBOT, NOMINAL, face)
    pose = scenario.box.pose.pose()

    assert at_station(ROBOT, scenario.start.pose(), pushed_box(scenario.box, face), pushed_pose(pose, face))
    assert degrees(pushed_pose(pose, face).yaw_rad) == pytest.approx(0.0, abs=1e-9)


def measure(world: SteppingWorld, cell: Cell) -> list[Sample]:
    return cell_samples(world, ROBOT, NOMINAL, cell)


def test_samples_come_in_the_order_of_the_cells_however_many_worlds_there_are() -> None:
    planned = cells(("rear", "right"), ((0.5, 0.5),), (0.02, 0.05), (1, 2))
    done: list[Cell] = []
    one, three = (
        in_worlds([FakeWorld() for _ in range(n)], planned, measure, lambda cell, _: done.append(cell)) for n in (1, 3)
    )

    assert one == three
    samples = [sample for found in one for sample in found]
    assert [(s.face, s.depth_m) for s in samples] == [(c.face, c.depth_m) for c in planned for _ in SERIES]
    assert [s.leg for s in one[0]] == ["FL", "FR", "FL", "FL", "FR", "FR", "FL", "FR"]
    assert len(done) == 2 * len(planned)


def test_a_part_that_is_finished_is_not_measured_again() -> None:
    first, second = cells(("rear",), ((0.5, 0.5),), (0.02, 0.05), (1,))
    done: list[Cell] = []
    kept: dict[Cell, list[Sample]] = {first: []}

    found = in_worlds([FakeWorld()], [first, second], measure, lambda cell, _: done.append(cell), kept)
    assert (found[0], len(found[1]), done) == ([], len(SERIES), [second])


def test_a_fall_ends_a_calibration_and_a_stop_too() -> None:
    (cell,) = cells(("rear",), ((0.5, 0.5),), (0.05,), (1,))
    falling = FakeWorld(falls_in=lambda motion, n: isinstance(motion, Push) and n == 3)
    with pytest.raises(CalibrationError, match=r"fell as it pushed the rear face 0.05 m deep, FL"):
        measure(falling, cell)
    stop = threading.Event()
    stop.set()
    with pytest.raises(StopRequestedError):
        cell_samples(FakeWorld(), ROBOT, NOMINAL, cell, stop)
