"""The environment: what Gymnasium, Stable-Baselines3 and dm_control ask of one, and how episodes end."""

import warnings
from collections.abc import Iterator

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from numpy.typing import NDArray
from stable_baselines3.common.env_checker import check_env as check_env_sb3

from agent_proc.gym_envs import PUSH_ID
from agent_proc.learning.env import PushEnv
from agent_proc.task.action import to_push
from agent_proc.task.config import TaskConfig
from agent_proc.task.domain import Domain
from agent_proc.task.elements import observation_elements
from agent_proc.task.episode import has_arrived
from agent_proc.task.observed import observe
from legpush.errors import ConfigError, PeerError
from legpush.lockstep.local import LocalWorld
from legpush.messages.stepping import Motion, Outcome, Push, Reset
from sim_proc.simulator import Simulator
from tests.agent.fake_world import FakeWorld, scenario_at_station
from tests.agent.tasks import paper, tuned

TASKS = {
    "variable": tuned(),
    "fixed": tuned(entry="fixed"),
    "published": paper(entry="fixed", action_form="discrete", domain=Domain()),
}
ALWAYS_LEFT = np.array([0.0, 0.0, -1.0, 1.0], dtype=np.float32)
N_STEPS = 12
Step = tuple[NDArray[np.float32], float, bool, bool]


@pytest.fixture(params=list(TASKS.values()), ids=list(TASKS))
def env(request: pytest.FixtureRequest) -> PushEnv:
    """With a simulator in this process."""
    return PushEnv(request.param, LocalWorld(Simulator()))


def fake(task: TaskConfig | None = None, **fields: object) -> PushEnv:
    """Without physics: FL turns the box clockwise, FR mirrored."""
    return PushEnv(task or tuned(scenario=scenario_at_station()), FakeWorld(**fields))  # type: ignore[arg-type]


def names_of(env: PushEnv) -> list[str]:
    """The names of the elements of the observation."""
    return [element.name for element in observation_elements(env.task)]


def steering(observation: NDArray[np.float32]) -> NDArray[np.float32]:
    """Push towards the line: elements 0, 1 and 4 are place and heading of the box in the goal frame."""
    turn = np.arctan2(-observation[1], 0.25) - observation[4]
    depth = min(1.0, 0.3 + 3.0 * abs(turn)) if observation[0] < -0.15 else 0.2
    return np.array([0.0, 0.0, np.sign(turn) or 1.0, depth], dtype=np.float32)


def rollout(env: PushEnv, seed: int, n_steps: int = N_STEPS) -> Iterator[Step]:
    """Random actions."""
    env.action_space.seed(seed)
    observation, _ = env.reset(seed=seed)
    yield observation, 0.0, False, False
    for _ in range(n_steps):
        observation, reward, terminated, truncated, _ = env.step(env.action_space.sample())
        yield observation, reward, terminated, truncated
        if terminated or truncated:
            observation, _ = env.reset()


def test_the_checkers_of_gymnasium_and_stable_baselines_pass_without_a_warning(env: PushEnv) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Gymnasium warns of every environment that was not made by `make`, and may not be of one that was.
        warnings.filterwarnings("ignore", message=".*(gymnasium.make|env.spec|Not able to test).*")
        check_env(env, skip_render_check=True)
        check_env_sb3(env)


def test_it_is_registered_under_a_versioned_name() -> None:
    made = gymnasium.make(PUSH_ID, task=TASKS["fixed"], world=FakeWorld())

    assert isinstance(made.unwrapped, PushEnv)
    assert made.unwrapped.task == TASKS["fixed"]
    assert made.reset(seed=1)[0] in made.observation_space


def test_everything_it_says_is_finite_and_in_its_space_and_has_a_name(env: PushEnv) -> None:
    steps = list(rollout(env, seed=5))

    assert len(steps) == N_STEPS + 1
    for observation, reward, _, _ in steps:
        assert observation in env.observation_space
        assert np.isfinite(reward)
    names = names_of(env)
    assert len(names) == len(set(names)) == len(steps[0][0])


