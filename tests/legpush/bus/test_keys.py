"""Keys: each channel of each peer has its own, and a liveliness key names its process."""

from collections.abc import Callable

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
    together = (keys.bundled_actions, keys.bundled_answers, keys.job_request, keys.job_result)
    made = [key("r", "main") for key in (*by_name, *together)] + [key("r", "sim", "main") for key in by_role]
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


@pytest.mark.parametrize("make", [keys.action, keys.observation])
def test_a_key_of_actions_or_answers_names_its_simulator(make: Callable[[str, str], str]) -> None:
    assert keys.simulator_of(make("r", "robot-1")) == "robot-1"


@pytest.mark.parametrize("key", [keys.action("r", "*"), keys.reward("r", "a"), keys.bundled_actions("r", "a"), "a"])
def test_any_other_key_names_none(key: str) -> None:
    assert keys.simulator_of(key) is None


def test_an_incarnation_tells_which_process_a_simulator_shares() -> None:
    process = "bundle0123456789ab"
    incarnation = keys.incarnation_of_member(process, 256)
    assert keys.process_of(incarnation) == process
    assert keys.parse_token(keys.liveliness("r", "sim", "a-1", incarnation)).incarnation == incarnation


@pytest.mark.parametrize("other", ["0a1b2c", "550e8400-e29b-41d4", "bundle0123456789ab", "bundle0123456789ab-", ""])
def test_a_simulator_in_a_process_of_its_own_shares_none(other: str) -> None:
    assert keys.process_of(other) is None
