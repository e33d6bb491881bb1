"""Every command of legpush with arguments that keep it busy, to be interrupted."""

import os
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from time import monotonic, sleep
from typing import Final

import psutil

from legpush.authority.carry_out import begin

LEGPUSH: Final = str(Path(sys.executable).with_name("legpush"))
RECORDING: Final = "RECORDING"
CUT: Final = "cut.mcap"
RUN: Final = "RUN"
STUDY: Final = "STUDY"
LAB: Final = "own-lab"
"""Words for a short recording, for one that is cut off, for the folder of its run, for that of a study, and for that of
an authority."""
VARIABLE: Final = str(Path(__file__).parents[2] / "agent_proc" / "policies" / "variable")
"""Folder of a policy."""
COMMANDS: Final[dict[str, tuple[str, ...]]] = {
    "run": ("run", "push", "--out", "run", "--no-video", "--record", "new.mcap"),
    "run with a film": ("run", "push", "--out", "run"),
    "train": ("train", "--simulators", "1", "--steps", "512", "--out", "policy"),
    "train with seeds": ("train", "--seeds", "1,2", "--world", "map", "--workers", "1", "--out", "policies"),
    "compare": ("compare", "scripted", "--world", "map", "--workers", "1", "--out", "compared"),
    "curves": ("curves", VARIABLE, "--out", "curves.png"),
    "tune": ("tune", "--trials", "2", "--steps", "256", "--workers", "1", "--out", "tuned"),
    "evaluate": ("evaluate", "scripted", "--episodes", "8", "--simulators", "1", "--out", "evaluated"),
    "calibrate": ("calibrate", "--simulators", "1", "--out", "map.json"),
    "plan-check": ("plan-check", "--out", "found.json", "--", sys.executable, "-m", "planner_proc"),
    "scenarios list": ("scenarios", "list"),
    "scenarios show": ("scenarios", "show", "published"),
    "scenarios copy": ("scenarios", "copy", "default", "room.toml"),
    "scenarios random": ("scenarios", "random", "room.toml", "--seed", "3"),
    "map show": ("map", "published", "--out", "map.png"),
    "policy show": ("policy", "show", "variable"),
    "policy export": ("policy", "export", "variable", "--to", "onnx", "--out", "exported"),
    "render": ("render", RUN),
    "picture": ("picture", RUN, "--out", "mission.svg"),
    "record": ("record", "new.mcap", "--connect", "unixsock-stream/nowhere.sock"),
    "info": ("info", RECORDING),
    "recover": ("recover", CUT, "--out", "whole.mcap"),
    "replay --verify": ("replay", RECORDING, "--verify"),
    "replay --as": ("replay", RECORDING, "--as", "planner", "--out", "replayed"),
    "branch": ("branch", RECORDING, "--at", "0:2", "--policy", "scripted", "--out", "branched"),
    "export a table": ("export", RECORDING, "--out", "table.csv"),
    "export a film": ("export", RECORDING, "--out", "film.mp4"),
    "view": ("view", RECORDING, "--port", "0"),
    "canary": ("canary",),
    "study run": ("study", "run", "study.toml", "--out", "study", "--workers", "1"),
    "study work": ("study", "work", "--workers", "1", "--connect", "unixsock-stream/nowhere.sock"),
    "study status": ("study", "status", STUDY),
    "study table": ("study", "table", STUDY, "--csv", "table.csv"),
    "study verify": ("study", "verify", STUDY, "--share", "1", "--workers", "1"),
    "study merge": ("study", "merge", STUDY, "--out", "merged"),
    "bench soak": ("bench", "soak", "--out", "soak", "--cells", "kill-sim-walking"),
    "bench faults": ("bench", "faults"),
    "examples list": ("examples", "list"),
    "examples copy": ("examples", "copy", "mine"),
    "secure init": ("secure", "init", "lab", "robot", "laptop"),
    "secure add": ("secure", "add", LAB, "desk"),
    "secure renew": ("secure", "renew", LAB),
    "secure revoke": ("secure", "revoke", LAB, "robot"),
    "router": ("router", "--listen", "unixsock-stream/router.sock"),
    "health": ("health", "router", "--router", "unixsock-stream/nowhere.sock", "--wait", "60"),
    "secure show": ("secure", "show", LAB),
    "doctor": ("doctor",),
    "completion": ("completion", "bash"),
    "help": ("--help",),
}
ENDLESS: Final = {"record": (0, 1), "view": (0,), "router": (0,), "study work": (0,)}
"""Commands that go on until they are interrupted, and their exit codes then."""
PYTORCH: Final = "torchinductor_"
"""How PyTorch calls its own directory of compiled code, which it keeps in the temporary directory."""
STUDY_FILE: Final = """
name = "interrupted"
cell = "push"

[settings]
policy = "scripted"

[axes]
seed = { first = 1, n = 8 }
"""


