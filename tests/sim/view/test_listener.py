"""Who is there in a live run."""

from types import SimpleNamespace
from typing import Any

from msgspec.structs import replace

from legpush.history.run_history import RunHistory
from legpush.messages.telemetry import Origin
from sim_proc.view.listener import Listener
from tests.legpush.recording.recordings import SIM, batch

REPLAY = Origin(role="launcher", name="replay", incarnation="replay-1")


def test_whom_a_replay_stands_for_is_there_as_long_as_the_replay_is() -> None:
    peers = [REPLAY]
    bus: Any = SimpleNamespace(liveliness=SimpleNamespace(live=lambda: peers))
    listener, handed_over = Listener(bus), batch(SIM, 0, [])
    listener.take_batch(
        replace(handed_over, header=replace(handed_over.header, role="launcher", incarnation="replay-1")), RunHistory()
    )
    assert listener.live() == [REPLAY, SIM]
    peers.clear()
    assert listener.live() == []


def test_whose_own_copies_came_is_there_only_as_long_as_it_is_seen() -> None:
    bus: Any = SimpleNamespace(liveliness=SimpleNamespace(live=list))
    listener = Listener(bus)
    listener.take_batch(batch(SIM, 0, []), RunHistory())
    assert listener.live() == []
