"""The lockstep between services on real links: once each, whatever the channel does, and nobody waits without end."""

from pathlib import Path
from threading import Event, Thread

import pytest
from msgspec.structs import replace

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints
from legpush.bus.faults import Faults
from legpush.errors import MotionError, PeerError, StopRequestedError
from legpush.lockstep.client import PastStep
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Action, Motion, Observation, Outcome, Walk
from legpush.patience import Patience
from tests.legpush.examples import QUERY, RESET, TRACE, WORLD
from tests.legpush.fakes import (
    RUN,
    Agent,
    FakeStepper,
    agent,
    bus,
    crc_after,
    eventually,
    fake_plan,
    mission,
    planner,
    sim,
)

MISSION = mission()
HURRIED = Patience(deadline_s=0.3, resend_s=0.02)


def test_a_mission_is_carried_out_step_by_step(tmp_path: Path) -> None:
    stepper = FakeStepper()
    with sim(tmp_path, stepper), agent(tmp_path) as asking:
        assert asking.do(MISSION) == crc_after(MISSION)
    assert stepper.performed == MISSION


@pytest.mark.parametrize("seed", range(4))
def test_a_bad_channel_changes_nothing_but_the_time_it_takes(tmp_path: Path, seed: int) -> None:
    stepper = FakeStepper()
    faults = Faults(probability=0.2, seed=seed)
    with sim(tmp_path, stepper, faults) as serving, agent(tmp_path, faults) as asking:
        assert asking.do(MISSION) == crc_after(MISSION)
        late = asking.bus.tally["late"] + serving.tally["out_of_step"]
    assert stepper.performed == MISSION
    assert late > 0


@pytest.mark.parametrize("seed", range(2))
def test_plans_come_through_a_bad_channel(tmp_path: Path, seed: int) -> None:
    faults = Faults(probability=0.2, seed=seed)
    with planner(tmp_path, faults=faults), agent(tmp_path, faults) as asking:
        for _ in range(10):
            assert asking.planner.plan(QUERY) == fake_plan(QUERY)


def test_the_trace_comes_where_it_is_asked_for(tmp_path: Path) -> None:
    with sim(tmp_path), agent(tmp_path) as asking:
        assert asking.sim.step(RESET, [], with_trace=True).trace == TRACE
        assert asking.sim.step(MISSION[1], [PastStep(RESET, 0)]).trace is None


def test_one_agent_after_the_other_gets_a_world_of_its_own(tmp_path: Path) -> None:
    with sim(tmp_path):
        for n_steps in (len(MISSION), 7, 1):
            with agent(tmp_path) as asking:
                assert asking.do(MISSION[:n_steps]) == crc_after(MISSION[:n_steps])


def test_one_agent_can_begin_one_episode_after_the_other(tmp_path: Path) -> None:
    with sim(tmp_path), agent(tmp_path) as asking:
        numbers = []
        for _ in range(5):
            numbers.append(asking.sim.begin())
            asking.past = []
            assert asking.do(MISSION[:4]) == crc_after(MISSION[:4])
    assert numbers == sorted(set(numbers))


def test_an_agent_whose_clock_is_behind_still_opens_a_newer_episode(tmp_path: Path) -> None:
    with sim(tmp_path), agent(tmp_path) as asking:
        ahead = asking.sim.begin() + 10**9
        asking.sim.begin(ahead)
        asking.do(MISSION[:3])
        asking.past = []
        asking.sim.begin(5)
        assert asking.do(MISSION[:3]) == crc_after(MISSION[:3])
        assert asking.sim.episode > ahead


def test_a_motion_that_cannot_be_carried_out_is_said_so_and_the_episode_goes_on(tmp_path: Path) -> None:
    with sim(tmp_path), agent(tmp_path) as asking:
        asking.do([RESET])
        with pytest.raises(MotionError, match="Expected a follow before the first walk"):
            asking.do([Walk()])
        assert asking.do(MISSION[1:]) == crc_after(MISSION)


class Forgetful(FakeStepper):
    """Computes something else after each reset but the first."""

    def __init__(self) -> None:
        super().__init__()
        self.n_resets = 0

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        self.n_resets += motion == RESET
        outcome = super().perform(motion, with_trace=with_trace)
        return outcome if self.n_resets == 1 else Outcome(world=outcome.world, state_crc=outcome.state_crc ^ 1)


def test_a_simulator_that_does_not_come_to_the_same_state_is_found_out(tmp_path: Path) -> None:
    stepper = Forgetful()
    with agent(tmp_path) as asking:
        with sim(tmp_path, stepper):
            asking.do(MISSION[:3])
        with (
            sim(tmp_path, stepper),
            pytest.raises(PeerError, match=r"Expected state \w{8} after step 0 of the journal"),
        ):
            asking.do(MISSION[3:])


def test_a_peer_that_never_comes_is_named_with_the_step(tmp_path: Path) -> None:
    with agent(tmp_path, patience=HURRIED) as asking:
        with pytest.raises(
            PeerError, match=r"No answer to step 0 \(reset\) within 0\.3 s; sim/main is not there: it has"
        ):
            asking.do(MISSION)
        with pytest.raises(PeerError, match=r"No answer to plan request 0 within 0\.3 s; the planner is not there"):
            asking.planner.plan(QUERY)


