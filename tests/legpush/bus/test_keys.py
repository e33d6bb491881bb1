"""Keys: each channel of each peer has its own, and a liveliness key names its process."""

import pytest

from legpush.bus import keys
from legpush.errors import MessageError
from legpush.messages.common import PROTOCOL_VERSION


def test_keys_are_part_of_their_run_and_of_the_protocol_version() -> None:
    assert keys.action("r1", "sim3") == f"legpush/v{PROTOCOL_VERSION}/r1/sim/sim3/action"
    assert keys.plan_result("r1", "main") == f"legpush/v{PROTOCOL_VERSION}/r1/plan/main/result"


def test_no_two_kinds_of_messages_share_a_key() -> None:
    by_name = (keys.plan_request, keys.plan_cancel, keys.plan_result, keys.action, keys.observation, keys.reward)
    by_role = (keys.status, keys.copies, keys.taken)
    made = [key("r", "main") for key in by_name] + [key("r", "sim", "main") for key in by_role]
    assert len(set(made)) == len(made)
    assert all(key.startswith(f"{keys.prefix('r')}/") for key in made)


def test_a_liveliness_key_names_its_process() -> None:
    token = keys.parse_token(keys.liveliness("r", "sim", "main", "0a1b2c"))
    assert (token.protocol, token.role, token.name, token.incarnation) == (PROTOCOL_VERSION, "sim", "main", "0a1b2c")


@pytest.mark.parametrize("key", ["legpush/v/r/live/sim/main/a", "legpush/vx/r/live/sim/main/a", "sim/main/a", "a"])
def test_a_key_of_no_token_is_refused(key: str) -> None:
    with pytest.raises(MessageError):
        keys.parse_token(key)


@pytest.mark.parametrize(("role", "name"), [("ghost", "main"), ("sim", "a b"), ("sim", "*")])
def test_a_liveliness_key_that_names_no_process_is_refused(role: str, name: str) -> None:
    with pytest.raises(MessageError):
        keys.parse_token(keys.liveliness("r", role, name, "a"))
