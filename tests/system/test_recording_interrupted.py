"""A recorded mission that is interrupted goes on, and so does its recording, in a file that says what it is."""

import json
import shlex
import signal
import subprocess
import sys
import threading
from pathlib import Path

from legpush.recording.mcap_file.reader import read_recording

CLI = [sys.executable, "-P", "-c", "import sys; from legpush.cli import main; sys.exit(main())"]


def test_the_printed_command_goes_on_with_mission_and_recording(tmp_path: Path) -> None:
    file, out, pause = tmp_path / "m.mcap", tmp_path / "run", threading.Event()
    command = ["run", "push", "--no-video", "--record", str(file), "--out", str(out)]
    launcher = subprocess.Popen([*CLI, *command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        while launcher.poll() is None and not (file.exists() and file.stat().st_size > 300_000):
            pause.wait(0.02)
        launcher.send_signal(signal.SIGINT)
        text, _ = launcher.communicate(timeout=60.0)
    finally:
        launcher.kill()
        launcher.wait()
    assert launcher.returncode == 130, text
    assert f"{file} stays as it is, the rest gets a file of its own" in text
    again = shlex.split(text.partition("to go on: ")[2])
    assert again[0] == "legpush"
    second = tmp_path / "m-2.mcap"
    assert again[again.index("--record") + 1] == str(second)
    before = file.read_bytes()
    done = subprocess.run([*CLI, *again[1:]], capture_output=True, text=True, check=False, timeout=120.0)
    assert done.returncode == 0, done.stdout + done.stderr
    assert file.read_bytes() == before
    report = json.loads((out / "report.json").read_text())
    assert report["recording"] == {"file": str(second), "complete": True, "notes": []}
    info = legpush("info", str(second))
    assert "began         after an interruption" in info.stdout
    assert f"state {report['state_crc']}" in info.stdout
    assert "after an interruption" not in legpush("info", str(file)).stdout
    for recording in (file, second):
        verified = legpush("replay", str(recording), "--verify")
        assert verified.returncode == 0, verified.stdout + verified.stderr
        assert "identical: " in verified.stdout
    assert read_recording([second]).about["continued"] == "yes"
    refused = legpush("branch", str(second), "--at", "0:1", "--out", str(tmp_path / "branch"))
    assert refused.returncode == 2
    assert "got one that goes on after an interruption" in refused.stderr


def legpush(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*CLI, *arguments], capture_output=True, text=True, check=False, timeout=120.0)
