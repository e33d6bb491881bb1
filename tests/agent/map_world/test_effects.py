"""A world that draws what pushes do: each seed is another box, and it is the same one whenever it is drawn."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.map_world.effects import BOX_KEY
from agent_proc.map_world.simulator import MapSimulator, unknown_box_simulator
from agent_proc.push_model.drawn_response import drawn_response
from agent_proc.push_model.model import MIRROR
from agent_proc.push_model.response import kind_of
from legpush.errors import MotionError, ScenarioError
from legpush.geometry import Pose2
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Motion, Push, Reset
from legpush.realism.settings import Randomization
from legpush.scenarios.changes import change_fields
from legpush.scenarios.file import load_scenario
from legpush.scene.faces import FACES
from legpush.scene.scenario import Scenario

PUSH = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.1)


def scenario(**changes: Any) -> Scenario:
    """The box 1 m before its goal, without offsets."""
    plain = replace(load_scenario("push"), randomization=Randomization())
    return change_fields(plain, {name.replace("__", "."): value for name, value in changes.items()})


def ends(simulator: MapSimulator, seed: int, *pushes: Push, **changes: Any) -> list[Pose2]:
    """The pose of the box after the reset and after each push."""
    motions: tuple[Motion, ...] = (Reset(scenario=scenario(**changes), seed=seed), *pushes)
    return [planar_pose(simulator.perform(motion, with_trace=False).world.box) for motion in motions]


def test_each_seed_draws_a_box_and_draws_the_same_one_again() -> None:
    simulator = unknown_box_simulator()
    first, other, again = (ends(simulator, seed, PUSH, PUSH) for seed in (1, 2, 1))

    assert first == again
    assert first[0] == other[0]
    assert len({round(end.yaw_rad, 3) for end in (first[1], other[1])}) == 2


def test_pushes_of_an_episode_scatter_around_what_was_drawn() -> None:
    seed, depth_m = 4, 0.08
    before, *after = ends(unknown_box_simulator(), seed, *[replace(PUSH, depth_m=depth_m)] * 40)
    sequence = np.random.SeedSequence(seed, spawn_key=(BOX_KEY, FACES.index("rear")))
    drawn = drawn_response(scenario().box, np.random.default_rng(sequence))

    yields_m = np.array([depth_m - drawn.lost_depth_m])
    mean = np.concatenate(drawn.displacement(np.array([MIRROR["FL"]]), yields_m))
    moved = [one.inverse() @ other for one, other in pairwise((before, *after))]
    found = np.array([(each.x_m, each.y_m, each.yaw_rad) for each in moved])
    kind = kind_of(scenario().box)
    sds = np.sqrt(np.concatenate([each.variance(yields_m) for each in (kind.forward, kind.left, kind.turn)]))
    assert found.mean(axis=0) == pytest.approx(mean, abs=4.0 * float(sds.max()) / np.sqrt(len(found)))
    assert found.std(axis=0) == pytest.approx(sds, rel=0.35)


def test_the_weights_of_a_curve_count_and_a_push_that_is_lost_does_not() -> None:
    usual, wider = (ends(unknown_box_simulator(), 4, replace(PUSH, w1=w1))[1] for w1 in (0.5, 1.0))
    start, lost = ends(unknown_box_simulator(), 4, replace(PUSH, depth_m=1e-4, w1=1.0))

    assert abs(usual.yaw_rad - wider.yaw_rad) > 0.005
    assert abs((start.inverse() @ lost).yaw_rad) < 0.02


@pytest.mark.parametrize(
    "changes",
    [
        {"box__mass_kg": 8.0},
        {"box__size_m": (0.6, 0.3, 0.5)},
        {"box__shape": "cylinder", "box__size_m": (0.5, 0.5, 0.4)},
        {"room__slope_deg": 5.0},
    ],
)
def test_any_box_and_any_slope_is_pushed(changes: dict[str, Any]) -> None:
    start, *pushed = ends(unknown_box_simulator(), 0, *[PUSH] * 5, **changes)

    assert pushed[-1].x_m > start.x_m + 0.1


def test_what_is_not_known_of_such_boxes_is_refused() -> None:
    simulator = unknown_box_simulator()
    with pytest.raises(ScenarioError, match="expected the robot of the response map, got another one"):
        ends(simulator, 0, robot__stance__height_m=0.46)
    with pytest.raises(ScenarioError, match="without physics, got `realism` with motor_strength"):
        ends(simulator, 0, realism__motor_strength=0.8)
    with pytest.raises(MotionError, match=r"Expected a push of at most 0.12 m .* got 0.2 m"):
        ends(simulator, 0, replace(PUSH, depth_m=0.2))