class Stuck(FakeStepper):
    """Does not come back from its first walk until it is released."""

    def __init__(self) -> None:
        super().__init__()
        self.began, self.release = Event(), Event()

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        if isinstance(motion, Walk):
            self.began.set()
            self.release.wait(30.0)
        return super().perform(motion, with_trace=with_trace)


def test_a_peer_that_takes_too_long_is_slow_and_what_it_says_is_told(tmp_path: Path) -> None:
    stepper = Stuck()
    with sim(tmp_path, stepper), agent(tmp_path, patience=Patience(deadline_s=1.5, resend_s=0.02)) as asking:
        try:
            asking.do(MISSION[:2])
            with pytest.raises(PeerError, match=r"step 2 \(walk\) within 1\.5 s; sim/main is slow: it is alive"):
                asking.do(MISSION[2:])
        finally:
            stepper.release.set()
        assert asking.waits[0].startswith("step 2 (walk): sim/main is slow: it is alive")
        assert asking.waits[-1] == ""


def test_copies_that_come_while_an_action_is_carried_out_get_one_answer_together(tmp_path: Path) -> None:
    stepper = Stuck()
    with sim(tmp_path, stepper) as serving, bus(tmp_path, "agent") as asking:
        asking.announce()
        assert eventually(lambda: serving.liveliness.live("agent") != [])
        answers = asking.subscribe(channels.answers(RUN, "main"))
        actions = asking.publisher(channels.actions(RUN, "main"))
        assert eventually(lambda: len(asking.liveliness.live("sim")) == 1)

        def send(step: int, motion: Motion) -> None:
            actions.send(lambda header: Action(header=header, episode=0, step=step, motion=motion))

        for step in range(3):
            send(step, MISSION[step])
        assert stepper.began.wait(10.0)
        for _ in range(20):
            send(2, MISSION[2])
        actions.send(lambda header: Action(header=replace(header, run="other"), episode=0, step=2, motion=Walk()))
        assert eventually(lambda: serving.tally["foreign_run"] == 1)
        stepper.release.set()
        send(3, MISSION[3])
        steps: list[int] = []
        while not steps or steps[-1] < 3:
            answer = answers.next(10.0)
            assert isinstance(answer, Observation)
            steps.append(answer.step)
    assert steps == [0, 1, 2, 3]


def test_two_simulators_of_one_name_are_an_error_and_neither_is_used(tmp_path: Path) -> None:
    first, second, asking_at = (
        Endpoints(listen=(f"unixsock-stream/{tmp_path}/{name}.sock",)) for name in ("1", "2", "3")
    )
    both = Endpoints(listen=asking_at.listen, connect=first.listen + second.listen)
    with (
        Bus(RUN, "sim", "main", first) as one,
        Bus(RUN, "sim", "main", second) as other,
        Bus(RUN, "agent", "main", both) as agent_bus,
    ):
        one.announce()
        other.announce()
        assert eventually(lambda: len(agent_bus.liveliness.live("sim")) == 2)
        asking = Agent(agent_bus, Patience(rival_s=0.2))
        with pytest.raises(PeerError, match=r"to be one process.* is several processes, 2 of them \(\w+, \w+\)"):
            asking.do(MISSION)


def test_an_answer_to_another_agent_is_not_taken_for_ones_own(tmp_path: Path) -> None:
    stepper = Stuck()
    with sim(tmp_path, stepper) as serving, agent(tmp_path) as asking:
        asking.do(MISSION[:2])
        forger = serving.publisher(channels.answers(RUN, "main"))
        outcome = Outcome(world=WORLD, state_crc=1)

        def forge() -> None:
            stepper.began.wait(10.0)
            forger.send(
                lambda header: Observation(
                    header=header, agent_incarnation="another", episode=asking.sim.episode, step=2, outcome=outcome
                )
            )
            eventually(lambda: asking.bus.tally["late"] == 1)
            stepper.release.set()

        forging = Thread(target=forge)
        forging.start()
        assert asking.do(MISSION[2:]) == crc_after(MISSION)
        forging.join()
        assert asking.past[2].state_crc == crc_after(MISSION[:3])
        assert asking.bus.tally["late"] == 1


def test_a_wait_ends_when_the_process_is_asked_to_stop(tmp_path: Path) -> None:
    with agent(tmp_path) as asking:
        asking.stop.set()
        with pytest.raises(StopRequestedError, match="step 0"):
            asking.do(MISSION)


def test_plans_are_made_once_each(tmp_path: Path) -> None:
    seeds: list[int] = []

    def make_plan(query: PlanQuery) -> Plan:
        seeds.append(query.seed)
        return fake_plan(query)

    with planner(tmp_path, make_plan), agent(tmp_path) as asking:
        for seed in range(5):
            assert asking.planner.plan(replace(QUERY, seed=seed)).n_iterations == seed
    assert seeds == list(range(5))