def test_equal_seeds_give_equal_trajectories_and_other_seeds_others(env: PushEnv) -> None:
    first, again, other = (list(rollout(env, seed)) for seed in (5, 5, 6))

    for (a, *rest_a), (b, *rest_b) in zip(first, again, strict=True):
        np.testing.assert_array_equal(a, b)
        assert rest_a == rest_b
    assert (first[0][0] != other[0][0]).any()


def test_observations_share_no_memory(env: PushEnv) -> None:
    observations = [step[0] for step in rollout(env, seed=5, n_steps=3)]

    assert not any(np.shares_memory(a, b) for i, a in enumerate(observations) for b in observations[:i])


def test_no_element_of_the_observation_is_constant_but_the_goal(env: PushEnv) -> None:
    observations = np.stack([step[0] for step in rollout(env, seed=5)])

    constant = (observations == observations[0]).all(axis=0)
    names = np.array(names_of(env))[constant]
    rests = (
        "box_corner_1.z",
        "box_corner_2.z",
        "box_corner_3.z",
        "box_corner_4.z",
    )  # heights of a box on the floor
    assert [name for name in names if not name.startswith("goal_corner") and name not in rests] == []


def test_starts_are_drawn_anew_for_every_episode_and_a_reset_is_possible_at_any_time(env: PushEnv) -> None:
    starts = [env.reset(seed=1)[0], env.reset()[0]]
    env.step(env.action_space.sample())
    starts.append(env.reset()[0])

    assert len({start.tobytes() for start in starts}) == 3


def test_the_terms_of_the_reward_sum_to_it(env: PushEnv) -> None:
    env.action_space.seed(0)
    env.reset(seed=0)
    for _ in range(4):
        _, reward, _, _, info = env.step(env.action_space.sample())
        assert reward == sum(info["reward_terms"].values())
        assert any(term != 0.0 for term in info["reward_terms"].values())


def test_the_options_say_which_episode_it_is() -> None:
    env = PushEnv(tuned(), LocalWorld(Simulator()))
    heavy = tuned(domain=Domain(mass_kg=(5.0, 5.0))).scenario
    first, info = env.reset(seed=0, options={"scenario_seed": 7})
    again, _ = env.reset(seed=1, options={"scenario_seed": 7, "scenario": heavy})

    assert info["scenario_seed"] == 7
    np.testing.assert_array_equal(first, again)
    with pytest.raises(ConfigError, match="scenario_seed"):
        env.reset(options={"scenari": heavy})


class Recorder(FakeWorld):
    """Keeps the scenarios that it is reset to."""

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        if isinstance(motion, Reset):
            self.told.append((str(motion.scenario.box.mass_kg), None, str(motion.scenario.box.friction)))
        return super().step(motion, with_trace=with_trace)


def test_a_domain_is_drawn_anew_for_every_episode_within_its_interval() -> None:
    world = Recorder()
    env = PushEnv(tuned(domain=Domain(mass_kg=(0.1, 0.9))), world)
    env.reset(seed=3)
    env.reset()

    masses = {float(mass) for mass, _, _ in world.told}
    assert len(masses) == 2
    assert all(0.1 <= mass <= 0.9 for mass in masses)
    assert {friction for _, _, friction in world.told} == {"0.5"}


def test_the_distance_to_the_goal_is_drawn_along_the_way_that_the_scenario_has() -> None:
    env = PushEnv(tuned(domain=Domain(distance_m=(0.1, 0.8)), scenario=scenario_at_station()), FakeWorld())
    nominal = env.task.scenario
    drawn = []
    for seed in range(40):
        env.reset(seed=seed)
        goal, box = env.view.goal.pose, nominal.box.pose
        assert (goal.y_m, goal.yaw_deg) == (nominal.goal.pose.y_m, nominal.goal.pose.yaw_deg)
        drawn.append(goal.x_m - box.x_m)

    assert 0.1 <= min(drawn) < 0.2
    assert 0.5 < max(drawn) <= 0.8
    assert sum(distance_m < 0.28 for distance_m in drawn) == pytest.approx(20, abs=8)  # Half of the octaves.


def test_steering_by_the_observation_ends_in_success() -> None:
    env = fake(box_offset=(0.02, 0.04, -0.05))
    observation, info = env.reset(seed=0)
    terminated = False
    while not terminated:
        observation, _, terminated, truncated, info = env.step(steering(observation))
        assert not truncated
    assert (info["ending"], info["is_success"]) == ("success", True)
    assert info["position_error_m"] < 0.03
    assert info["reward_terms"]["success"] > 0.0
    assert has_arrived(env.task, env.view)
    with pytest.raises(ConfigError, match="reset before this step"):
        env.step(steering(observation))


