"""Counting what was refused or dropped."""

import logging

import pytest

from legpush.bus.tally import Tally


def test_a_flood_of_refusals_is_counted_in_full_and_logged_once(caplog: pytest.LogCaptureFixture) -> None:
    tally = Tally()
    with caplog.at_level(logging.WARNING):
        for _ in range(1000):
            tally.add("malformed", "some key: no map")
        tally.add("version", "some key: expected 1, got 2")
    assert tally.as_dict() == {"malformed": 1000, "version": 1}
    assert [record.getMessage() for record in caplog.records] == [
        "malformed (1 so far): some key: no map",
        "version (1 so far): some key: expected 1, got 2",
    ]
