"""The environment of missions: what checkers ask of one, and that it is the mission that runs by itself."""

import threading
import warnings
from typing import Any

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from msgspec import UNSET
from msgspec.structs import replace
from numpy.typing import NDArray
from stable_baselines3.common.env_checker import check_env as check_env_sb3

import legpush
from agent_proc.frames.push_view import PushView
from agent_proc.mission.mission import run_mission
from agent_proc.mission_env.env import MissionEnv
from agent_proc.mission_env.make_env import make_mission_env
from agent_proc.task.action import to_push
from agent_proc.task.config import TaskConfig
from agent_proc.task.domain import Domain
from agent_proc.task.episode import has_arrived
from agent_proc.task.file import load_task
from agent_proc.task.observed import observe
from legpush.errors import BrokenEpisodeError, ConfigError
from legpush.messages.stepping import Follow, Motion, Outcome, Push
from legpush.scene.scenario import Box, PoseDeg, Scenario
from tests.agent.fake_world import FakeWorld, make_scenario, scenario_at_station

LEVEL = load_task("push-l4")


def level(scenario: Scenario | None = None, **changes: Any) -> TaskConfig:
    """Level 4 in one scenario."""
    fields = {"scenario": scenario or make_scenario(), "random_room": UNSET, "domain": Domain(), **changes}
    return replace(LEVEL, **fields)


def steering(observation: NDArray[np.float32]) -> NDArray[np.float32]:
    """Push towards the line: elements 0, 1 and 4 are place and heading of the box in the frame of its target."""
    turn = np.arctan2(-observation[1], 0.25) - observation[4]
    depth = min(1.0, 0.3 + 3.0 * abs(turn)) if observation[0] < -0.15 else 0.2
    return np.array([0.0, 0.0, np.sign(turn) or 1.0, depth], dtype=np.float32)


class Steering:
    """The same as the policy of a mission."""

    def decide(self, view: PushView) -> Push | None:
        return None if has_arrived(LEVEL, view) else to_push(steering(observe(LEVEL, view)), LEVEL, view)


def drive(env: MissionEnv, observation: NDArray[np.float32]) -> list[tuple[float, bool, bool, dict[str, Any]]]:
    """The steps of an episode, to its end."""
    steps: list[tuple[float, bool, bool, dict[str, Any]]] = []
    while not steps or not (steps[-1][1] or steps[-1][2]):
        observation, reward, terminated, truncated, info = env.step(steering(observation))
        assert observation in env.observation_space
        steps.append((reward, terminated, truncated, info))
    return steps


def thinking() -> list[str]:
    """The threads of missions."""
    return [thread.name for thread in threading.enumerate() if thread.name == "mission"]


@pytest.mark.parametrize("task", [level(), level(mirrored=False, entry="fixed")], ids=["level 4", "fixed entry"])
def test_the_checkers_of_gymnasium_and_stable_baselines_pass_without_a_warning(task: TaskConfig) -> None:
    env = MissionEnv(task, FakeWorld(box_offset=(0.0, 0.03, 0.02)))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Gymnasium warns of every environment that was not made by `make`, and may not be of one that was.
        warnings.filterwarnings("ignore", message=".*(gymnasium.make|env.spec|Not able to test).*")
        check_env(env, skip_render_check=True)
        check_env_sb3(env)
    env.close()
    assert thinking() == []


def test_a_mission_walks_by_itself_and_an_episode_ends_with_it() -> None:
    world = FakeWorld(box_offset=(0.04, -0.05, 0.07))
    env = MissionEnv(level(), world)
    observation, info = env.reset(seed=3)
    assert len(world.motions(Follow)) == 2
    assert world.motions(Push) == []
    steps = drive(env, observation)

    rewards, terminated, truncated, infos = zip(*steps, strict=True)
    assert (terminated[-1], truncated[-1], any(terminated[:-1])) == (True, False, False)
    assert (infos[-1]["ending"], infos[-1]["reason"], infos[-1]["is_success"]) == ("success", "success", True)
    for reward, each in zip(rewards, infos, strict=True):
        assert reward == sum(each["reward_terms"].values())
    nearer_m = info["position_error_m"] - infos[-1]["position_error_m"]
    progress = sum(each["reward_terms"]["progress"] for each in infos)
    assert progress == pytest.approx(LEVEL.reward["progress"]["weight"] * nearer_m)
    assert infos[-1]["reward_terms"]["success"] == LEVEL.reward["success"]["weight"]
    with pytest.raises(ConfigError, match="reset before this step"):
        env.step(steering(observation))


def test_it_is_the_mission_that_runs_by_itself_with_the_same_policy() -> None:
    here, there = (FakeWorld(box_offset=(0.04, -0.05, 0.07)) for _ in range(2))
    env = MissionEnv(level(), here)
    observation, info = env.reset(seed=3)
    steps = drive(env, observation)

    result = run_mission(there, make_scenario(), info["scenario_seed"], Steering())
    assert here.records == there.records
    assert (steps[-1][-1]["reason"], result.reason) == ("success", "success")


def test_with_physics_it_ends_in_the_state_of_legpush_run() -> None:
    changes = {"mission.max_push_cycles": 12}
    env = make_mission_env(scenario="push")
    scenario = replace(env.task.scenario, mission=replace(env.task.scenario.mission, max_push_cycles=12))
    crcs = []
    for _ in range(2):
        observation, _ = env.reset(options={"scenario": scenario, "scenario_seed": 5})
        steps = drive(env, observation)
        crcs.append(f"{env.state_crc:08x}")
    env.close()

    run = legpush.run("push", seed=5, policy=Steering(), changes=changes)
    assert crcs == [run.state_crc, run.state_crc]
    assert (steps[-1][-1]["reason"], steps[-1][-1]["ending"]) == (run.report.reason, "failed")
    assert run.report.n_push_cycles == 12


