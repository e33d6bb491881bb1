"""The picture of a mission: there is one of every mission, and equal missions have equal ones."""

from dataclasses import replace
from pathlib import Path

import pytest

from agent_proc.reporting.picture import save_picture
from tests.agent.reporting.missions import blocked_mission, push_alone, unplanned_mission, whole_mission


@pytest.mark.parametrize("mission", [whole_mission, unplanned_mission, push_alone, blocked_mission])
def test_every_mission_can_be_drawn(mission: object, tmp_path: Path, recwarn: pytest.WarningsRecorder) -> None:
    record, result = mission()  # type: ignore[operator]

    save_picture(record, result, tmp_path / "mission.png")

    assert (tmp_path / "mission.png").read_bytes().startswith(b"\x89PNG")
    assert [str(warning.message) for warning in recwarn] == []


def test_a_picture_of_another_mission_is_another_picture(tmp_path: Path) -> None:
    record, result = whole_mission()
    save_picture(record, result, tmp_path / "a.png")
    save_picture(record, result, tmp_path / "b.png")
    save_picture(replace(record, seed=6), result, tmp_path / "c.png")

    a, b, c = ((tmp_path / f"{name}.png").read_bytes() for name in "abc")
    assert a == b
    assert a != c
