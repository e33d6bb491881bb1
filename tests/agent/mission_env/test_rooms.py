"""The missions of an environment: drawn from their seeds, in rooms that bound the observation."""

import numpy as np
import pytest
from msgspec import UNSET
from msgspec.structs import replace

from agent_proc.mission_env.rooms import draw_mission, require_bounds
from agent_proc.task.domain import Domain
from agent_proc.task.file import load_task
from legpush.errors import ConfigError
from legpush.scenarios.random_room import RandomRoom
from legpush.scenarios.random_scenario import random_scenario
from tests.agent.fake_world import FakeWorld, make_scenario

LEVEL = load_task("push-l4")


def test_a_room_is_the_one_that_the_command_draws_for_the_seed_and_this_box() -> None:
    drawn = [draw_mission(LEVEL, seed, FakeWorld()) for seed in (3, 3, 4)]

    box = drawn[0].box
    assert drawn[0] == random_scenario(RandomRoom(mass_kg=box.mass_kg, friction=box.friction), 3, lambda _: True)
    assert drawn[0] == drawn[1] != drawn[2]
    assert box.mass_kg != drawn[2].box.mass_kg


def test_masses_and_frictions_are_those_of_the_domain_and_do_not_depend_on_the_room() -> None:
    drawn = [draw_mission(LEVEL, seed, FakeWorld()) for seed in range(40)]
    masses = np.array([each.box.mass_kg for each in drawn])
    sides = np.array([each.room.obstacles[0].x_max_m - each.room.obstacles[0].x_min_m for each in drawn])

    assert 0.1 <= masses.min() < 1.0 < 4.0 < masses.max() <= 5.0
    assert all(0.3 <= each.box.friction <= 0.8 for each in drawn)
    assert abs(np.corrcoef(masses, sides)[0, 1]) < 0.5


def test_without_a_random_room_missions_are_in_the_scenario_of_the_task() -> None:
    task = replace(LEVEL, random_room=UNSET, domain=Domain(mass_kg=(2.0, 2.0)), scenario=make_scenario())
    drawn = draw_mission(task, 3, FakeWorld())

    assert drawn == replace(task.scenario, box=replace(task.scenario.box, mass_kg=2.0))


def test_a_scenario_that_is_smaller_than_its_rooms_is_refused() -> None:
    require_bounds(LEVEL)
    with pytest.raises(ConfigError, match=r"as large as the random ones, 8 x 8 m, .* got one of 12 x 6 m"):
        require_bounds(replace(LEVEL, scenario=make_scenario()))
