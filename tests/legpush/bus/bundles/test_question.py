"""Actions and answers name their question, and other bytes name none."""

import msgspec
import pytest

from legpush.bus.bundles.question import Question, answered_in, asked_in
from legpush.messages import codec
from legpush.messages.bundle import Part
from legpush.messages.stepping import Action, Observation, Refusal
from tests.legpush.examples import MESSAGES

AGENT = "agent-0a1b2c"
DEEP = b"\x81\xa1x" + b"\x91" * 100_000 + b"\xc0"


@pytest.mark.parametrize("name", MESSAGES)
def test_an_action_asks_and_an_answer_answers(name: str) -> None:
    message = MESSAGES[name]
    payload = codec.encode(message)
    if isinstance(message, Action):
        assert asked_in(payload) == Question(AGENT, message.episode, message.step)
    if isinstance(message, Observation | Refusal):
        assert answered_in(payload) == Question(AGENT, message.episode, message.step)
    else:
        assert answered_in(payload) is None


@pytest.mark.parametrize(
    "payload",
    [
        b"",
        b"\xc1",
        b"\x80",
        DEEP,
        b"\x81\xa1\xff\xc0",
        codec.encode(Part(key="a", payload=b"")),
        msgspec.msgpack.encode({"header": {"incarnation": "a"}, "episode": -1, "step": 0}),
        msgspec.msgpack.encode({"header": {"incarnation": "a"}, "episode": 2**63, "step": 0}),
        msgspec.msgpack.encode({"header": {"incarnation": ""}, "agent_incarnation": "", "episode": 0, "step": 0}),
    ],
    ids=range(9),
)
def test_other_bytes_name_no_question(payload: bytes) -> None:
    assert asked_in(payload) is None
    assert answered_in(payload) is None
