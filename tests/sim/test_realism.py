"""Episodes in which the world is not what the robot takes it to be."""

from math import hypot
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.messages import codec
from legpush.messages.stepping import Follow, Outcome, Push, Reset, Walk
from legpush.realism.reality import drawn_reality
from legpush.realism.settings import FloorTiles, Gusts, Realism
from legpush.scene.scenario import Scenario
from sim_proc.simulator import Simulator

REAL = Realism(profile="real")
PUSH = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)


def in_world(scenario: Scenario, realism: Realism, *, far: bool = False) -> Scenario:
    """The scenario with a realism; `far` puts the box out of the way of a walk."""
    box = replace(scenario.box, pose=replace(scenario.box.pose, x_m=10.0, y_m=8.0)) if far else scenario.box
    return replace(scenario, realism=realism, box=box)


def walked(scenario: Scenario, n_cycles: int, seed: int = 0) -> list[Outcome]:
    """Outcomes of a walk straight ahead."""
    simulator = Simulator()
    outcomes = [simulator.perform(Reset(scenario=scenario, seed=seed), with_trace=False)]
    seen = outcomes[0].world.perceived
    start = scenario.start.pose() if seen is None else seen.trunk
    path = tuple(start @ Pose2(x_m=0.1 * k, y_m=0.0, yaw_rad=0.0) for k in range(40))
    outcomes.append(simulator.perform(Follow(waypoints=path), with_trace=False))
    for _ in range(n_cycles):
        outcomes.append(simulator.perform(Walk(), with_trace=True))
        if outcomes[-1].world.fallen:
            break
    return outcomes


def test_ideal_numbers_leave_every_bit_as_it_is(at_the_box: Scenario) -> None:
    stated = Realism(
        motor_strength=1.0, payload_kg=0.0, command_latency_s=0.0, gusts=Gusts(force_n=0.0, duration_s=0.2)
    )
    crcs = {}
    for name, realism in (("nothing", Realism()), ("stated", stated)):
        simulator = Simulator()
        outcomes = [
            simulator.perform(Reset(scenario=in_world(at_the_box, realism), seed=1), with_trace=False),
            simulator.perform(PUSH, with_trace=False),
        ]
        assert all(each.reality is None and each.world.perceived is None for each in outcomes)
        crcs[name] = [each.state_crc for each in outcomes]
    assert crcs["nothing"] == crcs["stated"]


def test_an_episode_repeats_bit_for_bit_and_tells_what_was_drawn(at_the_box: Scenario) -> None:
    scenario = in_world(at_the_box, REAL)
    found = []
    for _ in range(2):
        simulator = Simulator()
        reset = simulator.perform(Reset(scenario=scenario, seed=3), with_trace=False)
        pushed = simulator.perform(PUSH, with_trace=False)
        found.append((reset, pushed))
    (reset, pushed), again = found
    assert (reset, pushed) == again
    assert reset.reality == drawn_reality(REAL, 3)
    assert pushed.reality is None
    assert codec.convert(codec.unpack(codec.encode(pushed)), Outcome) == pushed


def test_seeds_draw_other_worlds(at_the_box: Scenario) -> None:
    scenario = in_world(at_the_box, REAL)
    crcs = {Simulator().perform(Reset(scenario=scenario, seed=seed), with_trace=False).state_crc for seed in range(5)}
    assert len(crcs) == 5


def test_the_box_is_perceived_beside_where_it_is(at_the_box: Scenario) -> None:
    world = Simulator().perform(Reset(scenario=in_world(at_the_box, REAL), seed=3), with_trace=False).world
    assert world.perceived is not None
    off_m = hypot(*(a - b for a, b in zip(world.box.position_m[:2], world.perceived.box.position_m[:2], strict=True)))
    assert 0.0 < off_m < 0.06
    assert 0.0 < hypot(world.perceived.trunk.x_m - world.trunk.position_m[0]) < 0.12


@pytest.mark.parametrize(
    "item",
    [
        {"motor_strength": 0.8},
        {"joint_friction_n_m": 1.0},
        {"payload_kg": 5.0, "payload_x_m": 0.1},
        {"com_x_m": 0.02},
        {"foot_friction": 0.6},
        {"slope_deg": 2.0, "uphill_deg": 90.0},
        {"command_latency_s": 0.02},
        {"gusts": Gusts(force_n=50.0, duration_s=0.2, at_s=0.2, direction_deg=90.0)},
        {"floor": FloorTiles(height_m=0.01)},
    ],
    ids=lambda item: next(iter(item)),
)
def test_every_item_changes_the_walk_and_the_robot_stays_up(at_the_box: Scenario, item: dict[str, Any]) -> None:
    outcomes = walked(in_world(at_the_box, Realism(**item), far=True), 2)
    ideal = walked(in_world(at_the_box, Realism(), far=True), 2)
    assert not outcomes[-1].world.fallen
    assert len(outcomes) == len(ideal) == 4
    positions = [np.array(each[-1].world.joint_positions_rad) for each in (outcomes, ideal)]
    assert (positions[0] != positions[1]).any()


def test_a_badly_located_robot_walks_to_where_it_believes_to_be_going(at_the_box: Scenario) -> None:
    realism = Realism(localization=replace(Realism().localization, noise_m=0.05, rate_hz=0.01))
    scenario = in_world(at_the_box, realism, far=True)
    outcomes = walked(scenario, 4, seed=2)
    last = outcomes[-1].world
    assert last.path is not None
    assert last.perceived is not None
    seen = outcomes[0].world.perceived
    assert seen is not None
    assert last.perceived.trunk.y_m == pytest.approx(seen.trunk.y_m, abs=0.03)


def test_a_strong_gust_from_the_side_throws_the_robot(at_the_box: Scenario) -> None:
    gusts = Gusts(force_n=1000.0, duration_s=0.3, at_s=0.5, direction_deg=90.0)
    assert walked(in_world(at_the_box, Realism(gusts=gusts), far=True), 4)[-1].world.fallen
