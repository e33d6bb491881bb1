"""Mutated frames of every message type are decoded or refused by one kind of error, quickly and with little memory."""

import os
import random
import resource

import msgpack
import msgspec
import pytest

from legpush.errors import MessageError
from legpush.messages import codec
from legpush.messages.schemas import MESSAGES as KINDS
from legpush.messages.telemetry import Status
from tests.security.fuzz import EXAMPLES, FRAME_S, MUTATIONS, Mutate, fuzz, main

N_FRAMES = int(os.environ.get("LEGPUSH_TEST_FRAMES", "10000"))


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_mutated_frames_are_decoded_or_refused_by_one_kind_of_error(kind: type[msgspec.Struct]) -> None:
    outcomes = fuzz(kind, N_FRAMES)

    assert outcomes.n_frames == N_FRAMES
    assert outcomes.n_accepted > N_FRAMES // 1000
    assert outcomes.refused["malformed"] > N_FRAMES // 2
    assert outcomes.refused["not_finite"] > 0


@pytest.mark.parametrize("mutate", dict.fromkeys(MUTATIONS), ids=lambda mutate: mutate.__name__)
def test_every_mutation_changes_messages(mutate: Mutate) -> None:
    rng = random.Random(0)
    (payload,) = EXAMPLES[Status]
    changed = [mutate(rng, payload) for _ in range(50)]
    assert sum(one != payload for one in changed) > 25
    assert any(is_refused(one) for one in changed)


def is_refused(payload: bytes) -> bool:
    try:
        codec.decode(payload, Status)
    except MessageError:
        return True
    return False


def test_another_exception_than_that_of_messages_is_told_with_its_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(payload: bytes, kind: object) -> None:
        raise KeyError("x")

    monkeypatch.setattr(codec, "decode", fail)
    with pytest.raises(AssertionError, match=r"KeyError: 'x'; the frame is [0-9a-f]+"):
        fuzz(Status, 1)


def test_it_prints_a_line_for_each_type(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--frames", "20", "--kind", "Status"]) == 0
    assert capsys.readouterr().out.startswith("Status       20 frames: ")


@pytest.mark.parametrize(
    "element", [b"\x80", b"\x90", b"\x91\xc0", b"\x81\xa1a\xc0"], ids=["maps", "arrays", "full arrays", "full maps"]
)
def test_a_large_message_of_tiny_parts_needs_little_memory(element: bytes) -> None:
    n = (codec.MAX_MESSAGE_BYTES - 5) // len(element)
    payload = b"\xdd" + n.to_bytes(4, "big") + element * n
    before_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    with pytest.raises(MessageError, match="maps and arrays"):
        codec.decode(payload, Status)

    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kb < 600 * 1024


def test_a_message_of_many_parts_is_still_read() -> None:
    rows = [[float(n), {"n": n}] for n in range(200_000)]
    payload = msgpack.packb(rows)
    assert len(payload) > codec.MAX_PARTS
    assert codec.unpack(payload) == rows


def test_frames_have_a_limit_of_time() -> None:
    assert fuzz(Status, 10).longest_s < FRAME_S
