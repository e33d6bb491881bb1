"""Encoding and decoding: what is valid survives bit for bit, what is not has one kind of error and names the field."""

import subprocess
import sys

import msgpack
import msgspec
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from legpush.bus.channels import Message
from legpush.errors import MessageError
from legpush.messages import codec
from legpush.messages.planning import PlanRequest, PlanResult
from legpush.messages.stepping import Action, Answer, Observation, Outcome, Refusal, Trace
from legpush.messages.telemetry import Status
from tests.legpush.examples import MESSAGES, header
from tests.legpush.strategies import records

KINDS: list[type[Message]] = [PlanRequest, PlanResult, Action, Observation, Refusal, Status]
STATUS = msgpack.unpackb(codec.encode(MESSAGES["status"]))


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
@given(data=st.data())
def test_every_message_survives_the_way_through_bytes(kind: type[Message], data: st.DataObject) -> None:
    message = data.draw(records(kind))
    assert codec.decode(codec.encode(message), kind) == message


def test_observations_and_refusals_are_told_apart() -> None:
    for name in ("observation", "refusal"):
        message = MESSAGES[name]
        assert codec.decode(codec.encode(message), Answer) == message  # type: ignore[arg-type]


@pytest.mark.parametrize("name", sorted(MESSAGES))
def test_what_is_encoded_here_is_decoded_the_quick_way(name: str) -> None:
    message = MESSAGES[name]
    payload = codec.encode(message)
    assert payload == msgpack.packb(msgspec.to_builtins(message, builtin_types=(bytes,)))
    assert codec.decode_own(payload, type(message)) == message


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
@given(data=st.data())
def test_the_quick_way_takes_nothing_that_the_strict_one_refuses(kind: type[Message], data: st.DataObject) -> None:
    payload = bytearray(codec.encode(data.draw(records(kind))))
    for _ in range(data.draw(st.integers(1, 3))):
        payload[data.draw(st.integers(0, len(payload) - 1))] = data.draw(st.integers(0, 255))
    quick = codec.decode_own(bytes(payload), kind)
    if quick is not None:
        assert codec.convert(codec.unpack(bytes(payload)), kind) == quick


def test_another_encoding_of_a_valid_message_is_left_to_the_strict_way() -> None:
    message = MESSAGES["status"]
    for plain in (dict(reversed(STATUS.items())), {**STATUS, "fraction": 1}):
        payload = msgpack.packb(plain)
        assert codec.decode_own(payload, Status) is None
        assert codec.decode(payload, Status) == (replace(message, fraction=1.0) if plain["fraction"] == 1 else message)


def test_bytes_that_look_like_a_number_that_is_not_finite_are_sent() -> None:
    message = Status(header=header("sim"), phase="x", detail="\x7f\u02ff", fraction=0.5)
    copy = replace(MESSAGES["copies"].copies[0], payload=b"\xcb\x7f\xf8" + bytes(6))  # type: ignore[union-attr]
    copies = replace(MESSAGES["copies"], copies=(copy,))
    for each in (message, copies):
        assert codec.decode_own(codec.encode(each), type(each)) == each


def test_physics_numbers_keep_every_bit() -> None:
    value = 0.1 + 0.2
    message = Status(header=header("sim"), phase="x", fraction=value)
    assert codec.decode(codec.encode(message), Status).fraction == value


@settings(max_examples=200)
@given(st.binary(max_size=200))
def test_random_bytes_are_refused_and_nothing_else_happens(payload: bytes) -> None:
    with pytest.raises(MessageError):
        codec.decode(payload, Action)


@settings(max_examples=300, deadline=None)
@given(st.data())
def test_a_message_with_one_byte_changed_decodes_or_is_refused(data: st.DataObject) -> None:
    payload = bytearray(codec.encode(MESSAGES["action_push"]))
    payload[data.draw(st.integers(0, len(payload) - 1))] = data.draw(st.integers(0, 255))
    try:
        message = codec.decode(bytes(payload), Action)
    except MessageError:
        return
    assert isinstance(message, Action)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"extra": 1}, r"unknown field `extra`"),
        ({"phase": 1}, r"Expected `str`, got `int` - at `\$.phase`"),
        ({"fraction": True}, r"got `bool` - at `\$.fraction`"),
        ({"fraction": 1.5}, r"<= 1.0 - at `\$.fraction`"),
        ({"fraction": msgpack.Timestamp(1, 2)}, r"got `Timestamp` - at `\$.fraction`"),
        ({"phase": msgpack.ExtType(3, b"x")}, r"at `\$.phase`"),
        ({"header": {**STATUS["header"], "name": "a/b"}}, r"regex .* - at `\$.header.name`"),
        ({"header": {**STATUS["header"], "name": "a\n"}}, r"regex .* - at `\$.header.name`"),
        ({"header": {**STATUS["header"], "sequence": -1}}, r">= 0 - at `\$.header.sequence`"),
    ],
)
def test_a_wrong_field_is_named(changes: dict[str, object], text: str) -> None:
    with pytest.raises(MessageError, match=text):
        codec.decode(msgpack.packb({**STATUS, **changes}), Status)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_a_number_that_is_not_finite_is_refused_with_its_path_on_both_ways(value: float) -> None:
    message = Status(header=header("sim"), phase="x", fraction=value)
    with pytest.raises(MessageError, match=r"finite .* at `\$.fraction`") as sent:
        codec.encode(message)
    assert sent.value.cause == "not_finite"
    plain = msgpack.unpackb(codec.encode(MESSAGES["action_follow"]))
    plain["motion"]["waypoints"][1]["x_m"] = value
    with pytest.raises(MessageError, match=r"finite .* at `\$.motion.waypoints\[1\].x_m`") as got:
        codec.decode(msgpack.packb(plain), Action)
    assert got.value.cause == "not_finite"


