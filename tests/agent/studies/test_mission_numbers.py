import pytest

from agent_proc.reporting.mission_record import read_record
from agent_proc.studies.mission_numbers import NUMBERS, TRACKS, numbers, tracks
from legpush import in_process


def test_numbers_and_tracks_are_those_of_the_steps() -> None:
    run = in_process.run("push", seed=0, policy="scripted", changes={"mission.max_push_cycles": 6, "box.mass_kg": 0.3})
    record = read_record(run.records)
    found, lists = numbers(record), tracks(record)
    assert list(found) == [column.name for column in NUMBERS]
    assert list(lists) == [column.name for column in TRACKS]
    assert (found["box_mass_kg"], found["n_box_paths"], found["n_faces"], found["n_face_changes"]) == (0.3, 1, 1, 0)
    last = record.steps[-1].world
    assert lists["track_box_x_m"][-1] == pytest.approx(last.box.position_m[0], abs=5e-4)
    straight_m = lists["track_box_x_m"][-1] - lists["track_box_x_m"][0]
    assert straight_m - 0.01 < found["box_travel_m"] < straight_m + 0.1
    assert found["robot_travel_m"] > 0.0
    assert {len(values) for values in lists.values()} == {len(record.steps[::4]) + 1}
