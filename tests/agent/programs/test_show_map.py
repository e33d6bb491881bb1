"""`legpush map`: what it writes, and which files it does not touch."""

from pathlib import Path
from typing import Any

import pytest

from agent_proc.programs.show_map import run
from legpush.errors import ConfigError, LegpushError
from legpush.options.maps import MapOptions
from tests.legpush.scenarios.map_examples import CELLS, grey_of, write_csv, write_png


def options(file: str | Path, **flags: Any) -> MapOptions:
    return MapOptions(file=str(file), **flags)


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory of its own."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_it_describes_the_map_and_draws_it(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_csv(here / "map.csv", CELLS)

    assert run(options("map.csv", cell_m=0.5, first_row="top")) == 0
    said = capsys.readouterr().out.splitlines()
    assert (said[0], said[-1]) == ("size        8 x 5 m", "wrote map_map.png")
    assert (here / "map_map.png").read_bytes().startswith(b"\x89PNG")


def test_only_a_picture_of_its_own_is_overwritten(here: Path) -> None:
    write_csv(here / "map.csv", CELLS)
    write_png(here / "plan.png", grey_of(CELLS))
    before = (here / "plan.png").read_bytes()
    for _ in range(2):
        assert run(options("map.csv", cell_m=0.5, first_row="top")) == 0
    with pytest.raises(ConfigError, match=r"plan\.png: expected a new file for --out, or a picture of `legpush map"):
        run(options("map.csv", cell_m=0.5, first_row="top", out=Path("plan.png")))
    assert (here / "plan.png").read_bytes() == before


def test_nothing_is_drawn_of_a_map_that_cannot_be_read(here: Path) -> None:
    (here / "map.yaml").write_text("image: map.pgm")
    with pytest.raises(LegpushError, match=r"map\.yaml: at `resolution`: expected a value, got nothing"):
        run(options("map.yaml"))
    (here / "folder.png").mkdir()
    with pytest.raises(ConfigError, match=r"Expected a file in an existing folder for --out, got .*folder\.png"):
        run(options("default", out=Path("folder.png")))
    assert sorted(path.name for path in here.iterdir()) == ["folder.png", "map.yaml"]
