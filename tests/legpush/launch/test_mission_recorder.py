"""The recorder of a mission."""

from pathlib import Path

from legpush.launch.mission_recorder import next_file


def test_what_goes_on_is_recorded_to_the_next_file_that_is_free(tmp_path: Path) -> None:
    file = tmp_path / "m.mcap"
    file.touch()
    assert next_file(file).name == "m-2.mcap"
    (tmp_path / "m-2.mcap").touch()
    assert next_file(file).name == "m-3.mcap"
    assert next_file(tmp_path / "m-2.mcap").name == "m-3.mcap"
    (tmp_path / "seed-7.mcap").touch()
    assert next_file(tmp_path / "seed-7.mcap").name == "seed-7-2.mcap"
