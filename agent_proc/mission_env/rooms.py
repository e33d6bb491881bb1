"""Draws the missions of an environment: a room, or the scenario of the task."""

from dataclasses import replace
from typing import Final

import numpy as np
from msgspec import UNSET

from agent_proc.pushing.solvable import solvable_by
from agent_proc.task.config import TaskConfig
from agent_proc.task.drawn import drawn_scenario
from agent_proc.task.rooms import DRAWN, room_of
from legpush.errors import ConfigError
from legpush.lockstep.world import World
from legpush.messages.planning import Plan, PlanQuery
from legpush.scenarios.random_scenario import random_scenario
from legpush.scene.scenario import Scenario

N_DIGITS: Final = 2
"""Mass and friction of a drawn box are rounded to these decimals, so that a command line can repeat them."""


def draw_mission(task: TaskConfig, seed: int, world: World) -> Scenario:
    """Return the scenario of the mission with this seed, in whose room the planner of `world` finds a way.

    With a random room, it is the one that `legpush scenarios random` draws for the seed, for a box whose mass and
    friction the seed draws from the domain of the task.

    Raises:
        ConfigError: No solvable room was found.
    """
    # The room is drawn from the seed alone: other draws that begin with the same numbers would depend on it.
    drawn = drawn_scenario(task.domain, task.scenario, np.random.default_rng([seed, 1]))
    if task.random_room is UNSET:
        return drawn
    box = {name: round(getattr(drawn.box, name), N_DIGITS) for name in DRAWN if getattr(task.domain, name) is not None}
    room = replace(room_of(task.random_room), **box)

    def first_plan(query: PlanQuery) -> Plan:
        plan = world.plan(query)
        world.cancel_plan()
        return plan

    return random_scenario(room, seed, solvable_by(first_plan, seed))


def require_bounds(task: TaskConfig) -> None:
    """Require that the room of the scenario, which bounds the observation, is as large as those that are drawn.

    Raises:
        ConfigError: It is smaller.
    """
    if task.random_room is UNSET:
        return
    has, wants = task.scenario.room.size_m, task.random_room.size_m
    if has[0] < wants[0] or has[1] < wants[1]:
        raise ConfigError(
            f"Expected a scenario whose room is as large as the random ones, {wants[0]:g} x {wants[1]:g} m, since it "
            f"bounds the observation, got one of {has[0]:g} x {has[1]:g} m"
        )