def test_a_reset_in_the_middle_abandons_the_mission() -> None:
    env = MissionEnv(level(), FakeWorld())
    first, _ = env.reset(seed=1)
    env.step(steering(first))
    again, _ = env.reset(seed=1)

    np.testing.assert_array_equal(first, again)
    assert thinking() == ["mission"]
    env.close()
    env.close()
    assert thinking() == []
    with pytest.raises(ConfigError, match="there is no episode"):
        env.step(steering(first))
    with pytest.raises(ConfigError, match="there is no episode"):
        _ = env.view


def test_the_number_of_steps_truncates_and_ends_the_mission() -> None:
    env = MissionEnv(level(max_steps=2), FakeWorld())
    observation, _ = env.reset(seed=1)
    steps = drive(env, observation)

    assert [step[1:3] for step in steps] == [(False, False), (False, True)]
    assert steps[-1][-1]["ending"] == "max_steps"
    assert "reason" not in steps[-1][-1]
    assert thinking() == []


def test_a_fall_ends_it_and_takes_the_progress_back() -> None:
    world = FakeWorld(falls_in=lambda motion, n: isinstance(motion, Push) and n == 4)
    env = MissionEnv(level(scenario_at_station()), world)
    observation, _ = env.reset(seed=0)
    steps = drive(env, observation)

    info = steps[-1][-1]
    assert (info["ending"], info["reason"], info["fell"], len(steps)) == ("fell", "fell", True, 4)
    assert sum(step[-1]["reward_terms"]["progress"] for step in steps) == pytest.approx(0.0)


class BreakingWorld(FakeWorld):
    """Fails in its third push."""

    def __init__(self, error: BaseException) -> None:
        super().__init__()
        self.error = error

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        if isinstance(motion, Push) and len(self.motions(Push)) == 2:
            raise self.error
        return super().step(motion, with_trace=with_trace)


@pytest.mark.parametrize("error", [BrokenEpisodeError("numbers"), KeyboardInterrupt(), RuntimeError("a fault")])
def test_an_error_and_an_interruption_end_the_episode_and_a_reset_begins_the_next(error: BaseException) -> None:
    env = MissionEnv(level(scenario_at_station()), BreakingWorld(error))
    observation, _ = env.reset(seed=0)
    with pytest.raises(type(error)):
        drive(env, observation)

    assert thinking() == []
    with pytest.raises(ConfigError, match="reset before this step"):
        env.step(steering(observation))
    assert env.reset(seed=0)[0] in env.observation_space
    env.close()


def test_an_action_that_is_none_leaves_the_mission_waiting() -> None:
    env = MissionEnv(level(scenario_at_station()), FakeWorld())
    observation, _ = env.reset(seed=0)
    with pytest.raises(ConfigError, match="Expected an action of 4"):
        env.step(np.zeros(3))

    assert drive(env, observation)[-1][-1]["is_success"]


def test_each_episode_is_a_mission_of_its_own_seed(monkeypatch: pytest.MonkeyPatch) -> None:
    def numbered(_task: TaskConfig, seed: int, _world: object) -> Scenario:
        return make_scenario(name=f"room-{seed}")

    monkeypatch.setattr("agent_proc.mission_env.env.draw_mission", numbered)
    env = MissionEnv(LEVEL, FakeWorld())
    _, info = env.reset(seed=4)
    first = env.scenario.name
    _, other = env.reset()
    env.reset(options={"scenario_seed": info["scenario_seed"]})

    assert env.scenario.name == first == f"room-{info['scenario_seed']}"
    assert other["scenario_seed"] != info["scenario_seed"]
    env.close()


def test_a_room_that_is_drawn_and_planned_is_repeated_by_its_seed() -> None:
    room = {"size_m": [6.0, 6.0], "obstacles": 0}
    env = make_mission_env(simulator="map", random_room=room, mass_kg=[0.1, 0.1], friction=[0.5, 0.5])
    first, info = env.reset(seed=1)
    drawn, ends = env.scenario, [(drive(env, first)[-1][-1]["reason"], env.state_crc)]
    again, _ = env.reset(seed=9, options={"scenario_seed": info["scenario_seed"]})
    ends.append((drive(env, again)[-1][-1]["reason"], env.state_crc))

    assert env.scenario == drawn
    assert drawn.name == f"random-{info['scenario_seed']}"
    np.testing.assert_array_equal(first, again)
    assert ends[0] == ends[1]
    env.close()


def test_a_mission_that_asks_for_no_push_is_refused_and_the_next_is_drawn() -> None:
    heavy = make_scenario(box=Box(pose=PoseDeg(x_m=6.0, y_m=3.0, yaw_deg=0.0), mass_kg=500.0))
    env = MissionEnv(level(), FakeWorld())
    with pytest.raises(ConfigError, match=r"asks for a push, got fake with the seed 5, which ended before: too_heavy"):
        env.reset(options={"scenario": heavy, "scenario_seed": 5})
    with pytest.raises(ConfigError, match="which ended before: too_heavy"):
        MissionEnv(level(heavy), FakeWorld()).reset(seed=0)
    assert thinking() == []
    with pytest.raises(ConfigError, match="scenario_seed"):
        env.reset(options={"scenari": heavy})


def test_what_a_mission_decides_is_no_part_of_an_action() -> None:
    with pytest.raises(ConfigError, match="changes_face = false"):
        MissionEnv(load_task("push-l1"), FakeWorld())
