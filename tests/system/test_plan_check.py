"""`legpush plan-check` on planners that are right, and on planners that are wrong in one way each."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

LEGPUSH = str(Path(sys.executable).with_name("legpush"))
FAULTY = str(Path(__file__).with_name("faulty_planner.py"))
IMPATIENT = (
    "hangs",
    "invents fields",
    "ignores a cancel",
    "takes a restarted client for the old one",
    "never is done",
)
"""Faults that take as long as the deadline."""


def check(*arguments: str, command: tuple[str, ...]) -> "subprocess.CompletedProcess[str]":
    words = [LEGPUSH, "plan-check", *arguments, "--", *command]
    return subprocess.run(words, capture_output=True, text=True, check=False, timeout=240)


def test_the_built_in_planner_passes_all_checks(tmp_path: Path) -> None:
    done = check(
        "--deadline", "60", "--out", str(tmp_path / "report.json"), command=(sys.executable, "-m", "planner_proc")
    )

    assert done.returncode == 0, done.stdout + done.stderr
    assert "all checks passed" in done.stdout
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["passed"] is True
    assert len(report["findings"]) == done.stdout.count("pass  ") > 15


@pytest.mark.parametrize(
    ("fault", "only", "words"),
    [
        ("collides", "plans: around a wall", "m from something occupied, 0.44 m were asked for"),
        ("lies", "plans: around a wall", "its status is failed (could not be bothered), expected exact"),
        ("stops short", "plans: open floor", "m from (7, 5)"),
        ("centimetres", "plans: open floor", "it begins at (100, 100), 140 m from (1, 1); are these centimetres?"),
        ("degrees", "plans: open floor", "a heading of 28.6479 rad, expected 0.5; are these degrees?"),
        ("ignores the seed", "equal queries", "two equal queries get different plans: `"),
        ("draws a seed when it starts", "equal queries", "after a restart an equal query gets another plan: `"),
        ("hangs", "plans: open floor", "no answer within 2 s"),
        ("dies", "plans: open floor", "out of ideas"),
        ("answers twice", "answers once", "it answers a request twice that was sent once"),
        ("invents fields", "plans: open floor", "no valid answer within 2 s; what came: "),
        ("ignores a cancel", "is cancelled", "no last answer within 2 s to a request that was cancelled"),
        ("takes a restarted client for the old one", "restarted", "a client that was restarted: no answer within 2 s"),
        ("skips a revision", "better plans", "its revisions are [0, 2, 3], expected 0 to 3 in order"),
        ("never is done", "better plans", "after revision 2, which is not final: no answer within 2 s"),
        ("gets worse", "better plans", "revision 1 is longer than the one before it"),
        ("drives backward", "(Dubins)", "it does not move forward along its heading"),
        ("turns too tightly", "(Dubins)", "it turns on a radius of 0.3"),
    ],
)
def test_each_fault_is_named(fault: str, only: str, words: str) -> None:
    deadline_s = "2" if fault in IMPATIENT else "60"
    done = check("--deadline", deadline_s, "--only", only, command=(sys.executable, FAULTY, fault))

    assert done.returncode == 1, done.stdout + done.stderr
    (failed,) = (line for line in done.stdout.splitlines() if line.startswith("FAIL"))
    assert only in failed
    assert words in failed


def test_a_slow_answer_fails_its_own_check_alone() -> None:
    only = ("plans: around a wall", "plans: open floor", "answers once")
    done = check("--deadline", "3", "--only", *only, command=(sys.executable, FAULTY, "hangs on an open floor"))

    marks = [line.split()[0] for line in done.stdout.splitlines() if line.startswith(("pass", "FAIL"))]
    assert (marks, done.returncode) == (["pass", "FAIL", "pass", "pass"], 1), done.stdout + done.stderr


def test_the_example_without_a_fault_passes_the_same_checks() -> None:
    only = (
        "around a wall",
        "open floor",
        "equal queries",
        "answers once",
        "better plans",
        "(Dubins)",
        "paths of the box",
    )
    done = check("--deadline", "60", "--only", *only, command=(sys.executable, FAULTY, "none"))

    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("pass  ") == len(only) + 3


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["plan-check"], "Expected the planner's command after `--`: legpush plan-check"),
        (["plan-check", "--"], "Expected the planner's command after `--`"),
        (["plan-check", "--", "no-such-planner"], "got 'no-such-planner', which is not one"),
        (["plan-check", "--deadline", "0", "--", "true"], "0.001 to 1e+06 seconds for --deadline, got 0.0"),
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
