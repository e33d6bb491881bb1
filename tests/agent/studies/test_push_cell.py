from dataclasses import asdict

import pytest

from agent_proc.evaluation.episodes import run_episode
from agent_proc.policies.registry import make_policy
from agent_proc.studies.push_cell import PUSH, PushCell, resolve
from legpush.errors import ConfigError
from legpush.lockstep.local import LocalWorld
from legpush.study.cells import columns_of
from sim_proc.simulator import Simulator


def test_an_episode_runs_in_the_world_that_the_cell_names() -> None:
    columns = {
        world: columns_of(PUSH, resolve(PushCell(seed=5, policy="scripted", world=world), ()))
        for world in ("map", "map_mean")
    }

    assert {each["ending"] for each in columns.values()} == {"done"}
    assert columns["map"]["state_crc"] != columns["map_mean"]["state_crc"]
    with pytest.raises(ConfigError, match="Expected a world among map, map_mean, mujoco, got 'magic'"):
        resolve(PushCell(world="magic"), ())


def test_a_cell_is_an_episode_with_the_crc_of_its_last_state() -> None:
    resolved = resolve(PushCell(seed=5, policy="scripted", changes={"mission.max_push_cycles": 2}), ())
    columns = columns_of(PUSH, resolved)
    simulator = Simulator()
    row = asdict(run_episode(LocalWorld(simulator), resolved.scenario, 5, make_policy("scripted")))
    assert simulator.episode is not None
    assert columns == {
        **{name: value for name, value in row.items() if name not in ("case", "seed")},
        "state_crc": f"{simulator.episode.physics.state_crc():08x}",
    }
    assert columns["n_cycles"] == 2
    assert list(columns) == [column.name for column in PUSH.columns]