def test_turning_the_box_away_ends_the_episode_where_the_errors_outgrow_those_of_the_start() -> None:
    env = fake(box_offset=(0.0, -0.01, 0.0))
    env.reset(seed=0)
    endings = [env.step(np.array([0.0, 0.0, 1.0, 1.0], dtype=np.float32)) for _ in range(3)]
    while not (endings[-1][2] or endings[-1][3]):
        endings.append(env.step(np.array([0.0, 0.0, 1.0, 1.0], dtype=np.float32)))

    *_, terminated, truncated, info = endings[-1]
    assert (terminated, truncated, info["ending"], info["is_success"]) == (True, False, "astray", False)


def test_a_fall_terminates_and_takes_all_progress_back() -> None:
    env = fake(falls_in=lambda motion, n: isinstance(motion, Push) and n == 4)
    observation, _ = env.reset(seed=0)
    rewards = []
    terminated = False
    while not terminated:
        observation, reward, terminated, _, info = env.step(steering(observation))
        rewards.append(reward)
    assert (info["ending"], info["fell"], len(rewards)) == ("fell", True, 4)
    assert sum(rewards) == pytest.approx(-20.0 - 4 * 0.02)


def test_the_number_of_steps_truncates_and_does_not_terminate() -> None:
    env = fake(tuned(scenario=scenario_at_station(), max_steps=3))
    observation, _ = env.reset(seed=0)
    ends = []
    for _ in range(3):
        observation, _, terminated, truncated, info = env.step(steering(observation))
        ends.append((terminated, truncated))
    assert ends == [(False, False), (False, False), (False, True)]
    assert info["ending"] == "max_steps"


def test_the_published_profile_ends_within_the_tolerances_and_nowhere_else_before_its_last_step() -> None:
    text = paper()
    task = tuned(scenario=scenario_at_station(), entry="fixed", reward=text.reward, ending=text.ending, max_steps=40)
    env = fake(task, box_offset=(0.0, 0.03, 0.05))
    observation, _ = env.reset(seed=0)
    for _ in range(40):
        observation, reward, terminated, truncated, info = env.step(steering(observation)[:3])
        assert reward < 0.0
        if terminated or truncated:
            break
        assert info["position_error_m"] > 0.03 or info["angle_error_deg"] > 3.0
    assert (terminated, info["ending"]) == (True, "success")
    assert info["position_error_m"] <= 0.03
    assert info["angle_error_deg"] <= 3.0


def test_a_policy_outside_the_environment_sees_and_does_the_same() -> None:
    env = fake(box_offset=(0.0, -0.03, 0.0))
    observation, _ = env.reset(seed=0)

    np.testing.assert_array_equal(observe(env.task, env.view), observation)
    push = to_push(ALWAYS_LEFT, env.task, env.view)
    env.step(ALWAYS_LEFT)
    assert env.snapshot().pushes == (push,)


def test_before_the_first_reset_there_is_nothing_to_see() -> None:
    with pytest.raises(ConfigError, match="reset first"):
        assert fake().view


def test_a_restored_episode_goes_on_bit_for_bit() -> None:
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (8, 4)).astype(np.float32)
    env, other = (PushEnv(tuned(), LocalWorld(Simulator())) for _ in range(2))
    env.reset(seed=2)
    for action in actions[:4]:
        here, *_ = env.step(action)

    np.testing.assert_array_equal(other.restore(env.snapshot()), here)
    for action in actions[4:]:
        a, b = env.step(action), other.step(action)
        np.testing.assert_array_equal(a[0], b[0])
        assert a[1:] == b[1:]
    np.testing.assert_array_equal(env.reset()[0], other.reset()[0])


def test_an_episode_that_computes_something_else_is_not_restored() -> None:
    env = fake()
    observation, _ = env.reset(seed=0)
    env.step(steering(observation))

    with pytest.raises(PeerError, match=r"after 1 pushes .* computes something else"):
        fake(push_scale=1.1).restore(env.snapshot())
