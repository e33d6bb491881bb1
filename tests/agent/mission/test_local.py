"""The mission as a plug-in, in a world without physics."""

from pathlib import Path

import pytest
from msgspec.structs import replace

from agent_proc.mission.local import run_local
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.push_model.map import write_push_map
from legpush.errors import ConfigError, PolicyError
from legpush.history.steps import StepRecord
from legpush.messages.stepping import Push, Reset, WorldState
from legpush.runs.report import Report
from legpush.scene.scenario import Goal, PoseDeg, Scenario
from planner_proc.planning import make_plan
from tests.agent.fake_world import FakeWorld, make_scenario, scenario_at_station
from tests.agent.push_model.maps import measured


def run(world: FakeWorld, scenario: Scenario, policy: object = "scripted", push_map: Path | None = None) -> Report:
    return run_local(
        world,
        scenario,
        seed=7,
        policy=policy,
        trust_policy_file=False,
        push_map=push_map,
        records=world.records,
        tell=world.tell,
    )


def test_the_report_is_that_of_the_recorded_mission() -> None:
    world, scenario = FakeWorld(), make_scenario()

    report = run(world, scenario)

    assert (report.success, report.reason, report.seed) == (True, "success", 7)
    assert world.motions(Reset) == [Reset(scenario=scenario, seed=7)]
    assert report.n_push_cycles == len(world.motions(Push)) > 5
    last = world.records[-1]
    assert isinstance(last, StepRecord)
    assert report.state_crc == f"{last.outcome.state_crc:08x}"
    assert report.wall_time_s > 0.0
    assert report.versions["numpy"] is not None
    assert "pushing" in {phase for phase, _, _ in world.told}


def test_a_policy_may_be_a_name_or_an_object_that_decides() -> None:
    class ByWorld:
        """Decides from world and scenario, as policies of users do."""

        def decide(self, world: WorldState, scenario: Scenario) -> Push | None:
            return Push(w1=0.5, w2=0.5, leg="FR", depth_m=0.07)

    named, made, by_world = FakeWorld(), FakeWorld(), FakeWorld()
    run(named, scenario_at_station())
    run(made, scenario_at_station(), ScriptedPolicy())
    run(by_world, scenario_at_station(), ByWorld())

    assert named.motions(Push) == made.motions(Push)
    assert by_world.motions(Push)[0] == Push(w1=0.5, w2=0.5, leg="FR", depth_m=0.07)


def test_what_decides_nothing_is_no_policy() -> None:
    world = FakeWorld()

    with pytest.raises(PolicyError, match="expected a policy with a method"):
        run(world, make_scenario(), policy=object())
    assert world.records == []


def test_paths_are_planned_by_the_push_map_in_the_file(tmp_path: Path) -> None:
    push_map = measured()
    twice = replace(push_map, effects=tuple(replace(each, turn_deg=2 * each.turn_deg) for each in push_map.effects))
    write_push_map(twice, tmp_path / "map.json")
    scenario = replace(scenario_at_station(), goal=Goal(pose=PoseDeg(x_m=6.3, y_m=3.0, yaw_deg=0.0)))
    radii = []
    for file in (None, tmp_path / "map.json"):
        world = FakeWorld(planner=make_plan)
        run(world, scenario, push_map=file)
        radii.append(world.box_queries()[0].sides[0].min_turning_radius_m)

    assert radii[1] == pytest.approx(radii[0] / 2, rel=1e-3)


def test_a_push_map_of_another_box_is_refused_before_anything_moves(tmp_path: Path) -> None:
    write_push_map(measured(), tmp_path / "map.json")
    scenario, world = make_scenario(), FakeWorld()
    wide = replace(scenario, box=replace(scenario.box, size_m=(0.4, 0.9, 0.4)))

    with pytest.raises(ConfigError, match="expected the push map of a cuboid of"):
        run(world, wide, push_map=tmp_path / "map.json")
    assert world.records == []
