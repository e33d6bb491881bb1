"""The finished parts of long work are kept, whatever ends the program."""

import subprocess
import sys
import threading
from math import inf
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from legpush.errors import ConfigError
from legpush.long_work.finished import open_finished

WORK = {"policy": "scripted", "n": 3}
KILLED = """
import os, signal, sys
from pathlib import Path
from legpush.long_work.finished import open_finished
with open_finished(Path(sys.argv[1]), {"policy": "scripted", "n": 3}) as kept:
    kept.keep("a", [1, 0.1])
    kept.keep("b", {"margin_m": float("inf")})
    os.kill(os.getpid(), signal.SIGKILL)
"""


def parts(path: Path, work: dict[str, Any] = WORK) -> dict[str, Any]:
    with open_finished(path, work) as kept:
        return dict(kept.parts)


def test_parts_outlive_a_killed_program(tmp_path: Path) -> None:
    path = tmp_path / "finished.jsonl"
    assert subprocess.run([sys.executable, "-c", KILLED, str(path)], check=False).returncode < 0
    assert parts(path) == {"a": [1, 0.1], "b": {"margin_m": inf}}


def test_a_file_without_parts_does_not_stay(tmp_path: Path) -> None:
    assert parts(tmp_path / "finished.jsonl") == {}
    assert list(tmp_path.iterdir()) == []


def test_threads_keep_parts_at_the_same_time(tmp_path: Path) -> None:
    path = tmp_path / "finished.jsonl"
    with open_finished(path, WORK) as kept:
        threads = [threading.Thread(target=kept.keep, args=(str(n), list(range(n)))) for n in range(40)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert parts(path) == {str(n): list(range(n)) for n in range(40)}


@given(cut=st.integers(0, 200))
def test_a_file_that_is_cut_off_anywhere_goes_on_with_its_whole_parts(
    cut: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.mktemp("cut") / "finished.jsonl"
    values = {str(n): {"x_m": 0.1 * n} for n in range(4)}
    with open_finished(path, WORK) as kept:
        for name, value in values.items():
            kept.keep(name, value)
    data = path.read_bytes()
    path.write_bytes(data[:cut])
    n_whole = max(0, data[:cut].count(b"\n") - 1)
    with open_finished(path, WORK) as kept:
        assert kept.parts == dict(list(values.items())[:n_whole])
        for name in values.keys() - kept.parts.keys():
            kept.keep(name, values[name])
    assert parts(path) == values


@pytest.mark.parametrize(
    ("work", "name"), [({**WORK, "n": 4}, "n"), ({"policy": "scripted"}, "n"), ({**WORK, "seed": 1}, "seed")]
)
def test_parts_of_other_work_are_refused_and_kept(work: dict[str, Any], name: str, tmp_path: Path) -> None:
    path = tmp_path / "finished.jsonl"
    with open_finished(path, WORK) as kept:
        kept.keep("a", 1)
    with pytest.raises(ConfigError, match=f"parts of the same work, got some with another {name}; remove the file"):
        parts(path, work)
    assert parts(path) == {"a": 1}


@pytest.mark.parametrize("text", ["hello\n", "[1]\n", "{}\n[1]\n", '{}\n["a", 1]\n"b"\n', "\xff\n"])
def test_a_file_of_another_kind_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "finished.jsonl"
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(ConfigError, match=r"finished\.jsonl: expected finished parts of earlier work, got other lines"):
        parts(path, {})
    assert path.read_bytes() == text.encode("latin-1")
