"""Small programs in a folder of their own, and signals that reach them at a chosen place."""

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

MAIN = """
import sys
from legpush.entry.program import run_main
print("begins", flush=True)
sys.exit(run_main("work"))
"""


@dataclass(frozen=True)
class Ended:
    """How a program ended."""

    exit_code: int
    out: str
    err: str


def run(folder: Path, work: str, main: str = MAIN) -> Ended:
    """Run `main` with a module `work`, which can send signals to itself by `interrupt()`."""
    help_ = "import os, signal, sys, time\ninterrupt = lambda n=signal.SIGINT: os.kill(os.getpid(), n)\n"
    (folder / "work.py").write_text(help_ + work)
    environment = {**os.environ, "PYTHONPATH": f"{folder}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"}
    command = [sys.executable, "-c", main]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, timeout=60)
    return Ended(done.returncode, done.stdout.removeprefix("begins\n"), done.stderr)
