"""Motions of benchmarks come to an end whatever the robot refuses."""

import pytest
from msgspec.structs import replace

from benchmarks.robot import motions
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import Scenario


def test_a_first_push_that_is_refused_moves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def far_from_the_box(name: str) -> Scenario:
        scenario = load_scenario(name)
        return replace(scenario, start=replace(scenario.start, x_m=1.0))

    monkeypatch.setattr(motions, "load_scenario", far_from_the_box)
    done = motions.pushes(1, 1.0)
    assert (done.fell, done.duration_s) == (False, 0.0)
    assert done.way_m == pytest.approx(0.0, abs=1e-9)
