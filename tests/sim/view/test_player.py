"""The cursor on a timeline: time that passes, and what people do to it."""

import numpy as np
import pytest

from legpush.history.timeline import Timeline
from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.view.player import Player


def time_s(player: Player, timeline: Timeline) -> float:
    return float(timeline.time_s[player.row(timeline)])


@pytest.mark.parametrize("speed", [0.1, 1.0, 5.0])
def test_playing_goes_on_at_its_speed(timeline: Timeline, speed: float) -> None:
    player = Player(follows=False)
    player.speed = speed

    for _ in range(30):
        player.advance(0.02, timeline)

    assert time_s(player, timeline) == pytest.approx(0.6 * speed, abs=CONTROL_PERIOD_S)


def test_playing_stops_at_the_end_and_begins_again_from_there(timeline: Timeline) -> None:
    player = Player(follows=False)

    player.advance(1e6, timeline)
    assert player.is_at_end(timeline)
    assert not player.is_playing

    player.play(timeline)
    assert player.row(timeline) == 0
    assert player.is_playing


def test_followed_live_it_is_at_the_end_in_less_than_two_seconds_and_goes_on_when_there_is_more(
    timeline: Timeline,
) -> None:
    player = Player(follows=True)

    rows = []
    for _ in range(60):
        player.advance(1 / 30, timeline)
        rows.append(player.row(timeline))

    assert rows[-1] == timeline.n_rows - 1
    assert len(set(rows)) > 5, "it jumped"
    assert all(np.diff(rows) >= 0)
    assert player.is_playing


def test_whoever_pauses_stays_where_he_is(timeline: Timeline) -> None:
    player = Player(follows=True)
    player.advance(0.3, timeline)
    player.pause()
    row = player.row(timeline)

    player.advance(5.0, timeline)

    assert player.row(timeline) == row
    assert not player.follows


@pytest.mark.parametrize(("asked_s", "got_s"), [(-1.0, 0.0), (0.0, 0.0), (1.3, 1.3), (1e9, None)])
def test_seeking_goes_to_that_time_or_to_the_nearest_there_is(
    timeline: Timeline, asked_s: float, got_s: float | None
) -> None:
    player = Player(follows=True)
    player.seek(asked_s, timeline)
    assert time_s(player, timeline) == pytest.approx(timeline.time_s[-1] if got_s is None else got_s)
    assert not player.follows


def test_ticks_and_steps_are_counted_and_end_where_there_are_no_more(timeline: Timeline) -> None:
    player = Player(follows=False)
    ends = [step.first_row + step.n_rows - 1 for step in timeline.steps]

    player.move_rows(3, timeline)
    assert player.row(timeline) == 3
    player.move_rows(-5, timeline)
    assert player.row(timeline) == 0
    for end in ends[1:]:
        player.move_steps(1, timeline)
        assert player.row(timeline) == end
    player.move_steps(1, timeline)
    assert player.row(timeline) == ends[-1]
    player.move_steps(-1, timeline)
    assert player.row(timeline) == ends[-2]
    assert not player.is_playing


def test_at_the_end_of_what_is_still_read_it_waits_for_more(timeline: Timeline) -> None:
    player = Player(follows=False)
    player.advance(1e6, timeline, grows=True)
    assert player.is_at_end(timeline)
    assert player.is_playing
