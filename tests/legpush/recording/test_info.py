"""What people are told about a recording."""

from pathlib import Path

import pytest

from legpush.messages.common import PROTOCOL_VERSION
from legpush.messages.telemetry import Fact
from legpush.recording.info import lines
from legpush.recording.mcap_file.reader import read_recording
from tests.legpush.fakes import mission
from tests.legpush.recording.recordings import a_recording, beyond_the_bounds, traffic, write


def test_info_says_what_is_there(tmp_path: Path) -> None:
    path = a_recording(tmp_path / "a.mcap")
    text = "\n".join(lines(read_recording([path])))
    for words in (
        f"run test, protocol {PROTOCOL_VERSION}",
        "complete      yes",
        "sim/main/action",
        "24 messages",
        "steps 0 to 23",
    ):
        assert words in text


def test_a_recording_with_a_number_beyond_its_bounds_opens_and_says_which(tmp_path: Path) -> None:
    text = "\n".join(lines(read_recording([beyond_the_bounds(tmp_path / "a.mcap")])))
    assert "complete      yes" in text
    assert "24 messages" in text
    assert (
        "step 0: its action cannot be used: got no message: Expected `float` <= 1000.0 - at "
        "`$.motion.scenario.box.mass_kg`"
    ) in text


def test_a_bit_that_flips_beside_the_messages_is_told(tmp_path: Path) -> None:
    path = a_recording(tmp_path / "a.mcap")
    data, actions = bytearray(path.read_bytes()), traffic(mission())[0]
    data[data.index(actions[5].payload) - 3] ^= 1  # in the time of publishing
    path.write_bytes(data)
    text = "\n".join(lines(read_recording([path])))
    assert "damaged: the chunk at byte" in text


def test_a_report_that_is_damaged_is_no_reason_to_show_nothing(tmp_path: Path) -> None:
    actions, answers = traffic(mission())
    report = Fact(name="report.json", media_type="application/json", data=b"[\xff")
    paths = write(tmp_path / "a.mcap", actions, answers, facts=(report,))
    assert "result        cannot be read: report.json is damaged" in lines(read_recording(paths))


@pytest.mark.parametrize(("policy", "is_code"), [("scripted", False), ("my/folder", False), ("a:b", True)])
def test_info_shows_the_policy_and_whether_it_runs_code(tmp_path: Path, policy: str, is_code: bool) -> None:
    data = f'{{"seed":1,"policy":"{policy}","policy_sha256":"{"ab" * 32}"}}'.encode()
    fact = Fact(name="mission.json", media_type="application/json", data=data)
    shown = list(lines(read_recording(write(tmp_path / "a.mcap", *traffic(mission()), facts=(fact,)))))
    assert f"policy        {policy}, SHA-256 abababababababab..." in shown
    assert any("it runs code" in line for line in shown) == is_code
