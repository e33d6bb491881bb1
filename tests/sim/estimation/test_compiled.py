"""What functions are compiled for, and where the result is kept."""

import os
import stat
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from legpush.errors import LegpushError
from sim_proc.estimation import compiled


@pytest.fixture
def no_folder_yet() -> Any:
    compiled.cache_folder.cache_clear()
    yield
    compiled.cache_folder.cache_clear()


@pytest.mark.usefixtures("no_folder_yet")
def test_functions_are_compiled_for_any_processor_and_without_fused_operations(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(compiled, "_places", lambda: iter([tmp_path]))

    def sum_of_products(first: Any, second: Any) -> float:
        total = 0.0
        for k in range(len(first)):
            total += first[k] * second[k]
        return total

    function = compiled.compiled("f8(f8[::1], f8[::1])")(sum_of_products)
    assert function(np.array([1.0, 2.0]), np.array([3.0, 4.0])) == 11.0
    assert [path.suffix for path in sorted(tmp_path.rglob("*.nb*"))] == [".nbc", ".nbi"]
    _, processor, features = compiled.target.target_context.codegen().magic_tuple()
    assert (processor, features) == ("generic", "")
    assembly = "".join(function.inspect_asm().values())
    assert "mulsd" in assembly
    assert not any(word in assembly for word in ("vfmadd", "vmulsd", "zmm", "ymm"))


def test_another_processor_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    class Codegen:
        def magic_tuple(self) -> tuple[str, str, str]:
            return "x86_64", "generic", "+avx2"

    monkeypatch.setattr(type(compiled.target.target_context), "codegen", lambda _: Codegen())
    with pytest.raises(LegpushError, match="Expected Numba to compile for the processor `generic`"):
        compiled.compiled()


@pytest.mark.usefixtures("no_folder_yet")
def test_the_cache_goes_where_it_can_be_written(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    places = tmp_path / "no" / "folder", tmp_path / "caches"
    (tmp_path / "no").write_text("a file")
    monkeypatch.setattr(compiled, "_places", lambda: iter(places))
    folder = compiled.cache_folder()
    assert folder.parent == places[1]
    assert folder.is_dir()
    compiled.cache_folder.cache_clear()
    monkeypatch.setattr(compiled, "_places", lambda: iter(places[:1]))
    own = compiled.cache_folder()
    assert own.is_dir()
    assert stat.S_IMODE(own.stat().st_mode) == 0o700


@pytest.mark.usefixtures("no_folder_yet")
def test_a_named_place_comes_first_and_the_home_of_nobody_is_no_place(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(compiled.config, "CACHE_DIR", str(tmp_path))
    assert compiled.cache_folder().parent == tmp_path
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "mine"))
    assert list(compiled._places())[2] == tmp_path / "mine"
    monkeypatch.setenv("XDG_CACHE_HOME", "")
    monkeypatch.setattr(os.path, "expanduser", lambda path: path)
    assert len(list(compiled._places())) == 2


def test_missions_with_exact_sensors_load_no_compiler() -> None:
    code = """
import sys
from legpush.messages.stepping import Reset
from legpush.scenarios.file import load_scenario
from sim_proc.simulator import Simulator
Simulator().perform(Reset(scenario=load_scenario("push"), seed=0), with_trace=False)
print("numba" in sys.modules)
"""
    found = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert found.stdout == "False\n"
