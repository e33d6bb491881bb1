"""Worlds to test the simulator in, and a short episode that was really simulated, as messages and as a timeline."""

import pytest

from legpush.history.run_history import RunHistory
from legpush.history.timeline import Timeline
from legpush.messages.stepping import Motion, Push, Reset
from legpush.messages.telemetry import Copy
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import Box, Goal, PoseDeg, Room, Scenario
from sim_proc.simulator import Simulator
from tests.legpush.recording.recordings import ACTIONS, AGENT, ANSWERS, SIM, traffic
from tests.robots import ROBOT

BOX_X_M = 2.0 + 0.2 + ROBOT.pushing.gap_m + ROBOT.stance.foot_rectangle_length_m / 2


@pytest.fixture
def at_the_box() -> Scenario:
    """A robot that stands at the push station of a light box, on an open floor."""
    return standing_at_the_box()


def standing_at_the_box() -> Scenario:
    """The scenario of `at_the_box`."""
    return Scenario(
        name="at_the_box",
        room=Room(size_m=(12.0, 10.0)),
        start=PoseDeg(x_m=2.0, y_m=5.0, yaw_deg=0.0),
        box=Box(pose=PoseDeg(x_m=BOX_X_M, y_m=5.0, yaw_deg=0.0)),
        goal=Goal(pose=PoseDeg(x_m=BOX_X_M + 1.0, y_m=5.0, yaw_deg=0.0)),
    )


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
