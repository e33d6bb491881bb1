"""Learning through the bus with real simulators: the same numbers as in one process, whatever happens to them."""

import signal
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from threading import Event

import numpy as np
import psutil
import pytest
from gymnasium.utils.env_checker import check_env
from numpy.typing import NDArray
from stable_baselines3.common.env_checker import check_env as check_env_sb3

from agent_proc.joining import joined_simulators
from agent_proc.learning.env import PushEnv
from agent_proc.learning.vec_env import PushVecEnv
from agent_proc.simulators import own_simulators
from legpush.bus.endpoints import Endpoints, in_directory
from legpush.errors import ConfigError, PeerError, StopRequestedError
from legpush.lockstep.local import LocalWorld
from legpush.lockstep.world import SteppingWorld
from legpush.patience import Patience
from legpush.processes.pool import MAX_RESTARTS, SimPool
from sim_proc.simulator import Simulator
from tests.agent.tasks import tuned
from tests.legpush.fakes import eventually

TASK = tuned(max_steps=6)
N_STEPS = 16
KILL_AT = 9
"""In the second episode, after three pushes."""
Rollout = list[NDArray[np.generic]]


def children(name: str) -> list[psutil.Process]:
    """The running simulators of this process that have this name."""
    return [
        child
        for child in psutil.Process().children(recursive=True)
        if child.status() != psutil.STATUS_ZOMBIE and name in child.cmdline()
    ]


def kill_the_second() -> None:
    """Kill a simulator that this process has started."""
    (victim,) = children("sim1")
    victim.kill()


def rollout(worlds: list[SteppingWorld], disturb: Callable[[], object] | None = None) -> Rollout:
    """What a learner gets from a few episodes of random pushes."""
    vec = PushVecEnv(TASK, worlds, seed=7)
    numbers: Rollout = [np.asarray(vec.reset())]
    for index, actions in enumerate(np.random.default_rng(0).uniform(-1.0, 1.0, (N_STEPS, len(worlds), 4))):
        if disturb is not None and index == KILL_AT:
            disturb()
        observations, rewards, dones, infos = vec.step(actions.astype(np.float32))
        terminal = [info.get("terminal_observation", np.zeros(0)) for info in infos]
        numbers += [np.asarray(observations), rewards, dones, np.concatenate(terminal)]
    crcs = [snapshot.state_crc for snapshot in vec.snapshot()]
    vec.close()
    return [*numbers, np.array(crcs)]


@pytest.fixture(scope="module")
def undisturbed() -> Rollout:
    """Two simulators in this process."""
    return rollout([LocalWorld(Simulator()), LocalWorld(Simulator())])


def assert_equal(a: Rollout, b: Rollout) -> None:
    for x, y in zip(a, b, strict=True):
        np.testing.assert_array_equal(x, y)


def test_trajectories_through_the_bus_are_bit_equal_to_those_in_one_process(
    tmp_path: Path, undisturbed: Rollout
) -> None:
    with own_simulators(2, tmp_path, Event()) as worlds:
        assert_equal(rollout([*worlds]), undisturbed)


def test_a_simulator_killed_in_an_episode_is_replaced_and_the_learner_gets_the_same_numbers(
    tmp_path: Path, undisturbed: Rollout
) -> None:
    with own_simulators(2, tmp_path, Event()) as worlds:
        killed = rollout([*worlds], disturb=kill_the_second)
    assert_equal(killed, undisturbed)
    assert (tmp_path / "sim1.log").read_text().count("listening on") == 2
    assert (tmp_path / "sim0.log").read_text().count("listening on") == 1


def test_worlds_that_share_a_simulator_in_turn_do_not_disturb_each_other(tmp_path: Path) -> None:
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (4, 4)).astype(np.float32)
    alone = PushEnv(TASK, LocalWorld(Simulator()))
    with own_simulators(1, tmp_path, Event()) as worlds:
        one, two = PushEnv(TASK, worlds[0]), PushEnv(TASK, worlds[0].beside())
        for env, seed in ((one, 1), (two, 2), (alone, 1)):
            env.reset(seed=seed)
        for action in actions:
            seen, reward, *_ = one.step(action)
            two.step(action)
            expected, expected_reward, *_ = alone.step(action)
            np.testing.assert_array_equal(seen, expected)
            assert reward == expected_reward


def test_the_checkers_of_gymnasium_and_stable_baselines_pass_over_the_bus(tmp_path: Path) -> None:
    with own_simulators(1, tmp_path, Event()) as worlds, warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*(gymnasium.make|env.spec|Not able to test).*")
        env = PushEnv(tuned(), worlds[0])
        check_env(env, skip_render_check=True)
        check_env_sb3(env)


