"""The gate of a channel, without a bus: what is valid passes, everything else is counted."""

import pytest

from legpush.bus import channels, keys
from legpush.bus.tally import Tally
from legpush.bus.validation import Validation
from legpush.messages import codec
from tests.legpush.examples import MESSAGES
from tests.legpush.fakes import RUN


def test_a_valid_message_passes() -> None:
    tally = Tally()
    gate = Validation(channels.statuses(RUN), RUN, tally)
    message = MESSAGES["status"]
    assert gate.validate_payload(keys.status(RUN, "agent", "main"), codec.encode(message)) == message
    assert tally.as_dict() == {}


@pytest.mark.parametrize("name", sorted(set(MESSAGES) - {"status"}))
def test_any_other_message_is_counted_as_malformed(name: str) -> None:
    tally = Tally()
    gate = Validation(channels.statuses(RUN), RUN, tally)
    assert gate.validate_payload(keys.status(RUN, "agent", "main"), codec.encode(MESSAGES[name])) is None
    assert tally.as_dict() == {"malformed": 1}


def test_a_message_that_is_too_large_is_not_even_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(codec, "MAX_MESSAGE_BYTES", 8)
    tally = Tally()
    gate = Validation(channels.statuses(RUN), RUN, tally)
    assert gate.validate_payload("k", b"\xc1" * 9) is None
    assert tally.as_dict() == {"oversize": 1}


def test_a_message_under_a_key_with_a_wildcard_is_refused() -> None:
    tally = Tally()
    gate = Validation(channels.actions(RUN, "main"), RUN, tally)
    action = codec.encode(MESSAGES["action_walk"])
    assert gate.validate_payload(keys.action(RUN, "*"), action) is None
    assert tally.as_dict() == {"sender": 1}
    assert gate.validate_payload(keys.action(RUN, "main"), action) == MESSAGES["action_walk"]
