"""Motions of benchmarks come to an end whatever the robot refuses."""

import dataclasses

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


def test_runs_without_a_footstep_have_no_touchdowns_for_each() -> None:
    done = motions.pushes(1, 1.0, n=1)
    assert done.measures is not None
    nothing = replace(done.measures, n_footsteps=0, n_touchdowns=0, n_loadings=0, landing_speeds_m_s=())
    summary = motions.summary([dataclasses.replace(done, measures=nothing)])
    absent = {"touchdowns_per_footstep", "loadings_per_footstep", "landing_speed_99_m_s", "landing_speed_max_m_s"}
    assert {name for name, value in summary.items() if value is None} == absent
