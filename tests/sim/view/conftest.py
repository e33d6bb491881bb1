"""A short episode that was really simulated, as messages and as a timeline."""

from collections.abc import Iterator

import pytest

from legpush.history.run_history import RunHistory
from legpush.history.timeline import Timeline
from legpush.messages.stepping import Motion, Push, Reset
from legpush.messages.telemetry import Copy
from legpush.scenarios.file import load_scenario
from sim_proc.simulator import Simulator
from tests.legpush.recording.recordings import ACTIONS, AGENT, ANSWERS, SIM, traffic
from tests.sim.view.guarded import Served, serve

MOTIONS: tuple[Motion, ...] = (
    Reset(scenario=load_scenario("push"), seed=3),
    Push(w1=0.58, w2=0.4, leg="FL", depth_m=0.05),
    Push(w1=0.54, w2=0.37, leg="FR", depth_m=0.06),
)


@pytest.fixture(scope="session")
def messages() -> tuple[list[Copy], list[Copy]]:
    """What agent and simulator say: a reset and two pushes."""
    return traffic(MOTIONS, Simulator())


@pytest.fixture(scope="session")
def history(messages: tuple[list[Copy], list[Copy]]) -> RunHistory:
    """The same as the history of a run."""
    made = RunHistory()
    for origin, copies in ((AGENT, messages[0]), (SIM, messages[1])):
        for copy in copies:
            made.take_message("sim/main/action" if copy.key == ACTIONS else "sim/main/observation", origin, copy)
    assert {copy.key for copies in messages for copy in copies} == {ACTIONS, ANSWERS}
    return made


@pytest.fixture(scope="session")
def timeline(history: RunHistory) -> Timeline:
    """The episode."""
    (only,) = history.episodes.values()
    return only


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    made = serve("127.0.0.1")
    yield made
    made.server.stop()
