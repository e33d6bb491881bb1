"""What a message was when it was recorded: its checksum, and the step that it belongs to."""

import pytest

from legpush.messages import codec
from legpush.recording.digests import Mark, mark_of
from tests.legpush.examples import MESSAGES


def test_a_message_of_a_step_is_marked_with_its_place() -> None:
    payload = codec.encode(MESSAGES["action_walk"])
    assert mark_of(payload) == Mark(codec.checksum(payload), (1700000000000, 2))


@pytest.mark.parametrize("payload", [codec.encode(MESSAGES["status"]), b"\xc1", b"", b"\x81\xa7episode\xa1x"])
def test_anything_else_is_marked_without_one(payload: bytes) -> None:
    assert mark_of(payload) == Mark(codec.checksum(payload), None)
