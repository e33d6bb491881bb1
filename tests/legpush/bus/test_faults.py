"""The bad channel: each fault does what it says, as often as it says, and the same in every run of a seed."""

from threading import Event

import pytest

from legpush.bus.faults import BadChannel, Fate, Faults, fate_table
from legpush.errors import ConfigError

FINE = Fate(dropped=False, duplicated=False, delay_s=0.0, reordered=False)
DROPPED = Fate(dropped=True, duplicated=False, delay_s=0.0, reordered=False)
DUPLICATED = Fate(dropped=False, duplicated=True, delay_s=0.0, reordered=False)
DELAYED = Fate(dropped=False, duplicated=False, delay_s=0.02, reordered=False)
REORDERED = Fate(dropped=False, duplicated=False, delay_s=0.0, reordered=True)


def sent(table: list[Fate], n_messages: int, n_expected: int) -> list[int]:
    """What comes out, in order, when messages 0, 1, ... go in; waits for `n_expected` of them."""
    got: list[int] = []
    enough = Event()

    def deliver(payload: bytes) -> None:
        got.append(payload[0])
        if len(got) == n_expected:
            enough.set()

    channel = BadChannel(table, deliver)
    for number in range(n_messages):
        channel.send(bytes([number]))
    assert enough.wait(5.0), f"only {got} came out"
    channel.close()
    return got


@pytest.mark.parametrize(
    ("table", "expected"),
    [
        pytest.param([FINE], [0, 1, 2, 3], id="nothing happens"),
        pytest.param([FINE, DROPPED], [0, 2], id="every second one is lost"),
        pytest.param([FINE, DUPLICATED], [0, 1, 1, 2, 3, 3], id="every second one comes twice"),
        pytest.param([REORDERED, FINE], [1, 0, 3, 2], id="every second one is overtaken"),
        pytest.param([DELAYED, FINE, FINE, FINE], [1, 2, 3, 0], id="the first comes late"),
        pytest.param([REORDERED, DROPPED], [0, 2], id="a message that was held back outlives the one that is lost"),
    ],
)
def test_each_message_meets_the_fate_of_its_row(table: list[Fate], expected: list[int]) -> None:
    assert sent(table, 4, len(expected)) == expected


def test_a_closed_channel_loses_what_was_under_way() -> None:
    got: list[bytes] = []
    channel = BadChannel([Fate(dropped=False, duplicated=False, delay_s=60.0, reordered=False)], got.append)
    channel.send(b"x")
    channel.close()
    assert got == []


def test_the_table_depends_on_the_seed_and_the_key_alone() -> None:
    faults = Faults(probability=0.2, seed=5)
    assert fate_table(faults, "a") == fate_table(faults, "a")
    assert fate_table(faults, "a") != fate_table(faults, "b")
    assert fate_table(faults, "a") != fate_table(Faults(probability=0.2, seed=6), "a")


def test_each_fault_comes_up_with_the_given_probability() -> None:
    table = fate_table(Faults(probability=0.2), "key", n_rows=20_000)
    shares = [
        sum(hits) / len(table)
        for hits in zip(*((f.dropped, f.duplicated, f.delay_s > 0.0, f.reordered) for f in table), strict=True)
    ]
    assert len(shares) == 4
    assert shares == pytest.approx([0.2] * 4, abs=0.015)


def test_without_probability_nothing_happens() -> None:
    assert set(fate_table(Faults(probability=0.0), "key")) == {FINE}


@pytest.mark.parametrize("probability", [-0.1, 1.0, float("nan")])
def test_a_probability_that_is_none_is_refused(probability: float) -> None:
    with pytest.raises(ConfigError, match=r"probability in \[0, 1\)"):
        Faults(probability=probability)