def test_no_simulator_is_left_behind_not_even_a_frozen_one(tmp_path: Path) -> None:
    with SimPool(2, tmp_path, Event()) as pool:
        found: dict[str, psutil.Process] = {}

        def all_are_found() -> bool:
            # One that becomes itself again has no command line for an instant.
            found.update({name: child for name in pool.names for child in children(name)})
            return len(found) == 2

        assert eventually(all_are_found)
        started = list(found.values())
        started[0].send_signal(signal.SIGSTOP)
    assert not any(process.is_running() for process in started)


LEARNER = """
import sys
from pathlib import Path
from threading import Event
from legpush.processes.pool import SimPool
with SimPool(2, Path(sys.argv[1]), Event()):
    Event().wait()
"""


def test_no_simulator_outlives_a_learner_that_was_killed(tmp_path: Path) -> None:
    with subprocess.Popen([sys.executable, "-c", LEARNER, str(tmp_path)]) as learner:
        process = psutil.Process(learner.pid)
        assert eventually(lambda: len(process.children(recursive=True)) == 2)
        started = process.children(recursive=True)
        learner.kill()
    assert eventually(lambda: not any(child.is_running() for child in started))


def learn_until(stop: Event) -> None:
    """As a link that waits for its simulator."""
    stop.wait(30.0)
    raise StopRequestedError("Asked to stop while waiting")


def test_a_simulator_that_cannot_run_ends_the_learning_with_its_last_words(tmp_path: Path) -> None:
    stop = Event()
    program = ("-c", "raise SystemExit('no license for this floor')")
    words = rf"(?s)sim0 exited with 1 .* {MAX_RESTARTS} times in vain.*no license"
    with pytest.raises(PeerError, match=words), SimPool(1, tmp_path, stop, program=program):
        learn_until(stop)
    assert stop.is_set()


def test_no_simulators_at_all_are_refused_by_the_pool(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="at least 1 simulator"):
        SimPool(0, tmp_path, Event())


def test_no_simulator_within_the_deadline_is_an_error_that_says_how_to_start_one(tmp_path: Path) -> None:
    patience = Patience(deadline_s=0.2)
    with (
        pytest.raises(PeerError, match=r"Expected 2 simulators .* found none, .* `python -m sim_proc --run lonely"),
        joined_simulators(2, "lonely", listening(tmp_path), Event(), patience),
    ):
        raise AssertionError("there is no simulator to join")


def listening(directory: Path) -> Endpoints:
    """Where a learner waits for simulators in a directory of its own."""
    directory.chmod(0o700)
    return Endpoints(listen=in_directory(directory, "agent").listen)


@contextmanager
def simulator(name: str, endpoints: Endpoints, *more: str) -> Iterator[subprocess.Popen[bytes]]:
    """A process of one simulator, or more, that somebody else runs."""
    command = [sys.executable, "-P", "-m", "sim_proc", "--run", "joined", "--name", name, *more]
    started = subprocess.Popen([*command, "--listen", "--connect", *endpoints.listen], stderr=subprocess.DEVNULL)
    try:
        yield started
    finally:
        started.terminate()
        started.wait(20.0)


def test_running_simulators_are_found_by_name_and_give_the_same_numbers(tmp_path: Path, undisturbed: Rollout) -> None:
    endpoints = listening(tmp_path)
    with ExitStack() as stack:
        for name in ("b", "a"):
            stack.enter_context(simulator(name, endpoints))
        worlds = stack.enter_context(joined_simulators(2, "joined", endpoints, Event()))
        assert [world.name for world in worlds] == ["a", "b"]
        assert_equal(rollout([*worlds]), undisturbed)


def test_a_spare_simulator_takes_the_place_of_one_that_is_gone_even_if_it_comes_later(
    tmp_path: Path, undisturbed: Rollout, caplog: pytest.LogCaptureFixture
) -> None:
    endpoints = listening(tmp_path)
    patience = Patience(leave_s=0.5)
    with ExitStack() as stack:
        _, lost = [stack.enter_context(simulator(name, endpoints)) for name in ("a", "b")]
        worlds = stack.enter_context(joined_simulators(2, "joined", endpoints, Event(), patience))

        def replace_it() -> None:
            lost.kill()
            stack.enter_context(simulator("later", endpoints))

        found = rollout([*worlds], replace_it)
        assert [world.name for world in worlds] == ["a", "later"]
    assert_equal(found, undisturbed)
    assert "Its place takes sim/later." in caplog.text


def test_simulators_of_one_process_give_the_same_numbers_even_if_another_process_takes_its_place(
    tmp_path: Path, undisturbed: Rollout
) -> None:
    endpoints = listening(tmp_path)
    with ExitStack() as stack:
        lost = stack.enter_context(simulator("a", endpoints, "--simulators", "2"))
        worlds = stack.enter_context(joined_simulators(2, "joined", endpoints, Event()))
        assert [world.name for world in worlds] == ["a-1", "a-2"]

        def replace_it() -> None:
            lost.kill()
            stack.enter_context(simulator("a", endpoints, "--simulators", "2"))

        assert_equal(rollout([*worlds], replace_it), undisturbed)
