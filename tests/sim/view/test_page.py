"""The page without a browser: what is looked at, and what people do to it."""

from collections.abc import Iterator

import pytest
from msgspec.structs import replace

from legpush.history.run_history import RunHistory
from legpush.history.timeline import TRUNK
from legpush.messages import codec
from legpush.messages.stepping import Action, Observation
from legpush.messages.telemetry import Copy, Origin
from sim_proc.view.beside import GAP_M
from sim_proc.view.page import SLOW_PERIOD_S, Page
from sim_proc.view.panel import PanelCommand
from tests.legpush.recording.recordings import AGENT, EPISODE, SIM


class Training:
    """A live run that keeps few episodes, and whoever adds them."""

    is_live = True
    is_reading = False
    title = "Run of a test"

    def __init__(self, messages: tuple[list[Copy], list[Copy]]) -> None:
        self._messages = messages
        self._left: list[int] = []
        self._n = 0

    def add(self, n_episodes: int) -> None:
        self._left += range(self._n, self._n + n_episodes)
        self._n += n_episodes

    def pump(self, history: RunHistory, budget_s: float) -> None:
        assert budget_s > 0.0
        for number in self._left:
            for topic, origin, copies, kind in (
                ("sim/main/action", AGENT, self._messages[0], Action),
                ("sim/main/observation", SIM, self._messages[1], Observation),
            ):
                for each in copies:
                    message = replace(codec.decode(each.payload, kind), episode=EPISODE + number)
                    payload, at_ns = codec.encode(message), each.time_ns + number * 10**12
                    history.take_message(topic, origin, replace(each, payload=payload, time_ns=at_ns))
        self._left.clear()
        history.keep_newest(2)

    def live(self) -> list[Origin]:
        return []


@pytest.fixture
def training(messages: tuple[list[Copy], list[Copy]]) -> Training:
    return Training(messages)


@pytest.fixture
def page(training: Training) -> Iterator[Page]:
    with Page(training, "127.0.0.1", 0) as opened:
        yield opened


def test_with_a_second_recording_the_page_opens_at_both_rooms(
    training: Training, messages: tuple[list[Copy], list[Copy]]
) -> None:
    second = Training(messages)
    for each in (training, second):
        each.add(1)
    with Page(training, "127.0.0.1", 0, second) as page:
        page.update(SLOW_PERIOD_S)
        page._slow_at = 0.0
        page.update(SLOW_PERIOD_S)

        assert page.shown is not None
        width_m, depth_m = page.shown.scenario.room.size_m
        trunk = page.shown.qpos[page.player.row(page.shown)][TRUNK]
        middle_m = (width_m + GAP_M / 2 - trunk[0], depth_m / 2 - trunk[1], 0.0)
        assert page._server.initial_camera.look_at == pytest.approx(middle_m)


def test_an_old_episode_can_be_looked_at_for_as_long_as_one_likes(page: Page, training: Training) -> None:
    training.add(2)
    page.update(0.04)
    page.obey(PanelCommand("episode", "0: simulator main"))
    first = page.shown
    for _ in range(4):
        training.add(3)
        page.update(0.04)
    assert page.shown is first
    assert page.shown in page.history.episodes.values()


def test_whoever_chose_an_episode_of_a_live_run_can_follow_it_again(page: Page, training: Training) -> None:
    training.add(2)
    page.update(0.04)
    assert page.player.follows
    page.obey(PanelCommand("episode", "0: simulator main"))
    assert not page.player.follows
    page.obey(PanelCommand("live"))
    page.update(0.04)
    assert page.shown is list(page.history.episodes.values())[-1]


def test_an_episode_that_was_forgotten_meanwhile_is_not_shown(page: Page, training: Training) -> None:
    training.add(5)
    page.update(0.04)
    before = page.shown
    page.obey(PanelCommand("episode", "0: simulator main"))
    assert page.shown is before


def test_before_there_is_anything_controls_do_nothing(page: Page) -> None:
    for name, value in (("play", None), ("seek", 1.0), ("jump", "<"), ("episode", "0: x"), ("camera", "Top")):
        page.obey(PanelCommand(name, value))
    page.update(0.04)
    assert page.shown is None