@dataclass(frozen=True)
class Interrupted:
    """How a command ended that was interrupted, or that ended before."""

    exit_code: int
    output: str
    was_running: bool
    left: tuple[str, ...]
    """Processes, temporary folders and unfinished files that it left behind."""


def handles_signals(process: "subprocess.Popen[bytes]") -> bool:
    """Whether the process, or what it became, catches SIGTERM: Python itself does not."""
    try:
        status = Path(f"/proc/{process.pid}/status").read_text()
    except OSError:
        return True
    caught = next((line.split()[1] for line in status.splitlines() if line.startswith("SigCgt:")), "0")
    return bool(int(caught, 16) >> (signal.SIGTERM - 1) & 1)


def interrupt(name: str, after_s: float, folder: Path, words: dict[str, str]) -> Interrupted:
    """Start a command in an empty folder, and interrupt it so long after it began to handle signals."""
    (folder / "tmp").mkdir()
    (folder / "study.toml").write_text(STUDY_FILE)
    if LAB in COMMANDS[name]:
        begin(folder / LAB, ["robot"], 1, 1)
    data = Path(words[RECORDING]).read_bytes()
    (folder / CUT).write_bytes(data[: len(data) // 2])
    command = [LEGPUSH, *(words.get(word, word) for word in COMMANDS[name])]
    environment = {**os.environ, "TMPDIR": str(folder / "tmp")}
    with (folder / "output").open("wb") as output:
        process = subprocess.Popen(
            command,
            cwd=folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
    until_s = monotonic() + 30.0
    while process.poll() is None and not handles_signals(process):
        assert monotonic() < until_s, f"{name} does not handle signals"
        sleep(0.001)
    try:
        process.wait(after_s)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGINT)
        was_running = True
    else:
        was_running = False
    exit_code = process.wait(60.0)
    return Interrupted(exit_code, (folder / "output").read_text(errors="replace"), was_running, left_in(folder))


def left_in(folder: Path) -> tuple[str, ...]:
    """What an interrupted command should not leave: processes in its folder, temporary and unfinished files."""
    files = [str(path.relative_to(folder)) for path in folder.rglob("*") if path.name.endswith((".part", ".old"))]
    files += [str(path.relative_to(folder)) for path in folder.glob(".*-*")]
    files += [f"tmp/{path.name}" for path in (folder / "tmp").iterdir() if not path.name.startswith(PYTORCH)]
    return (*files, *_processes_of(folder))


def _processes_of(folder: Path) -> list[str]:
    """The processes whose temporary directory is that of the folder; those that end within a while do not count."""
    until_s, mark = monotonic() + 10.0, str(folder / "tmp")
    while True:
        found = []
        for process in psutil.process_iter():
            try:
                if process.environ().get("TMPDIR") == mark and process.status() != psutil.STATUS_ZOMBIE:
                    found.append(" ".join(process.cmdline()))
            except psutil.Error:
                continue
        if not found or monotonic() > until_s:
            return found
        sleep(0.1)
