"""Worlds in the process of a command, and which ones there are."""

import threading
from pathlib import Path

import pytest

from agent_proc.map_world.response_map import write_response_map
from agent_proc.simulators import local_worlds, simulators, unknown_in
from legpush.errors import ConfigError, PluginError
from legpush.messages.stepping import Outcome, Push, Reset
from legpush.options.learning import EvaluateOptions, SimulatorOptions
from legpush.scenarios.file import load_scenario
from tests.agent.map_world.fake_maps import known_map

RESET = Reset(scenario=load_scenario("push"), seed=1)
PUSH = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)


def pushed(world: str, folder: Path) -> list[Outcome]:
    """The last outcome in each of two worlds."""
    options = SimulatorOptions(world=world, simulators=2)
    with simulators(options, folder, threading.Event(), kind="test") as worlds:
        for each in worlds:
            each.step(RESET)
        return [each.step(PUSH) for each in worlds]


def test_a_plug_in_and_the_file_of_a_map_are_stepped_in_this_process(tmp_path: Path) -> None:
    write_response_map(known_map(), tmp_path / "map.json")

    first, second = pushed("map", tmp_path)
    assert first == second
    ends = {world: pushed(world, tmp_path)[0].state_crc for world in ("map", "map_mean", f"{tmp_path}/map.json")}
    assert len(set(ends.values())) == 3
    assert [path.name for path in tmp_path.iterdir()] == ["map.json"]


def test_a_world_that_there_is_not_is_refused(tmp_path: Path) -> None:
    assert unknown_in("mujoco", ()) is None
    assert unknown_in("map_mean", ()) is None
    with pytest.raises(PluginError, match=r"Expected a simulator \(map, map_mean, map_unknown, mujoco\), got 'magic'"):
        unknown_in("magic", ())
    with pytest.raises(ConfigError, match=r"none\.json: expected a map that"):
        unknown_in(f"{tmp_path}/none.json", ())
    assert len(local_worlds(3, "map")) == 3


@pytest.mark.parametrize("more", [{"join": "run"}, {"record": Path("new.mcap")}])
def test_only_simulators_are_joined_or_recorded(more: dict[str, object]) -> None:
    with pytest.raises(ConfigError, match="Expected --world mujoco with --join and --record: map is no process"):
        EvaluateOptions(policy="scripted", world="map", **more)  # type: ignore[arg-type]
