"""A single flipped bit anywhere in a recording is found and named, by `replay --verify` and by `info`."""

import os
import random
import struct
from collections import defaultdict
from pathlib import Path

import pytest
from mcap.opcode import Opcode
from msgspec.structs import replace

from legpush.bus import keys
from legpush.errors import RecordingError
from legpush.messages import codec
from legpush.messages.planning import PlanRequest, PlanResult
from legpush.messages.telemetry import Reward, RewardTerm, Status
from legpush.recording.damage import damage_of
from legpush.recording.info import lines
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.mcap_file.writer import Attachment, RecordingFile
from legpush.recording.verify import check
from tests.legpush.examples import PLAN, QUERY
from tests.legpush.fakes import RUN, FakeStepper, mission
from tests.legpush.recording.recordings import ABOUT, AGENT, EPISODE, SIM, copy, header, traffic

PLANNER = replace(AGENT, role="planner", incarnation="planner-1")
N_FLIPS = int(os.environ.get("LEGPUSH_TEST_FLIPS", "200"))
HEAD = struct.Struct("<BQ")
MESSAGE_FIELDS = 2 + 4 + 8 + 8


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The bytes of a recording with every kind of message and file."""
    path = tmp_path_factory.mktemp("whole") / "a.mcap"
    file = RecordingFile(path, ABOUT)
    for name in ("scenario.toml", "model.xml", "report.json"):
        file.attach(Attachment(f"agent/main/{name}", "text/plain", b'{"reason": "reached", "detail": "1 m"}'))
    actions, answers = traffic(mission(6))
    n_messages = 0
    for number in range(0, len(actions), 5):
        request = PlanRequest(header=header(AGENT, number), request_id=number, query=QUERY)
        result = PlanResult(
            header=header(PLANNER, number),
            client_incarnation=AGENT.incarnation,
            request_id=number,
            revision=0,
            final=True,
            plan=PLAN,
        )
        reward = Reward(
            header=header(AGENT, number),
            sim="main",
            episode=EPISODE,
            step=number,
            value=0.5,
            terms=(RewardTerm(name="goal", value=0.5),),
        )
        status = Status(header=header(AGENT, number), phase="walking", fraction=0.5, detail="1 of 2 m")
        of_agent = (
            copy(keys.plan_request(RUN, "main"), number, codec.encode(request)),
            copy(f"legpush/1/{RUN}/sim/main/reward", number, codec.encode(reward)),
            copy(f"legpush/1/{RUN}/agent/main/status", number, codec.encode(status)),
            *actions[number : number + 5],
        )
        of_planner = (copy(keys.plan_result(RUN, "main"), number, codec.encode(result)),)
        of_sim = tuple(answers[number : number + 5])
        for origin, copies in ((AGENT, of_agent), (PLANNER, of_planner), (SIM, of_sim)):
            file.write(origin, copies)
            n_messages += len(copies)
        file.flush()
    file.finish({"complete": "yes", "n_recorded": str(n_messages), "n_missing": "0", "notes": ""})
    return path.read_bytes()


def kinds(data: bytes) -> dict[str, list[range]]:
    """The parts of the file by kind: magic, and head and content of each kind of record, in chunks and outside."""
    found: dict[str, list[range]] = defaultdict(list)
    found["magic"] += [range(8), range(len(data) - 8, len(data))]
    topics: dict[int, str] = {}

    def take(begin: int, end: int, where: str) -> None:
        at = begin
        while at < end:
            opcode, length = HEAD.unpack_from(data, at)
            content, behind = at + HEAD.size, at + HEAD.size + length
            name = f"{where}{Opcode(opcode).name.lower()}"
            if opcode == Opcode.CHANNEL:
                channel, n_topic = struct.unpack_from("<HxxI", data, content)
                topics[channel] = data[content + 8 : content + 8 + n_topic].decode()
            if opcode == Opcode.MESSAGE:
                name = f"{where}{topics[struct.unpack_from('<H', data, content)[0]]}"
                found[f"{name} fields"].append(range(content, content + MESSAGE_FIELDS))
                content += MESSAGE_FIELDS
            if opcode == Opcode.CHUNK:
                found[f"{name} fields"].append(range(content, content + 40))
                take(content + 40, behind, "in a chunk: ")
                content = behind
            found[f"{name} head"].append(range(at, at + HEAD.size))
            if content < behind:
                found[f"{name} content"].append(range(content, behind))
            at = behind

    take(8, len(data) - 8, "")
    return found


def told(path: Path) -> str:
    """What a user is told who verifies a recording; empty if it is said to be sound."""
    try:
        recording = read_recording([path])
        checked = check(recording, FakeStepper().perform, lambda: "here")
    except RecordingError as error:
        return str(error)
    if checked.is_sound:
        return ""
    assert checked.verified is None or checked.verified.divergence or "damaged: " in checked.words(1.0)
    assert checked.verified is None or not checked.damage or any("damaged: " in line for line in lines(recording))
    return checked.words(1.0)


def test_a_recording_as_it_was_written_is_sound(whole: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(whole)
    assert told(path) == ""
    assert damage_of(read_recording([path])) == []
    assert len(kinds(whole)) >= 48


def test_a_flipped_bit_in_any_kind_of_record_is_told_with_its_place(whole: bytes, tmp_path: Path) -> None:
    rng = random.Random(7)
    path = tmp_path / "a.mcap"
    by_kind = sorted(kinds(whole).items())
    n_found = 0
    for number in range(N_FLIPS):
        kind, places = by_kind[number % len(by_kind)]
        at, bit = rng.choice(rng.choice(places)), rng.randrange(8)
        data = bytearray(whole)
        data[at] ^= 1 << bit
        path.write_bytes(data)
        words = told(path)
        assert words, f"bit {bit} of byte {at}, {kind}: not told"
        assert "a.mcap" in words or "step" in words or "sequence" in words or "the file agent/" in words, words
        n_found += 1
    assert n_found == N_FLIPS


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("in a chunk: plan/main/result content", "damaged: 1 message of plan/main/result (planner main, sequence 0)"),
        ("in a chunk: plan/main/request content", "damaged: 1 message of plan/main/request (agent main, sequence 0)"),
        ("in a chunk: sim/main/reward content", "message of sim/main/reward (agent main, sequence 0, step 0)"),
        ("in a chunk: agent/main/status content", "1 message of agent/main/status (agent main, sequence 0)"),
        ("in a chunk: sim/main/action content", "field action: expected bytes"),
        ("metadata content", "damaged: the header, the metadata, or the CRC of the data of a.mcap"),
        ("message_index content", "damaged: the index of the chunk at byte"),
        ("statistics content", "damaged: the summary of a.mcap"),
        ("chunk_index content", "damaged: the summary of a.mcap"),
        ("attachment content", "damaged: the file agent/main/scenario.toml"),
    ],
)
def test_what_is_damaged_is_named(whole: bytes, tmp_path: Path, kind: str, words: str) -> None:
    path = tmp_path / "a.mcap"
    part = kinds(whole)[kind][0 if kind != "metadata content" else -1]
    data = bytearray(whole)
    data[part[len(part) // 2]] ^= 1
    path.write_bytes(data)
    assert words in told(path)


def test_a_recording_cut_off_anywhere_is_refused_in_one_line(whole: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    for percent in range(0, 100, 5):
        path.write_bytes(whole[: len(whole) * percent // 100])
        with pytest.raises(RecordingError, match=r"a\.mcap: expected a .*recording") as caught:
            read_recording([path])
        assert "\n" not in str(caught.value)
