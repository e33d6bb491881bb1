"""How the policies of a training are built, evaluated and ranked."""

import threading
from pathlib import Path

import msgspec
import pytest

from agent_proc.evaluation.starts import FIRST_CHECK_SEED
from agent_proc.learning.best_policy import build_policy, check_policy, is_better
from agent_proc.learning.learner import make_learner
from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.learning.vec_env import PushVecEnv
from agent_proc.policies.card import Check, CurvePoint
from agent_proc.policies.folder import PolicyFolder, read_policy, write_policy
from agent_proc.policies.learned import LearnedPolicy
from agent_proc.policies.reach import Reach
from agent_proc.policies.weights_file import encode_weights
from agent_proc.profiles.profile import AnyProfile
from agent_proc.task.file import load_task
from legpush.errors import StopRequestedError
from tests.agent.fake_world import FakeWorld, scenario_at_station
from tests.agent.learning.small_training import small_profile

CHECK = Check(step=64, seeds=(1, 2), success_rate=0.5, position_error_m=0.02, angle_error_deg=1.5, falls=0, cycles=20.0)
POINT = CurvePoint(step=3, episode_return=-1.5, length=3, success=False, position_error_m=0.4, angle_error_deg=9.0)
REACH = Reach(beside_m=3.0, turned_deg=180.0)
SCENARIO = scenario_at_station()


def built(profile: AnyProfile, check: Check | None = None) -> PolicyFolder:
    """The policy of a learner that has not learned yet."""
    task = load_task(profile.task, SCENARIO)
    plan = TrainingPlan(
        profile=profile, task=task, seed=7, n_simulators=1, command="legpush train", versions={"numpy": "1"}
    )
    env = PushVecEnv(task, [FakeWorld()])
    try:
        return build_policy(plan, make_learner(profile, env, plan.seed), [POINT], REACH, check)
    finally:
        env.close()


@pytest.mark.parametrize(
    "worse",
    [
        {"falls": 1, "success_rate": 1.0},
        {"success_rate": 0.4, "position_error_m": 0.001},
        {"position_error_m": 0.021},
        {"angle_error_deg": 1.6},
    ],
    ids=["falls", "fails", "position", "angle"],
)
def test_falls_count_before_success_and_success_before_errors(worse: dict[str, float]) -> None:
    other = msgspec.structs.replace(CHECK, **worse)

    assert is_better(CHECK, other)
    assert not is_better(other, CHECK)


def test_a_centimetre_counts_as_much_as_a_degree() -> None:
    traded = msgspec.structs.replace(CHECK, position_error_m=0.01, angle_error_deg=2.4)

    assert is_better(traded, CHECK)
    assert not is_better(msgspec.structs.replace(traded, angle_error_deg=2.6), CHECK)


def test_the_first_policy_is_the_best_one_and_an_equal_one_does_not_replace_it() -> None:
    assert is_better(CHECK, None)
    assert not is_better(CHECK, CHECK)


def test_a_policy_is_built_with_its_card_and_can_be_written_and_used(tmp_path: Path) -> None:
    policy = built(small_profile(), CHECK)

    write_policy(tmp_path / "best", policy)

    again = read_policy(tmp_path / "best")
    assert encode_weights(again.layers, again.normalizer) == encode_weights(policy.layers, policy.normalizer)
    assert again.card == policy.card
    assert (again.card.check, again.card.curve, again.card.seed, again.card.steps) == (CHECK, (POINT,), 7, 0)
    assert LearnedPolicy(again, "best").card.command == "legpush train"


def test_a_policy_has_a_normalizer_only_if_its_profile_normalizes() -> None:
    profile = small_profile()
    bare = msgspec.structs.replace(profile, normalize_observation=False)

    with_it, without = built(profile).normalizer, built(bare).normalizer

    assert without is None
    assert with_it is not None
    assert len(with_it.mean) == len(with_it.variance) == 8


def test_a_check_evaluates_the_policy_on_seeds_of_its_own() -> None:
    policy, worlds = built(small_profile(evaluation_episodes=3)), [FakeWorld(), FakeWorld()]
    n_episodes = 0

    def count() -> None:
        nonlocal n_episodes
        n_episodes += 1

    check, again = (check_policy(policy, worlds, on_episode=count, stop=threading.Event()) for _ in range(2))

    assert check == again
    assert check.seeds == tuple(range(FIRST_CHECK_SEED, FIRST_CHECK_SEED + 3))
    assert (check.step, check.falls, n_episodes) == (0, 0, 6)
    assert check.cycles > 0.0


def test_a_check_can_be_stopped() -> None:
    stop = threading.Event()
    stop.set()

    with pytest.raises(StopRequestedError):
        check_policy(built(small_profile()), [FakeWorld()], on_episode=lambda: None, stop=stop)
