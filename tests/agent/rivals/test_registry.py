"""Every rival pushes as its task allows, sees a mirror image as one, and stops where an episode of the task ends."""

from copy import deepcopy
from math import degrees

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.evaluation.episodes import run_episode
from agent_proc.frames.push_view import PushView, push_view
from agent_proc.rivals.registry import RIVALS, Rival, make_rival
from agent_proc.rivals.search import SearchPolicy
from agent_proc.studies.cell_parts import new_simulator
from agent_proc.task.config import TaskConfig
from agent_proc.task.drawn import drawn_scenario
from agent_proc.task.file import load_task
from legpush.errors import ConfigError, MotionError
from legpush.geometry import Pose2
from legpush.lockstep.local import LocalWorld
from legpush.messages.stepping import Motion, Outcome, Push, Reset
from legpush.scene.scenario import PoseDeg, Scenario
from tests.agent.fake_world import make_state

LEVEL = load_task("push-l1")
SIGHTED: tuple[Rival, ...] = ("bang_bang", "script", "script_over_map", "look_ahead", "search")
OTHER = {"FL": "FR", "FR": "FL"}
OPPOSITE = {"rear": "rear", "front": "front", "left": "right", "right": "left"}


def level_scenario(seed: int) -> Scenario:
    drawn = drawn_scenario(LEVEL.domain, LEVEL.scenario, np.random.default_rng(seed))
    return replace(drawn, mission=replace(drawn.mission, max_push_cycles=LEVEL.max_steps))


def view_of(task: TaskConfig, scenario: Scenario) -> PushView:
    world = LocalWorld(new_simulator("map"))
    return push_view(world.step(Reset(scenario=scenario, seed=1)).world, scenario)


@pytest.mark.parametrize("task", ["tuned", "paper-learns", "push-l1"])
@pytest.mark.parametrize("name", [name for name in RIVALS if name not in ("constant", "look_ahead_by_physics")])
def test_every_rival_pushes_as_its_task_allows(name: Rival, task: str) -> None:
    config = load_task(task)
    if name == "search" and not config.changes_face:
        with pytest.raises(ConfigError, match="Expected a task with `changes_face` for the rival search"):
            make_rival(name, config)
        return

    if name in ("script", "script_over_map", "dynamic_programming") and config.entry == "fixed":
        with pytest.raises(ConfigError, match=f"Expected a task with variable entry for the rival {name}"):
            make_rival(name, config)
        return

    push = make_rival(name, config).decide(view_of(config, config.scenario))

    assert push is not None
    assert config.changes_face or push.face == "rear"
    if config.entry == "fixed":
        assert push.depth_m == config.fixed_depth_m
    assert 0.0 < push.depth_m <= config.max_depth_m


@pytest.mark.parametrize("name", SIGHTED)
def test_a_sighted_rival_chooses_the_mirror_image_in_a_mirror_image(name: Rival) -> None:
    rival = make_rival(name, LEVEL)
    pushes = []
    for sign in (1.0, -1.0):
        goal = PoseDeg(x_m=6.8, y_m=6.0 + sign * 0.5, yaw_deg=sign * 50.0)
        scenario = replace(LEVEL.scenario, goal=replace(LEVEL.scenario.goal, pose=goal))
        push = rival.decide(view_of(LEVEL, scenario))
        assert push is not None
        pushes.append(push)

    left, right = pushes
    assert right.leg == OTHER[left.leg]
    assert right.face == OPPOSITE[left.face]
    assert right.depth_m == pytest.approx(left.depth_m, abs=1e-6)


@pytest.mark.parametrize("name", RIVALS)
def test_a_rival_has_nothing_to_do_at_the_goal(name: Rival) -> None:
    goal = LEVEL.scenario.goal.pose
    state = make_state(Pose2(x_m=goal.x_m - 0.6, y_m=goal.y_m, yaw_rad=0.0), goal.pose())

    assert make_rival(name, LEVEL, (0.0,) * 5).decide(push_view(state, LEVEL.scenario)) is None