def _outcome_and_trace() -> tuple[Outcome, Trace]:
    observation = MESSAGES["observation"]
    assert isinstance(observation, Observation)
    assert observation.outcome.trace is not None
    return observation.outcome, observation.outcome.trace


@pytest.mark.parametrize("numbers", [(float("inf"), float("-inf")), (1.0, float("nan"), 2.0)])
def test_a_number_that_is_not_finite_is_found_among_others(numbers: tuple[float, ...]) -> None:
    outcome, example = _outcome_and_trace()
    trace = replace(example, qpos=((0.5,) * 4, (0.5, *numbers)))
    index = 2 if numbers[0] == 1.0 else 1
    with pytest.raises(MessageError, match=rf"finite .* at `\$.trace.qpos\[1\]\[{index}\]`"):
        codec.encode(replace(outcome, trace=trace))


def test_large_numbers_whose_sum_is_not_finite_are_sent() -> None:
    large = replace(_outcome_and_trace()[1], support_margin_m=(1.7e308,) * 3)
    look_alike = replace(MESSAGES["copies"].copies[0], payload=b"\xcb\x7f\xf8" + bytes(6))  # type: ignore[union-attr]
    assert codec.encode(large) == msgpack.packb(msgspec.to_builtins(large))
    assert codec.encode(look_alike) == msgpack.packb(msgspec.to_builtins(look_alike, builtin_types=(bytes,)))


@pytest.mark.parametrize("number", [2**64, -(2**63) - 1, 10**400])
def test_an_integer_that_messagepack_cannot_hold_is_a_message_error(number: int) -> None:
    with pytest.raises(MessageError, match=r"Expected a Header that MessagePack can hold .*OverflowError"):
        codec.encode(replace(header("sim"), sequence=number))


def test_a_text_that_is_not_unicode_is_a_message_error() -> None:
    with pytest.raises(MessageError, match=r"Expected a Status that MessagePack can hold .*surrogates"):
        codec.encode(Status(header=header("sim"), phase="\ud800"))


def test_an_oversize_message_is_refused_on_both_ways(monkeypatch: pytest.MonkeyPatch) -> None:
    payload = codec.encode(MESSAGES["status"])
    monkeypatch.setattr(codec, "MAX_MESSAGE_BYTES", len(payload) - 1)
    for attempt in (lambda: codec.encode(MESSAGES["status"]), lambda: codec.decode(payload, Status)):
        with pytest.raises(MessageError, match=f"at most {len(payload) - 1} bytes, got {len(payload)}") as error:
            attempt()
        assert error.value.cause == "oversize"


@pytest.mark.parametrize(
    "payload",
    [
        pytest.param(b"", id="nothing"),
        pytest.param(b"\xc1", id="a byte that MessagePack never uses"),
        pytest.param(b"\x91" * 100_000, id="100 000 arrays in each other"),
        pytest.param(b"\xdd\xff\xff\xff\xff", id="an array that claims four billion elements"),
        pytest.param(codec.encode(MESSAGES["status"]) + b"\x00", id="a byte too many"),
        pytest.param(codec.encode(MESSAGES["status"])[:-1], id="a byte too few"),
        pytest.param(msgpack.packb({1: 2}), id="integer keys"),
        pytest.param(msgpack.packb({b"header": 2}), id="binary keys"),
        pytest.param(b"\x82\xa1a\x01\xa1a\x02", id="a key twice"),
        pytest.param(msgpack.packb([1, 2]), id="an array"),
        pytest.param(msgpack.packb("\ud800", unicode_errors="surrogatepass"), id="a lone surrogate"),
    ],
)
def test_garbage_is_refused(payload: bytes) -> None:
    with pytest.raises(MessageError):
        codec.decode(payload, Status)


def test_a_repeated_key_is_refused_by_its_name_at_any_depth() -> None:
    whole = codec.encode(MESSAGES["status"])
    field = msgpack.packb("sequence") + msgpack.packb(MESSAGES["status"].header.sequence)
    n_fields = len(msgpack.unpackb(whole)["header"])
    header = msgpack.packb("header")
    twice = whole.replace(header + bytes([0x80 + n_fields]), header + bytes([0x80 + n_fields + 1]))
    at = whole.index(field)
    with pytest.raises(MessageError, match="a map with the key 'sequence' twice"):
        codec.decode(twice[:at] + field + twice[at:], Status)


FIRST_USE = """
import sys, threading
from legpush.messages import codec
from legpush.messages.common import Header
from legpush.messages.stepping import Action, Observation, Walk
from tests.legpush.examples import WORLD
from legpush.messages.stepping import Outcome

sys.setswitchinterval(1e-6)
header = Header(protocol=8, run="r", role="agent", name="main", incarnation="0" * 12, sequence=1)
action = codec.encode(Action(header=header, episode=1, step=1, motion=Walk()))
outcome = Outcome(world=WORLD, state_crc=1)
said = Observation(header=header, agent_incarnation="0" * 12, episode=1, step=1, outcome=outcome)
observation, go = codec.encode(said), threading.Barrier(12)

def work(is_action):
    go.wait()
    for _ in range(20):
        codec.decode(*((action, Action) if is_action else (observation, Observation)))

threads = [threading.Thread(target=work, args=(number % 2,)) for number in range(12)]
for each in threads:
    each.start()
for each in threads:
    each.join()
"""


def test_many_threads_may_decode_a_type_for_the_first_time_at_once() -> None:
    """msgspec crashes the process if it is not prevented, about every second time."""
    for _ in range(5):
        done = subprocess.run([sys.executable, "-c", FIRST_USE], check=False, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
