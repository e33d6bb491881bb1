"""`legpush branch`: a recorded mission goes on from one of its steps, as it did or with another box and policy."""

import hashlib
from pathlib import Path

from legpush.messages.stepping import Alter
from legpush.recording.episodes import read_episodes
from legpush.recording.mcap_file.reader import read_recording
from tests.system.conftest import RecordedMission
from tests.system.missions import crc_of, legpush


def test_a_branch_without_a_change_ends_as_its_parent_and_one_with_another_box_does_not(
    push_mission: RecordedMission, tmp_path: Path
) -> None:
    file = push_mission.file
    before = file.read_bytes()
    same, heavy = tmp_path / "same", tmp_path / "heavy"
    flags = ("branch", str(file), "--at", "0:12")
    done = legpush(*flags, "--out", str(same), "--record", str(tmp_path / "same.mcap"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert crc_of(same) == crc_of(push_mission.out)
    assert "nothing is changed at 0:12: this repeats the recording" in done.stdout
    changes = ("--set", "box.mass_kg=0.9", "--policy", "scripted")
    done = legpush(*flags, *changes, "--out", str(heavy), "--record", str(tmp_path / "heavy.mcap"))
    assert done.returncode in (0, 1), done.stdout + done.stderr
    assert crc_of(heavy) != crc_of(push_mission.out)
    assert "nothing is changed" not in done.stdout
    parent, branch = (read_episodes(read_recording([path]))[-1] for path in (file, tmp_path / "heavy.mcap"))
    for one, other in zip(parent.carried_out()[:12], branch.carried_out()[:12], strict=True):
        assert one.outcome is not None
        assert other.outcome is not None
        assert (one.motion, one.outcome.state_crc) == (other.motion, other.outcome.state_crc)
    assert branch.carried_out()[12].motion == Alter(box_mass_kg=0.9)
    about = read_recording([tmp_path / "heavy.mcap"]).about
    assert about["parent_sha256"] == hashlib.sha256(before).hexdigest()
    assert (about["parent_file"], about["parent_episode"], about["parent_step"]) == (file.name, "0", "12")
    done = legpush("replay", str(tmp_path / "heavy.mcap"), "--verify")
    assert done.returncode == 0, done.stdout + done.stderr
    assert file.read_bytes() == before
