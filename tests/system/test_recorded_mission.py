"""A recorded mission: everything is in its file, it can be verified and played, and it goes on without its recorder."""

import json
import resource
import subprocess
import threading
from pathlib import Path

import psutil

from legpush.recording.mcap_file.contents import Recorded
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.recover import recover
from tests.system.conftest import RecordedMission
from tests.system.missions import LEGPUSH, crc_of, legpush, report_of


def test_a_mission_is_recorded_completely_with_what_it_was_made_of(push_mission: RecordedMission) -> None:
    recording = read_recording([push_mission.file])
    assert recording.is_complete, recording.completeness
    assert {message.origin.role for message in recording.messages} == {"planner", "sim", "agent"}
    assert min(message.copy.sequence for message in recording.messages) == 0
    for name in ("scenario.toml", "model.xml", "versions.json", "mission.json", "report.json"):
        assert recording.attachment(name) is not None, name
    report = report_of(push_mission.out)
    assert report["recording"] == {"file": str(push_mission.file), "complete": True, "notes": []}
    text = legpush("info", str(push_mission.file)).stdout
    assert "complete      yes" in text
    assert f"state {report['state_crc']}" in text
    assert "result        success" in text


def test_a_mission_is_verified_and_a_flipped_bit_found(push_mission: RecordedMission, tmp_path: Path) -> None:
    done = legpush("replay", str(push_mission.file), "--verify")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "identical: " in done.stdout
    data = bytearray(push_mission.file.read_bytes())
    data[data.index(b"depth_m", len(data) // 2) + 12] ^= 1
    (tmp_path / "flipped.mcap").write_bytes(data)
    done = legpush("replay", str(tmp_path / "flipped.mcap"), "--verify")
    assert done.returncode == 1
    assert "first divergence at episode 0, step " in done.stdout
    assert "field action" in done.stdout


def test_a_mission_goes_on_without_its_recorder_and_says_so(tmp_path: Path) -> None:
    """The limit of a file's size stands for a disk that is full."""
    out, file = tmp_path / "run", tmp_path / "mission.mcap"
    command = [*LEGPUSH, "run", "push", "--no-video", "--out", str(out), "--record", str(file)]
    launcher = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    limit, pause = 1_500_000, threading.Event()
    try:
        while not (victims := [p for p in psutil.Process(launcher.pid).children(True) if _records(p)]):
            pause.wait(0.01)
        resource.prlimit(victims[0].pid, resource.RLIMIT_FSIZE, (limit, limit))
        text, _ = launcher.communicate(timeout=120.0)
    finally:
        launcher.kill()
        launcher.wait()
    assert launcher.returncode == 0, text
    assert "the recorder exited with 2" in text
    assert "the recording cannot go on (File too large)" in text
    assert text.index("the recorder exited") < text.index("stopping")
    report = json.loads((out / "report.json").read_text())
    assert report["success"]
    assert not report["recording"]["complete"]
    recover(file, tmp_path / "recovered.mcap")
    assert len(read_recording([tmp_path / "recovered.mcap"]).messages) > 5


def _records(process: psutil.Process) -> bool:
    try:
        return "legpush.launch.record" in process.cmdline()
    except psutil.NoSuchProcess:
        return False


def test_the_recording_plays_the_simulator_and_the_mission_ends_as_it_did(
    push_mission: RecordedMission, tmp_path: Path
) -> None:
    done = legpush("replay", str(push_mission.file), "--as", "sim", "--out", str(tmp_path / "run"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert crc_of(tmp_path / "run") == crc_of(push_mission.out)


def test_what_is_published_again_is_recorded_again_byte_for_byte(push_mission: RecordedMission, tmp_path: Path) -> None:
    at = f"unixsock-stream/{tmp_path}/replay.sock"
    player = subprocess.Popen([*LEGPUSH, "replay", str(push_mission.file), "--rate", "10", "--listen", at])
    try:
        flags = ("--run", "replay", "--connect", at, "--duration", "4")
        done = legpush("record", str(tmp_path / "again.mcap"), *flags)
        assert player.wait(timeout=30.0) == 0
    finally:
        player.kill()
        player.wait()
    assert done.returncode == 0, done.stdout + done.stderr
    first, again = (read_recording([path]).messages for path in (push_mission.file, tmp_path / "again.mcap"))
    assert len(first) == len(again)
    assert contents_of(first) == contents_of(again)


def contents_of(messages: list[Recorded]) -> list[tuple[str, int, bytes]]:
    return sorted((message.topic, message.copy.sequence, message.copy.payload) for message in messages)
