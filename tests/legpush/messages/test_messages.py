"""The messages as they are on the wire, held against the golden files."""

from pathlib import Path

import msgpack
import msgspec
import pytest

from legpush.bus.channels import Message
from legpush.fields import Name
from legpush.messages import codec
from legpush.messages.common import PROTOCOL_VERSION
from legpush.messages.schemas import MESSAGES as MESSAGE_KINDS
from legpush.messages.stepping import Action
from tests.legpush.examples import MESSAGES

GOLDEN = Path(__file__).parents[2] / "golden"


@pytest.mark.parametrize("name", MESSAGES)
def test_a_message_has_the_golden_bytes(name: str) -> None:
    assert codec.encode(MESSAGES[name]) == (GOLDEN / f"{name}.msgpack").read_bytes()


@pytest.mark.parametrize("name", MESSAGES)
def test_golden_bytes_and_golden_json_are_the_same_message(name: str) -> None:
    kind = type(MESSAGES[name])
    from_bytes = codec.decode((GOLDEN / f"{name}.msgpack").read_bytes(), kind)
    assert from_bytes == msgspec.json.decode((GOLDEN / f"{name}.json").read_bytes(), type=kind)
    assert from_bytes == MESSAGES[name]


def test_every_message_and_every_motion_has_a_golden_file() -> None:
    kinds: set[type[Message]] = {type(message) for message in MESSAGES.values()}
    assert kinds == set(MESSAGE_KINDS)
    motions = {type(message.motion).__name__ for message in MESSAGES.values() if isinstance(message, Action)}
    assert motions == {"Reset", "Follow", "Walk", "Push", "Alter"}
    assert {path.stem for path in GOLDEN.glob("*.msgpack")} == set(MESSAGES)
    assert {path.stem for path in GOLDEN.glob("*.json")} == set(MESSAGES)


@pytest.mark.parametrize("name", MESSAGES)
def test_a_message_is_maps_arrays_and_plain_values_with_a_header(name: str) -> None:
    plain = msgpack.unpackb((GOLDEN / f"{name}.msgpack").read_bytes())
    assert plain["header"]["protocol"] == PROTOCOL_VERSION
    waiting, n_seen = [plain], 0
    while waiting:
        value = waiting.pop()
        n_seen += 1
        assert type(value) in (dict, list, str, bytes, int, float, bool, type(None))
        waiting += list(value.values()) if isinstance(value, dict) else value if isinstance(value, list) else []
    assert n_seen > 8


@pytest.mark.parametrize("text", ["", "a/b", "a b", "*", "a\n", "ä", "x" * 65])
def test_a_name_that_could_not_be_part_of_a_key_is_refused(text: str) -> None:
    with pytest.raises(msgspec.ValidationError):
        msgspec.convert(text, Name)
