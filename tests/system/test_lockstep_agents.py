"""Several agents at one simulator: it works for one of them at a time."""

from contextlib import ExitStack
from functools import partial
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from legpush.bus import channels
from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, in_directory
from legpush.errors import PeerError
from legpush.messages.common import Header
from legpush.messages.stepping import Answer, Observation, Outcome, Refusal
from legpush.patience import Patience
from tests.legpush.examples import WORLD
from tests.legpush.fakes import IMPATIENT, RUN, Agent, FakeStepper, agent, bus, crc_after, eventually, mission, sim

MISSION = mission()


def test_a_second_agent_is_refused_while_the_first_is_alive_and_disturbs_nothing(tmp_path: Path) -> None:
    stepper = FakeStepper()
    with sim(tmp_path, stepper) as serving, agent(tmp_path) as first:
        first.do(MISSION[:3])
        at = Endpoints(connect=in_directory(tmp_path, "sim").listen)
        for name in ("main", "second"):
            with Bus(RUN, "agent", name, at) as second_bus:
                second = Agent(second_bus, Patience(deadline_s=20.0, resend_s=0.02, rival_s=0.1))
                with pytest.raises(PeerError, match=r"refuses step 0: it works for agent main \(\w+\), which is alive"):
                    second.do(MISSION[:2])
        assert first.do(MISSION[3:]) == crc_after(MISSION)
        assert serving.tally["conflict"] > 0
    assert stepper.performed == MISSION


def test_an_agent_takes_a_simulator_as_soon_as_the_one_before_is_gone(tmp_path: Path) -> None:
    with sim(tmp_path) as serving, ExitStack() as stack:
        at = Endpoints(connect=in_directory(tmp_path, "sim").listen)
        first = Agent(stack.enter_context(Bus(RUN, "agent", "main", at)), IMPATIENT)
        first.do(MISSION[:3])
        with agent(tmp_path) as second:

            def leave_once_it_is_refused() -> None:
                assert eventually(lambda: serving.tally["conflict"] > 0)
                stack.close()

            leaving = Thread(target=leave_once_it_is_refused)
            leaving.start()
            assert second.do(MISSION) == crc_after(MISSION)
            leaving.join()


def _build(kind: type[Answer], header: Header, **fields: Any) -> Answer:
    return kind(header=header, **fields)


def test_an_agent_whose_simulator_follows_somebody_else_says_so(tmp_path: Path) -> None:
    with bus(tmp_path, "sim") as serving, agent(tmp_path) as asking:
        actions = serving.subscribe(channels.actions(RUN, "main"))
        answers = serving.publisher(channels.answers(RUN, "main"))

        def answer() -> None:
            for step, outcome in enumerate((Outcome(world=WORLD, state_crc=1), None)):
                # An action whose answer is late is sent again.
                action = next(each for each in iter(lambda: actions.next(10.0), None) if each.step >= step)
                asked: dict[str, Any] = {
                    "agent_incarnation": action.header.incarnation,
                    "episode": action.episode,
                    "step": action.step,
                }
                if outcome is not None:
                    answers.send(partial(_build, Observation, outcome=outcome, **asked))
                    continue
                refusal: dict[str, Any] = {
                    "cause": "out_of_step",
                    "reason": "no",
                    "next_episode": action.episode + 1,
                    "next_step": 5,
                }
                answers.send(partial(_build, Refusal, **refusal, **asked))

        serving.announce()
        answering = Thread(target=answer)
        answering.start()
        with pytest.raises(PeerError, match=r"sim/main refuses step 1: no; is another agent using it\?"):
            asking.do(MISSION[:2])
        answering.join()
