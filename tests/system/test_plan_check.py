"""`legpush plan-check` on planners that are right, and on planners that are wrong in one way each."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

LEGPUSH = str(Path(sys.executable).with_name("legpush"))
FAULTY = str(Path(__file__).with_name("faulty_planner.py"))


def check(*arguments: str, command: tuple[str, ...]) -> "subprocess.CompletedProcess[str]":
    words = [LEGPUSH, "plan-check", *arguments, "--", *command]
    return subprocess.run(words, capture_output=True, text=True, check=False, timeout=240)


def test_the_built_in_planner_passes_all_checks(tmp_path: Path) -> None:
    done = check(
        "--deadline", "60", "--json", str(tmp_path / "report.json"), command=(sys.executable, "-m", "planner_proc")
    )

    assert done.returncode == 0, done.stdout + done.stderr
    assert "all checks passed" in done.stdout
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["passed"] is True
    assert len(report["findings"]) == done.stdout.count("pass  ") > 15


@pytest.mark.parametrize(
    ("fault", "only", "words"),
    [
        ("collides", "around a wall", "m from something occupied, 0.44 m were asked for"),
        ("lies", "around a wall", "its status is failed (could not be bothered), expected exact"),
        ("stops short", "open floor", "m from (7, 5)"),
        ("random", "equal queries", "two equal queries get different plans: `length_m` is"),
        ("hangs", "open floor", "no answer within 4 s"),
        ("twice", "answers once", "it answers a request twice that was sent once"),
        ("centimetres", "open floor", "it begins at (100, 100), 140 m from (1, 1); are these centimetres?"),
        ("invents fields", "open floor", "no valid answer within 4 s; what came: "),
        ("dies", "open floor", "out of ideas"),
    ],
)
def test_each_fault_is_named(fault: str, only: str, words: str) -> None:
    deadline_s = "60" if fault not in ("hangs", "invents fields") else "4"
    done = check("--deadline", deadline_s, "--only", only, command=(sys.executable, FAULTY, fault))

    assert done.returncode == 1, done.stdout + done.stderr
    assert f"FAIL  {'plans: ' if only in ('around a wall', 'open floor') else ''}{only}" in done.stdout
    assert words in done.stdout


def test_the_example_without_a_fault_passes_the_same_checks() -> None:
    only = ("around a wall", "open floor", "equal queries", "answers once", "paths of the box")
    done = check("--deadline", "60", "--only", *only, command=(sys.executable, FAULTY, "none"))

    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("pass  ") == len(only) + 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["plan-check"], "Expected the planner's command after `--`: legpush plan-check"),
        (["plan-check", "--"], "Expected the planner's command after `--`"),
        (["plan-check", "--", "no-such-planner"], "got 'no-such-planner', which is none"),
        (["plan-check", "--deadline", "0", "--", "true"], "more than 0 seconds for --deadline, got 0.0"),
        (["plan-check", "--only", "poetry", "--", "true"], "Expected a part of the name of a check for --only"),
    ],
)
def test_bad_input_is_one_error(arguments: list[str], words: str) -> None:
    done = subprocess.run([LEGPUSH, *arguments], capture_output=True, text=True, check=False, timeout=60)

    assert done.returncode == 2
    assert words in done.stderr
    assert "Traceback" not in done.stderr


def test_a_command_that_is_no_planner_is_said_to_have_ended() -> None:
    done = check(command=("true",))

    assert done.returncode == 1
    assert "FAIL  starts and shows its token: the process" in done.stdout
