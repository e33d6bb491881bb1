"""Many simulators behind two routers: all are found and stepped, and what is reported of them."""

from collections.abc import Mapping
from typing import Any

import pytest

from benchmarks.bus import many_simulators
from benchmarks.bus.many_simulators import Config, Stepped, reported


def test_all_simulators_are_found_and_stepped_through_both_routers(monkeypatch: pytest.MonkeyPatch) -> None:
    written: dict[str, Any] = {}

    def keep(name: str, numbers: Mapping[str, Any]) -> None:
        written[name] = numbers

    monkeypatch.setattr(many_simulators, "write_report", keep)
    many_simulators.main(Config(simulators=6, processes=3, seconds=4.0))
    numbers = written["many_simulators"]
    assert (numbers["found"], numbers["n_wrong"]) == (6, 0)
    assert numbers["steps_of_one"]["least"] > 0
    assert numbers["growth"].keys() == {"learner", "router", "simulators"}


def test_messages_are_counted_per_second_and_per_core() -> None:
    stepped = [Stepped(n_steps=10, longest_s=0.1), Stepped(n_steps=30, longest_s=0.2)]
    used_s = {"learner": 1.0, "router 0": 1.0, "router 1": 2.0, "simulators 0": 4.0}
    numbers = reported(stepped, 10.0, used_s)
    assert numbers["steps_of_one"] == {"least": 10, "median": 20, "most": 30}
    assert (numbers["messages_per_s"], numbers["messages_per_core_s"], numbers["cores_used"]) == (8, 10, 0.8)
    assert numbers["longest_step_s"] == 0.2
    assert numbers["cpu_us_per_message"] == {"learner": 12500.0, "router": 37500.0, "simulators": 50000.0}
