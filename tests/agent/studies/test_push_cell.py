from dataclasses import asdict
from importlib.resources import files
from pathlib import Path
from typing import Any

import msgspec
import pytest

from agent_proc.evaluation.episodes import run_episode
from agent_proc.policies.folder import policy_path
from agent_proc.policies.registry import make_policy
from agent_proc.studies.push_cell import PUSH, PushCell, resolve
from legpush.errors import ConfigError
from legpush.lockstep.local import LocalWorld
from legpush.scenarios.file import load_scenario
from legpush.study.cells import columns_of
from sim_proc.simulator import Simulator


def test_an_episode_runs_in_the_world_that_the_cell_names() -> None:
    columns = {
        world: columns_of(PUSH, resolve(PushCell(seed=5, policy="scripted", world=world), ()))
        for world in ("map", "map_mean")
    }

    assert {each["ending"] for each in columns.values()} == {"done"}
    assert columns["map"]["state_crc"] != columns["map_mean"]["state_crc"]
    with pytest.raises(ConfigError, match="Expected a world among map, map_mean, map_unknown, mujoco, got 'magic'"):
        resolve(PushCell(world="magic"), ())


def test_a_cell_is_an_episode_with_the_crc_of_its_last_state() -> None:
    resolved = resolve(PushCell(seed=5, policy="scripted", changes={"mission.max_push_cycles": 2}), ())
    columns = columns_of(PUSH, resolved)
    simulator = Simulator()
    row = asdict(run_episode(LocalWorld(simulator), resolved.scenario, 5, make_policy("scripted")))
    assert simulator.episode is not None
    assert columns.pop("decision_cpu_s") > 0.0
    assert columns == {
        **{name: value for name, value in row.items() if name not in ("case", "seed")},
        "simulated_s": pytest.approx(simulator.episode.physics.tick * 0.02),
        "state_crc": f"{simulator.episode.physics.state_crc():08x}",
    }
    assert columns["n_cycles"] == 2
    assert list(columns) == [column.name for column in PUSH.columns if column.name != "decision_cpu_s"]


def test_each_seed_draws_its_own_start_from_the_domain_of_a_task(tmp_path: Path) -> None:
    task = tmp_path / "wide.toml"
    tuned = (files("agent_proc.task") / "builtin" / "tuned.toml").read_text()
    more = "[tolerance]\nposition_m = 0.01\n[domain]\ndistance_m = [0.3, 2.0]\ngoal_yaw_deg = [-20, 20]\n"
    task.write_text(f"{tuned}\n{more}")
    cells = [PushCell(seed=seed, policy="scripted", world="map", domain=str(task)) for seed in (1, 1, 2)]
    first, again, other = (resolve(cell, ()).scenario for cell in cells)

    assert first == again
    assert first.goal.pose != other.goal.pose
    assert first.goal.position_tolerance_m == 0.01
    assert abs(first.goal.pose.yaw_deg) <= 20
    assert first.goal.pose.yaw_deg != 0
    assert resolve(PushCell(seed=1), ()).scenario.goal == load_scenario("push").goal


def test_a_rival_has_the_actions_and_the_stop_rule_of_a_task() -> None:
    def columns(**fields: Any) -> dict[str, Any]:
        return columns_of(PUSH, resolve(PushCell(seed=5, world="map", **fields), ()))

    zero = columns(policy="zero", task="paper-learns")
    assert zero["state_crc"] == columns(policy="constant", action=(0.0, 0.0, 0.0), task="paper-learns")["state_crc"]
    assert columns(policy="random", task=str(policy_path("variable")))["n_cycles"] > 0
    with pytest.raises(ConfigError, match=r"Expected an action of 4 numbers, as the task has, got \[0\.0\]"):
        resolve(PushCell(policy="constant", action=(0.0,)), ())
    with pytest.raises(ConfigError, match="Expected an action with the policy `constant` alone, got one with scripted"):
        resolve(PushCell(policy="scripted", action=(0.0,)), ())
    resolved = resolve(PushCell(policy="constant", action=(0.0, 0.5, -1.0, 1.0)), ())
    assert msgspec.convert(msgspec.to_builtins(resolved), PUSH.resolved) == resolved
