"""The picture of a mission: there is one of every mission, and equal missions have equal ones."""

from dataclasses import replace as changed
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from msgspec.structs import replace

from agent_proc.reporting.mission_picture import picture
from agent_proc.reporting.mission_picture.picture import save_picture
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
    save_picture(changed(record, seed=6), result, tmp_path / "c.png")

    a, b, c = ((tmp_path / f"{name}.png").read_bytes() for name in "abc")
    assert a == b
    assert a != c


@pytest.mark.parametrize(
    ("mission", "titles"),
    [
        (whole_mission, ["The whole room", "Pushes at the rear face", "Trunk pitch and roll"]),
        (unplanned_mission, ["The whole room"]),
    ],
)
def test_nothing_is_drawn_of_what_did_not_happen(mission: object, titles: list[str], tmp_path: Path) -> None:
    record, result = mission()  # type: ignore[operator]
    save_picture(record, result, tmp_path / "mission.svg")
    drawn = (tmp_path / "mission.svg").read_text()

    assert all(title in drawn for title in titles)
    assert ("Box error" in drawn) == (mission is whole_mission)
    assert ("foot FL" in drawn) == (mission is whole_mission)
    assert "Largest torque" not in drawn


@pytest.mark.parametrize("n_words", [5, 60])
def test_headline_and_legend_are_within_the_picture(
    n_words: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for mission in (blocked_mission, unplanned_mission):
        record, result = mission()
        long = changed(result, detail=" ".join(["obstacle"] * n_words))
        figures: list[Figure] = []
        monkeypatch.setattr(picture, "save_figure", lambda figure, *_, figures=figures, **__: figures.append(figure))
        save_picture(record, long, tmp_path / "mission.png")
        (figure,) = figures
        figure.draw_without_rendering()
        page = figure.bbox
        for artist in (*figure.texts, *figure.legends, *(axes.title for axes in figure.axes)):
            box = artist.get_window_extent()
            assert page.x0 <= box.x0
            assert box.x1 <= page.x1
            assert page.y0 <= box.y0
            assert box.y1 <= page.y1


def test_a_small_part_of_a_large_room_is_drawn_once_more(tmp_path: Path) -> None:
    record, result = push_alone()
    room = replace(record.scenario.room, size_m=(40.0, 30.0))
    save_picture(changed(record, scenario=replace(record.scenario, room=room)), result, tmp_path / "mission.svg")
    assert "The part that the mission used" in (tmp_path / "mission.svg").read_text()
