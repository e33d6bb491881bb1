"""A recording to export: two episodes of a real simulator, with a plan, a reward, a status and a wall that appears."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from msgspec.structs import replace

from legpush.bus import keys
from legpush.geometry import Pose2
from legpush.messages import codec
from legpush.messages.planning import PlanRequest, PlanResult
from legpush.messages.stepping import Action, Follow, Motion, Observation, Push, Reset, Walk
from legpush.messages.telemetry import Copy, Fact, Reward, RewardTerm, Status
from legpush.scene.scenario import Rectangle, Room, Scenario
from sim_proc.export.source import Source, read_source
from sim_proc.simulator import Simulator
from tests.legpush.examples import PLAN, QUERY
from tests.legpush.fakes import RUN
from tests.legpush.recording.recordings import ACTIONS, AGENT, ANSWERS, EPISODE, SIM, copy, header, write

Messages = tuple[list[Copy], list[Copy]]
"""Of the agent, with what the planner answered it, and of the simulator."""
WAYPOINTS = (Pose2(x_m=2.0, y_m=5.0, yaw_rad=0.0), Pose2(x_m=1.8, y_m=5.0, yaw_rad=0.0))


def room(scenario: Scenario) -> Scenario:
    """With a wall, one that appears and one that never does."""

    def wall(x_m: float, appears_at_s: float) -> Rectangle:
        return Rectangle(x_min_m=x_m, x_max_m=x_m + 0.5, y_min_m=8.0, y_max_m=9.0, appears_at_s=appears_at_s)

    walls = (wall(1.0, 0.0), wall(4.0, 0.4), wall(7.0, 1000.0))
    return replace(scenario, room=Room(size_m=(12.0, 10.0), obstacles=walls))


def episode(number: int, motions: Sequence[Motion], first: int) -> Messages:
    """What both say of these steps, from a sequence on."""
    simulator, actions, answers = Simulator(), [], []
    for step, motion in enumerate(motions):
        at = first + step
        action = Action(header=header(AGENT, at), episode=number, step=step, motion=motion, with_trace=True)
        outcome = simulator.perform(motion, with_trace=True)
        answer = Observation(
            header=header(SIM, at), agent_incarnation=AGENT.incarnation, episode=number, step=step, outcome=outcome
        )
        actions.append(copy(ACTIONS, at, codec.encode(action)))
        answers.append(copy(ANSWERS, at, codec.encode(answer)))
    return actions, answers


@pytest.fixture(scope="session")
def said(at_the_box_once: Scenario) -> Messages:
    scenario = room(at_the_box_once)
    push = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)
    long: list[Motion] = [Reset(scenario=scenario, seed=0), push, Follow(waypoints=WAYPOINTS), Walk()]
    actions, answers = episode(EPISODE, long, 0)
    more = episode(EPISODE + 1, [Reset(scenario=scenario, seed=1), replace(push, leg="FR")], len(long))
    reward = Reward(
        header=header(AGENT, 0),
        sim="main",
        episode=EPISODE,
        step=1,
        value=0.1 + 0.2,
        terms=(RewardTerm(name="a", value=1.0),),
    )
    request = PlanRequest(header=header(AGENT, 0), request_id=2, query=QUERY)
    result = PlanResult(
        header=header(AGENT, 0),
        client_incarnation=AGENT.incarnation,
        request_id=2,
        revision=0,
        final=True,
        plan=PLAN,
    )
    status = Status(header=header(AGENT, 0), phase="pushing", fraction=0.5, detail="cycle 1")
    during = [
        replace(copy(key, 0, codec.encode(message)), time_ns=actions[1].time_ns + 1)
        for key, message in (
            (keys.reward(RUN, "main"), reward),
            (keys.plan_request(RUN, "main"), request),
            (keys.plan_result(RUN, "main"), result),
            (keys.status(RUN, "agent", "main"), status),
        )
    ]
    return actions + during + more[0], answers + more[1]


@pytest.fixture(scope="session")
def at_the_box_once() -> Scenario:
    """The same world as `at_the_box`, once for all tests here."""
    from tests.sim.conftest import standing_at_the_box

    return standing_at_the_box()


@pytest.fixture(scope="session")
def recorded(said: Messages, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The recording; tests leave it as it is."""
    path = tmp_path_factory.mktemp("recorded") / "a.mcap"
    facts = (Fact(name="report.json", media_type="application/json", data=b"{}"),)
    write(path, *said, n_per_batch=50, facts=facts)
    return path


@pytest.fixture(scope="session")
def source(recorded: Path) -> Source:
    return read_source([recorded], None, partial=False)
