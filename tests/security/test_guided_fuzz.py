"""A bounded run of the coverage-guided fuzzer: the same inputs each time; one that fails ends it with an exit code."""

import subprocess
import sys
from pathlib import Path

import pytest

RUNS = {"messages": 20_000, "scenarios": 1_500}


def fuzzed(
    *words: str, program: tuple[str, ...] = ("-m", "tests.security.guided_fuzz")
) -> "subprocess.CompletedProcess[str]":
    """Run the fuzzer as the child of a shell: the peak of its memory would else begin with that of this process."""
    command = ["sh", "-c", '"$@"; exit $?', "sh", sys.executable, *program, *words]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)


@pytest.mark.parametrize("target", RUNS)
def test_no_input_ends_a_reader(target: str, tmp_path: Path) -> None:
    done = fuzzed(target, "--runs", str(RUNS[target]), "--keep", str(tmp_path))
    assert done.returncode == 0, done.stderr[-3000:]
    assert f"Done {RUNS[target]} runs" in done.stderr
    assert len(list(tmp_path.iterdir())) > 10


BROKEN = """
from tests.security import guided_fuzz
honest = guided_fuzz.codec.decode
def decode(payload, kind):
    message = honest(payload, kind)
    raise KeyError("x")
guided_fuzz.codec.decode = decode
guided_fuzz.main(["messages", "--runs", "1000"])
"""


def test_another_error_than_that_of_messages_ends_it() -> None:
    done = fuzzed(program=("-c", BROKEN))
    assert done.returncode != 0
    assert "KeyError: 'x'" in done.stdout + done.stderr
