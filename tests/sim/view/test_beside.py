"""A second recording is drawn at the simulated time of the first one, in a room beside it."""

from collections.abc import Collection
from typing import Any

import numpy as np
import pytest

from legpush.history.run_history import RunHistory
from legpush.history.timeline import TRUNK, Timeline
from legpush.messages.telemetry import Copy, Origin
from sim_proc.view import beside as module
from sim_proc.view.beside import GAP_M, ROOT, Beside
from tests.legpush.recording.recordings import ACTIONS, AGENT, SIM


class Recorded:
    """A recording that is read at once."""

    is_live = False
    title = "Recording other.mcap"

    def __init__(self, messages: tuple[list[Copy], list[Copy]]) -> None:
        self.is_reading = True
        self._messages = messages

    def pump(self, history: RunHistory, budget_s: float) -> None:
        assert budget_s > 0.0
        for origin, copies in ((AGENT, self._messages[0]), (SIM, self._messages[1])):
            for copy in copies:
                topic = "sim/main/action" if copy.key == ACTIONS else "sim/main/observation"
                history.take_message(topic, origin, copy)
        self.is_reading = False

    def live(self) -> Collection[Origin] | None:
        return None


class Drawn:
    """A scene that notes what it should draw."""

    def __init__(self, _server: object, root: str) -> None:
        self.root = root
        self.began: list[float] = []
        self.shown: list[dict[str, Any]] = []

    def begin(self, _timeline: Timeline, aside_m: float) -> None:
        self.began.append(aside_m)

    def show(self, _history: RunHistory, _timeline: Timeline, row: int, **how: Any) -> None:
        self.shown.append({"row": row, **how})


@pytest.fixture
def beside(messages: tuple[list[Copy], list[Copy]], monkeypatch: pytest.MonkeyPatch) -> Beside:
    monkeypatch.setattr(module, "Scene", Drawn)
    return Beside(None, Recorded(messages))  # type: ignore[arg-type]


def test_nothing_is_drawn_before_it_is_read(beside: Beside, timeline: Timeline) -> None:
    beside.show(timeline, 0, follow=True)
    assert beside.scene.shown == []  # type: ignore[attr-defined]
    assert beside.title == "Recording other.mcap"


def test_equal_times_are_drawn_in_a_room_beside_the_first(beside: Beside, timeline: Timeline) -> None:
    beside.pump()
    rows = (0, 10, timeline.n_rows - 1)
    for row in rows:
        beside.show(timeline, row, follow=True)

    scene: Any = beside.scene
    assert scene.root == ROOT
    assert scene.began == [timeline.scenario.room.size_m[0] + GAP_M]
    assert [shown["row"] for shown in scene.shown] == list(rows)
    np.testing.assert_array_equal(scene.shown[1]["centre_m"], timeline.qpos[10, TRUNK][:2])
    assert all(shown["follow"] for shown in scene.shown)


def test_it_is_read_once(beside: Beside) -> None:
    beside.pump()
    beside._source.pump = None  # type: ignore[assignment, method-assign]
    beside.pump()
