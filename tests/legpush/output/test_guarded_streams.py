"""Programs whose output is a closed pipe, a full disk, a closed stream, or in an encoding without the letters."""

import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from legpush.output.guarded_streams import with_guarded_output
from tests.command_names import leaf_names

WORK = """
import sys
from legpush.output.guarded_streams import with_guarded_output

def work(output):
    output.decides = {decides}
    for line in range({n_lines}):
        print("line", line, "20°", flush=line % 2 == 0)
    print("warning: 20°", file=sys.stderr)
    with open({done!r}, "w") as file:
        file.write("done")
    {end}

sys.exit(with_guarded_output(work))
"""
CLOSED_PIPE = "{ sleep 0.3; %s; echo $? >code; } | true"
FULL = "%s >/dev/full; echo $? >code"
CLOSED = "%s >&-; echo $? >code"
ALL_CLOSED = "%s <&- >&- 2>&-; echo $? >code"
NO_SPACE = "error: cannot write to standard output (No space left on device)\n"


def run_in_shell(line: str, command: list[str], folder: Path, **environment: str) -> tuple[int, str, str]:
    """Run a line of a shell with the command in it; return the command's exit code, and what was written."""
    quoted = shlex.join(command)
    done = subprocess.run(
        ["bash", "-c", line % quoted],
        cwd=folder,
        env={**os.environ, **environment},
        check=False,
        capture_output=True,
        text=True,
        errors="replace",
    )
    return int((folder / "code").read_text()), done.stdout, done.stderr


def program(folder: Path, end: str = "return 0", *, decides: bool = True, n_lines: int = 3000) -> list[str]:
    """A program that says that it is done by a file."""
    code = WORK.format(decides=decides, n_lines=n_lines, done=str(folder / "done"), end=end)
    (folder / "program.py").write_text(code, encoding="utf-8")
    return [sys.executable, str(folder / "program.py")]


@pytest.mark.parametrize("n_lines", [1, 3000])
@pytest.mark.parametrize(
    ("line", "code", "said"),
    [(CLOSED_PIPE, 141, ""), (FULL, 5, NO_SPACE), (CLOSED, 0, ""), (ALL_CLOSED, 0, "")],
    ids=["closed pipe", "full", "closed", "all closed"],
)
def test_the_work_is_done_and_then_the_output_is_told(
    line: str, code: int, said: str, n_lines: int, tmp_path: Path
) -> None:
    found = run_in_shell(line, program(tmp_path, n_lines=n_lines), tmp_path)
    warning = "" if line == ALL_CLOSED else "warning: 20°\n"
    assert found == (code, "", f"{warning}{said}")
    assert (tmp_path / "done").read_text() == "done"


@pytest.mark.parametrize("end", ["return 0", "sys.exit()", "sys.exit(0)"])
def test_an_exit_counts_like_a_return(end: str, tmp_path: Path) -> None:
    assert run_in_shell(FULL, program(tmp_path, end), tmp_path)[0] == 5


@pytest.mark.parametrize(
    ("end", "decides", "code"),
    [("return 1", True, 1), ("sys.exit(2)", True, 2), ("return 0", False, 0), ("return 1", False, 1)],
)
def test_an_error_of_the_work_and_the_end_of_a_mission_go_before(
    end: str, decides: bool, code: int, tmp_path: Path
) -> None:
    for line in (FULL, CLOSED_PIPE):
        found, _, said = run_in_shell(line, program(tmp_path, end, decides=decides), tmp_path)
        assert (found, said) == (code, "warning: 20°\n")


def test_a_descriptor_that_cannot_be_written_to_is_a_fault(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("before")
    code, _, said = run_in_shell("%s 1<file; echo $? >code", program(tmp_path), tmp_path)
    assert (code, said.splitlines()[-1]) == (3, "error: cannot write to standard output (Bad file descriptor)")
    assert (tmp_path / "file").read_text() == "before"


def test_letters_that_an_encoding_lacks_are_replaced(tmp_path: Path) -> None:
    command = program(tmp_path, n_lines=1)
    found = run_in_shell("%s; echo $? >code", command, tmp_path, PYTHONIOENCODING="ascii")
    assert found == (0, "line 0 20?\n", "warning: 20?\n")
    plain = {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": "C"}
    assert run_in_shell("%s; echo $? >code", command, tmp_path, **plain)[0] == 0


def test_a_file_that_is_opened_gets_no_number_of_a_closed_stream(tmp_path: Path) -> None:
    code = program(tmp_path, "print(open(__file__).fileno(), file=open('number', 'w')); return 0")
    run_in_shell(ALL_CLOSED, code, tmp_path)
    assert int((tmp_path / "number").read_text()) > 2


def test_an_output_that_does_not_block_is_waited_for(tmp_path: Path) -> None:
    read, write = os.pipe()
    os.set_blocking(write, False)
    with subprocess.Popen(program(tmp_path, n_lines=20000), stdout=write, stderr=subprocess.DEVNULL) as process:
        os.close(write)
        with open(read, encoding="utf-8") as lines:
            assert sum(1 for _ in lines) == 20000
    assert process.returncode == 0


def test_streams_of_a_notebook_or_a_test_are_left_alone(capsys: pytest.CaptureFixture[str]) -> None:
    before = sys.stdout, sys.stderr

    def work(_: object) -> int:
        assert (sys.stdout, sys.stderr) == before
        print("20°")
        return 7

    assert with_guarded_output(work) == 7
    assert (sys.stdout, sys.stderr) == before
    assert capsys.readouterr().out == "20°\n"


MAIN = "import sys; from legpush.cli import main; sys.exit(main())"


@pytest.mark.parametrize("command", leaf_names())
def test_every_command_says_that_the_disk_is_full(command: str, tmp_path: Path) -> None:
    argv = [sys.executable, "-c", MAIN, *command.split(), "--help"]
    assert run_in_shell(FULL, argv, tmp_path) == (5, "", NO_SPACE)


PROGRAMS = {
    "scenarios list": ["legpush", "scenarios", "list"],
    "scenarios show": ["legpush", "scenarios", "show", "default"],
    "bench faults": ["legpush", "bench", "faults"],
    "map": ["legpush", "map", "push"],
    "planner": ["-m", "planner_proc", "--help"],
    "simulator": ["-m", "sim_proc", "--help"],
    "agent": ["-m", "agent_proc", "--help"],
    "recorder": ["-m", "legpush.entry", "legpush.launch.record", "--help"],
    "film": ["-m", "sim_proc.render", "--help"],
    "numerics": ["-m", "legpush.numerics"],
}


@pytest.mark.parametrize("argv", PROGRAMS.values(), ids=PROGRAMS)
def test_every_program_ends_quietly_when_its_reader_is_gone(argv: list[str], tmp_path: Path) -> None:
    command = ["-c", MAIN, *argv[1:]] if argv[0] == "legpush" else argv
    found = run_in_shell(CLOSED_PIPE, [sys.executable, *command], tmp_path, PYTHONIOENCODING="ascii")
    assert found == (141, "", "")