@pytest.mark.parametrize("name", ["script", "script_over_map", "dynamic_programming", "search"])
def test_a_rival_that_plans_brings_boxes_to_goals_at_any_side(name: Rival) -> None:
    world, rival = LocalWorld(new_simulator("map")), make_rival(name, LEVEL)

    rows = [run_episode(world, level_scenario(seed), seed, rival) for seed in range(4)]

    assert sum(row.success for row in rows) >= 3
    assert all(row.ending in ("done", "max_cycles") for row in rows)


def test_looking_ahead_is_enough_where_the_goal_is_ahead() -> None:
    task = load_task("tuned")
    world, rival = LocalWorld(new_simulator("map")), make_rival("look_ahead", task)

    rows = [run_episode(world, task.scenario, seed, rival) for seed in range(4)]

    assert all(row.success and row.position_error_m < 0.006 for row in rows)


def test_what_sees_nothing_fails_there() -> None:
    world = LocalWorld(new_simulator("map"))
    for name in ("zero", "alternate"):
        rival = make_rival(name, LEVEL)
        assert not any(run_episode(world, level_scenario(seed), seed, rival).success for seed in range(4))


def test_legs_in_turn_follow_the_last_push() -> None:
    task = load_task("tuned")
    world, rival = LocalWorld(new_simulator("map")), make_rival("alternate", task)
    outcome, legs = world.step(Reset(scenario=task.scenario, seed=0)), []
    for _ in range(4):
        push = rival.decide(push_view(outcome.world, task.scenario))
        assert push is not None
        legs.append(push.leg)
        outcome = world.step(push)
    assert legs == ["FL", "FR", "FL", "FR"]


def test_the_search_finds_the_shortest_way_straight_ahead() -> None:
    scenario = LEVEL.scenario
    state = make_state(scenario.start.pose(), scenario.box.pose.pose())
    push = SearchPolicy(LEVEL).decide(push_view(state, scenario))
    assert isinstance(push, Push)
    assert push.face == "rear"
    assert degrees(abs(push_view(state, scenario).steering_error_rad)) < 1.0


def test_the_oracle_looks_ahead_in_copies_and_leaves_the_world_as_it_is() -> None:
    task = load_task("tuned")
    world, apart = (LocalWorld(new_simulator("mujoco")) for _ in range(2))
    outcome = world.step(Reset(scenario=task.scenario, seed=0))
    apart.step(Reset(scenario=task.scenario, seed=0))
    rival = make_rival("look_ahead_by_physics", task, fork=lambda of: (of or world).fork())

    push = rival.decide(push_view(outcome.world, task.scenario))

    assert push is not None
    assert world.step(push) == apart.step(push)


class _RefusesFL(LocalWorld):
    """A world in which the legs can follow no push with FL."""

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        if isinstance(motion, Push) and motion.leg == "FL":
            raise MotionError("Expected a push that the legs can follow")
        return super().step(motion, with_trace=with_trace)

    def fork(self) -> "_RefusesFL":
        return _RefusesFL(deepcopy(self._simulator))


def test_the_oracle_leaves_out_pushes_that_are_refused() -> None:
    task = load_task("tuned")
    world = _RefusesFL(new_simulator("map"))
    chosen = []
    for seed in range(3):
        outcome = world.step(Reset(scenario=task.scenario, seed=seed))
        rival = make_rival("look_ahead_by_physics", task, fork=lambda of: (of or world).fork())
        chosen.append(rival.decide(push_view(outcome.world, task.scenario)))

    assert [push.leg for push in chosen if push is not None] == ["FR"] * 3


def test_the_oracle_needs_a_world_that_can_be_copied() -> None:
    task = load_task("tuned")
    with pytest.raises(ConfigError, match="Expected a world in this process for the rival look_ahead_by_physics"):
        make_rival("look_ahead_by_physics", task).decide(view_of(task, task.scenario))
