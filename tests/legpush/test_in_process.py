"""`legpush.run` and `legpush.world`: what they find, what they refuse, and that they leave the process as it was."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from threadpoolctl import threadpool_info

import legpush
from legpush.errors import ConfigError, LegpushError, PluginError, PolicyError, ScenarioError, UnsolvableError
from legpush.history.steps import PlanRecord, StepRecord

SHORT = {"mission.max_push_cycles": 2}


class Raises:
    def decide(self, world: object, scenario: object) -> None:
        raise ZeroDivisionError("no friction")


class Returns:
    def decide(self, world: object, scenario: object) -> str:
        return "push"


def test_a_mission_has_its_report_and_every_step_and_plan() -> None:
    told: list[tuple[str, float | None, str]] = []

    run = legpush.run(
        "push", seed=1, policy="scripted", changes=SHORT, progress=lambda *progress: told.append(progress)
    )

    assert run.report.reason == "max_push_cycles"
    assert not run.success
    steps = [record for record in run.records if isinstance(record, StepRecord)]
    assert isinstance(steps[0].motion, legpush.Reset)
    assert sum(isinstance(step.motion, legpush.Push) for step in steps) == run.report.n_push_cycles == 2
    assert all(step.outcome.trace is not None for step in steps)
    assert f"{steps[-1].outcome.state_crc:08x}" == run.state_crc
    assert any(isinstance(record, PlanRecord) for record in run.records)
    assert {"planning", "pushing"} <= {phase for phase, _, _ in told}


def test_equal_missions_are_equal() -> None:
    one, other = (legpush.run("push", seed=4, policy="scripted", changes=SHORT) for _ in range(2))
    assert one.records == other.records


def test_a_policy_may_be_an_object_that_decides_from_world_and_scenario() -> None:
    class Once:
        done = False

        def decide(self, world: legpush.WorldState, scenario: legpush.Scenario) -> legpush.Push | None:
            if self.done:
                return None
            self.done = True
            return legpush.Push(w1=0.5, w2=0.5, leg="FR", depth_m=0.04)

    run = legpush.run("push", policy=Once(), changes={"mission.max_push_cycles": 8})
    pushes = [record.motion for record in run.records if isinstance(record, StepRecord)]
    assert legpush.Push(w1=0.5, w2=0.5, leg="FR", depth_m=0.04) in pushes


WALLED = """
name = "walled"
[room]
size_m = [8.0, 4.0]
obstacles = [{ x_min_m = 3.0, x_max_m = 3.2, y_min_m = 0.0, y_max_m = 4.0 }]
[start]
x_m = 1.0
y_m = 2.0
yaw_deg = 0.0
[box.pose]
x_m = 5.5
y_m = 2.0
yaw_deg = 0.0
[goal.pose]
x_m = 6.5
y_m = 2.0
yaw_deg = 0.0
[pushing]
max_iterations = 500
"""


@pytest.mark.parametrize(
    ("arguments", "error", "text"),
    [
        ({"scenario": "nowhere"}, ScenarioError, r"Expected the name of a scenario \(.*default.*\).*got `nowhere`"),
        ({"seed": -1}, ConfigError, "Expected a seed from 0 to 4294967295 for seed, got -1"),
        ({"planner": "a_star"}, ScenarioError, "command line: at `planning.planner`: expected .*rrt.*got 'a_star'"),
        ({"changes": {"box.mass_kg": -1.0}}, ScenarioError, "at `box.mass_kg`: expected a number from 0.001 to 1000"),
        ({"changes": {"bocks.mass_kg": 1.0}}, ScenarioError, "expected the path of a field, .* got bocks.mass_kg"),
        ({"planner_program": "none_such"}, PluginError, r"Expected a planner \(ompl\), got 'none_such'"),
        (
            {"simulator": "none_such"},
            PluginError,
            r"Expected a simulator \(map, map_mean, map_unknown, mujoco\), got 'none_such'",
        ),
        ({"mission": "none_such"}, PluginError, r"Expected a mission \(push\), got 'none_such'"),
        (
            {"policy": "none_such"},
            PolicyError,
            r"Expected a policy \(dynamic_programming, .*wide\).*got 'none_such'",
        ),
        ({"policy": "json:no_such"}, PolicyError, "Expected module:factory that can be imported, got 'json:no_such'"),
        ({"policy": "json:loads"}, PolicyError, "json:loads: the factory raised TypeError"),
        ({"policy": object()}, PolicyError, r"expected a policy with a method `decide.*got object"),
        ({"policy": Raises()}, PolicyError, r"policy: `decide` raised ZeroDivisionError at tick \d+: no friction"),
        ({"policy": Returns()}, PolicyError, "expected `decide` to return a Push or None, got str"),
        ({"push_map": "none.json"}, LegpushError, "none.json"),
        ({"progress": 3}, ConfigError, "Expected a truth value or a function for progress, got int"),
    ],
)
def test_what_cannot_be_run_is_one_error_of_the_public_hierarchy(
    arguments: dict[str, Any], error: type[LegpushError], text: str
) -> None:
    with pytest.raises(error, match=text) as caught:
        legpush.run(**{"scenario": "push", "policy": "scripted", **arguments})
    assert isinstance(caught.value, legpush.LegpushError)


def test_a_scenario_without_a_way_is_an_error_that_has_the_mission_up_to_there(tmp_path: Path) -> None:
    file = tmp_path / "walled.toml"
    file.write_text(WALLED)
    with pytest.raises(UnsolvableError, match=r"walled: .*the planner's answer is") as caught:
        legpush.run(file, policy="scripted")
    assert caught.value.run.report.reason == "no_path"
    assert caught.value.exit_code == 1


def test_the_threads_of_numerical_libraries_are_as_they_were_afterwards() -> None:
    before = threads()
    legpush.run("push", policy="variable", changes={"mission.max_push_cycles": 1})
    after = threads()
    assert {path: n for path, n in after.items() if path in before} == before


def threads() -> dict[str, int]:
    return {library["filepath"]: library["num_threads"] for library in threadpool_info()}


INTERRUPTED = """
import os, signal, sys, threading
import legpush

at, timers = sys.argv[1], []

def tell(phase, fraction, detail):
    if phase == at and not timers:
        timers.append(threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT)))
        timers[0].start()

try:
    legpush.run("default", policy="scripted", planner="rrt_star", progress=tell)
except KeyboardInterrupt:
    print("interrupted")
"""


@pytest.mark.parametrize("phase", ["planning", "walking", "pushing"])
def test_a_mission_can_be_interrupted(phase: str) -> None:
    done = subprocess.run([sys.executable, "-c", INTERRUPTED, phase], check=False, capture_output=True, text=True)
    assert done.stdout == "interrupted\n", done.stderr


def test_importing_legpush_loads_no_large_library_and_changes_nothing() -> None:
    script = """
import os, logging, signal, sys
before = dict(os.environ), list(logging.getLogger().handlers), signal.getsignal(signal.SIGINT)
import legpush
assert (dict(os.environ), list(logging.getLogger().handlers), signal.getsignal(signal.SIGINT)) == before
loaded = {"mujoco", "ompl", "torch", "zenoh", "matplotlib", "gymnasium", "numpy", "rich"} & sys.modules.keys()
assert not loaded, loaded
legpush.run, legpush.world, legpush.Scenario, legpush.__version__
loaded = {"mujoco", "ompl", "torch", "zenoh", "matplotlib", "gymnasium"} & sys.modules.keys()
assert not loaded, loaded
"""
    done = subprocess.run([sys.executable, "-c", script], check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
