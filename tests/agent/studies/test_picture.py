from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image

from agent_proc.studies.picture import save_picture
from agent_proc.studies.table import Pairing, make_table
from legpush.errors import ConfigError

from .test_table import STUDY


@pytest.mark.parametrize("pairing", [None, Pairing(axis="policy", value="a")])
@pytest.mark.parametrize("by", [("box.mass_kg", "policy"), ("policy",)])
def test_a_picture_is_drawn(tmp_path: Path, by: tuple[str, ...], pairing: Pairing | None) -> None:
    lines = make_table(STUDY, by, ("error_m", "success"), pairing)
    save_picture(lines, by, "a title", tmp_path / "table.png")
    with Image.open(tmp_path / "table.png") as picture:
        assert picture.width > picture.height > 200
        assert len(picture.convert("RGB").getcolors(1_000_000) or []) > 10


def test_nothing_to_draw_and_too_many_measures_are_refused(tmp_path: Path) -> None:
    (line,) = make_table(STUDY, (), ("error_m",))
    for n in (0, 13):
        lines = [replace(line, measure=f"m{index}") for index in range(n)]
        with pytest.raises(ConfigError, match=f"Expected 1 to 12 columns to draw, got {n}: choose with --measure"):
            save_picture(lines, (), "a title", tmp_path / "table.png")
