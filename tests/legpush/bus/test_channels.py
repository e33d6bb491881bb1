"""Channels: who may speak where, and how it is sent."""

import pytest

from legpush.bus import channels, keys
from legpush.bus.channels import Channel
from legpush.messages.planning import PlanRequest
from tests.legpush.examples import header
from tests.legpush.fakes import RUN


@pytest.mark.parametrize(
    "channel",
    [
        channels.actions(RUN, "main"),
        channels.answers(RUN, "main"),
        channels.plan_requests(RUN, "main"),
        channels.plan_cancels(RUN, "main"),
        channels.plan_results(RUN, "main"),
    ],
    ids=lambda channel: channel.key,
)
def test_what_the_lockstep_needs_is_never_dropped_and_has_one_sender(channel: Channel[PlanRequest]) -> None:
    assert channel.quality == "lockstep"
    assert channel.sender in ("agent", "sim", "planner")
    assert channel.is_copied


def test_what_people_and_recorders_get_delays_nothing() -> None:
    people = (channels.rewards(RUN, "main"), channels.statuses(RUN))
    recorders = (channels.copies(RUN), channels.taken(RUN, "sim", "main"))
    assert {channel.quality for channel in (*people, *recorders)} == {"tap"}
    assert [channel.is_copied for channel in (*people, *recorders)] == [True, True, False, False]


def test_where_a_key_names_its_sender_the_header_has_to_agree() -> None:
    for channel, role, key in (
        (channels.answers(RUN, "*"), "sim", keys.observation(RUN, "b")),
        (channels.plan_requests(RUN, "*"), "agent", keys.plan_request(RUN, "b")),
        (channels.plan_cancels(RUN, "*"), "agent", keys.plan_cancel(RUN, "b")),
        (channels.statuses(RUN), "planner", keys.status(RUN, "planner", "b")),
        (channels.copies(RUN), "planner", keys.copies(RUN, "planner", "b")),
    ):
        assert channel.key_of is not None
        assert channel.key_of(header(role, "b")) == key  # type: ignore[arg-type]
