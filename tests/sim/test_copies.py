"""A copy of a simulator has its state, goes on as the simulator does, bit for bit, and leaves it alone."""

from copy import deepcopy

import pytest
from msgspec.structs import replace

from legpush.errors import LegpushError
from legpush.messages.stepping import Follow, Motion, Push, Reset, Walk
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import Scenario
from sim_proc.simulator import Simulator

LEFT = Push(w1=0.3, w2=0.6, leg="FL", depth_m=0.05)
RIGHT = Push(w1=0.5, w2=0.5, leg="FR", depth_m=0.03)
SCENARIO = load_scenario("open")


def began(scenario: Scenario, *motions: Motion) -> Simulator:
    simulator = Simulator()
    for motion in (Reset(scenario=scenario, seed=1), *motions):
        simulator.perform(motion, with_trace=False)
    return simulator


@pytest.mark.parametrize("name", ["open", "open_real"])
def test_a_copy_goes_on_bit_for_bit_and_each_goes_its_own_way(name: str) -> None:
    simulator = began(load_scenario(name), LEFT)
    copied = deepcopy(simulator)

    copied.perform(RIGHT, with_trace=False)
    later = deepcopy(copied)
    expected = began(load_scenario(name), LEFT, LEFT, RIGHT)
    simulator.perform(LEFT, with_trace=False)

    assert simulator.perform(RIGHT, with_trace=True) == began(load_scenario(name), LEFT, LEFT).perform(
        RIGHT, with_trace=True
    )
    assert later.perform(LEFT, with_trace=True) == copied.perform(LEFT, with_trace=True)
    assert expected.perform(LEFT, with_trace=False) == simulator.perform(LEFT, with_trace=False)


def test_a_copy_in_the_middle_of_a_walk_goes_on_with_it() -> None:
    back = replace(SCENARIO.start, x_m=SCENARIO.start.x_m - 1.0).pose()
    simulator = began(SCENARIO, Follow(waypoints=(SCENARIO.start.pose(), back)), Walk())
    copied = deepcopy(simulator)

    assert copied.perform(Walk(), with_trace=True) == simulator.perform(Walk(), with_trace=True)


def test_a_copy_notices_a_physics_that_has_gone_wrong_as_well() -> None:
    copied = deepcopy(began(SCENARIO))
    assert copied.episode is not None
    copied.episode.physics.data.qvel[:] = 1e12

    with pytest.raises(LegpushError, match="MuJoCo warned of mjWARN_BADQVEL"):
        copied.perform(LEFT, with_trace=False)
