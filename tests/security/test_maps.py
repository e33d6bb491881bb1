"""Maps from elsewhere: their YAML makes no objects, and neither it nor a pipe keeps a reader busy."""

import os
from pathlib import Path
from time import monotonic

import numpy as np
import pytest
from PIL import Image

from agent_proc.reporting.map_picture import save_map_picture
from agent_proc.reporting.map_view import read_view
from legpush.errors import ScenarioError
from legpush.options.maps import MapOptions
from legpush.scenarios.file import load_scenario
from tests.legpush.scenarios.map_examples import write_scenario_of
from tests.security.evil import RAN, marks

GOOD = "image: map.png\nresolution: 1.0\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
LAUGHS = "a0: &a0 [x, x]\n" + "".join(f"a{n}: &a{n} [*a{n - 1}, *a{n - 1}]\n" for n in range(1, 40))
"""A short file that stands for 2^40 values."""
OBJECTS = (
    f'!!python/object/apply:pathlib.Path.touch ["{RAN}"]',
    f"!!python/object/apply:os.system ['touch {RAN}']",
    f"!!python/object/new:subprocess.check_call [['touch', '{RAN}']]",
    "!!python/name:os.system",
    "!!python/module:os",
)
ODD = ("!!int ''", "!!int _", "!!float ''", "!!bool maybe", "!!timestamp soon", "!!binary é", "9" * 5000, "!!set [1]")


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working directory of the test, with a good map in it."""
    monkeypatch.chdir(tmp_path)
    Image.fromarray(np.full((8, 14), 254, dtype=np.uint8)).save(tmp_path / "map.png")
    (tmp_path / "map.yaml").write_text(GOOD)
    return tmp_path


def load(home: Path) -> None:
    load_scenario(write_scenario_of(home, {"grid_file": "map.yaml"}))


def test_the_map_is_good_before_something_bad_is_put_into_it(home: Path) -> None:
    load(home)


@pytest.mark.parametrize("value", [*OBJECTS, *ODD])
@pytest.mark.parametrize("field", ["image", "resolution", "more"])
def test_yaml_makes_no_objects_and_odd_values_have_one_kind_of_error(home: Path, field: str, value: str) -> None:
    lines = [line for line in GOOD.splitlines() if not line.startswith(field)]
    (home / "map.yaml").write_text("\n".join([*lines, f"{field}: {value}"]), encoding="utf-8")

    with pytest.raises(ScenarioError, match=r"map\.yaml"):
        load(home)
    assert marks(home) == set()


@pytest.mark.parametrize("text", [LAUGHS + GOOD, "a: &a [*a]\n" + GOOD, "[" * 10**5])
def test_a_short_file_that_stands_for_much_is_refused_at_once(home: Path, text: str) -> None:
    (home / "map.yaml").write_text(text)
    began = monotonic()

    with pytest.raises(ScenarioError, match=r"map\.yaml: expected YAML"):
        load(home)
    assert monotonic() - began < 10.0


@pytest.mark.parametrize("name", ["map.png", "map.yaml"])
def test_a_pipe_is_refused_instead_of_waited_for(home: Path, name: str) -> None:
    (home / name).unlink()
    os.mkfifo(home / name)

    with pytest.raises(ScenarioError, match=f"expected a file, got '{name}', which is something else"):
        load(home)


def test_the_name_of_a_map_is_no_formula_in_its_picture(home: Path) -> None:
    (home / r"$\frac{1}{$ $\input{x}$.yaml").write_text(GOOD)
    view = read_view(MapOptions(file=str(home / r"$\frac{1}{$ $\input{x}$.yaml")))
    save_map_picture(view, home / "picture.png")
    assert (home / "picture.png").stat().st_size > 1000
