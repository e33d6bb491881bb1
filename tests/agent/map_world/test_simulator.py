"""The simulator without physics: boxes, robot, refusals, and how near it is to the simulator."""

from functools import partial
from math import degrees
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from agent_proc.learning.env import PushEnv
from agent_proc.map_world.effects import MeasuredEffects
from agent_proc.map_world.random_pushes import RandomSeries, displacement
from agent_proc.map_world.response_map import load_response_map, write_response_map
from agent_proc.map_world.simulator import MapSimulator, mean_map_simulator
from agent_proc.push_model.model import MIRROR
from agent_proc.task.file import load_task
from legpush.errors import MotionError, ScenarioError
from legpush.lockstep.local import LocalWorld
from legpush.messages import codec
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Alter, Motion, Outcome, Push, Reset, Walk
from legpush.scenarios.changes import change_fields
from legpush.scenarios.file import load_scenario
from legpush.scene.conventions import FRONT_LEGS, FrontLeg
from legpush.scene.faces import FACES, pushed_box, pushed_pose
from legpush.scene.names import Face
from legpush.scene.scenario import PoseDeg, Scenario
from legpush.scene.station import at_station, station
from sim_proc.simulator import Simulator
from tests.agent.map_world.fake_maps import STANCE, known_map

SCENARIO = load_scenario("push")
KNOWN = known_map()
MEAN = partial(MeasuredEffects, residuals=False)


def outcomes(simulator: MapSimulator, *motions: Motion) -> list[Outcome]:
    return [simulator.perform(motion, with_trace=False) for motion in motions]


def at_face(face: Face) -> Scenario:
    """The robot at its station behind a face."""
    place = station(SCENARIO.robot, pushed_box(SCENARIO.box, face), pushed_pose(SCENARIO.box.pose.pose(), face))
    return replace(SCENARIO, start=PoseDeg(x_m=place.x_m, y_m=place.y_m, yaw_deg=degrees(place.yaw_rad)))


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("leg", FRONT_LEGS)
def test_a_push_moves_the_box_as_the_map_says_and_the_robot_follows_it(face: Face, leg: FrontLeg) -> None:
    scenario = at_face(face)
    push = Push(w1=0.2, w2=0.7, leg=leg, depth_m=0.06, face=face)
    before, first, second = outcomes(MapSimulator(KNOWN, effects=MEAN), Reset(scenario=scenario, seed=3), push, push)

    depth_m, w1, w2 = (np.array([value]) for value in (push.depth_m, push.w1, push.w2))
    surface, mirror = KNOWN.surface(face), np.array([MIRROR[leg]])
    for last, now, is_first in ((before, first, True), (first, second, False)):
        moved = displacement(last.world, push, now.world)
        expected = surface.displacement(mirror, depth_m, w1, w2, first=is_first)[0]
        assert (moved.x_m, moved.y_m, moved.yaw_rad) == pytest.approx(tuple(expected))
        box, trunk = planar_pose(now.world.box), planar_pose(now.world.trunk)
        place = station(scenario.robot, pushed_box(scenario.box, face), pushed_pose(box, face))
        stance = place.inverse() @ trunk
        assert (stance.x_m, stance.y_m) == pytest.approx((STANCE.trunk.x_m, STANCE.trunk.y_m))
        assert at_station(scenario.robot, trunk, pushed_box(scenario.box, face), pushed_pose(box, face))
        tips = trunk.inverse().apply([tip[:2] for tip in now.world.tips_m])
        assert tips == pytest.approx(np.array(STANCE.tips_m)[:, :2])
    assert (second.world.tick, second.world.n_footsteps) == (280, 8)
    assert second.world.push is not None
    assert second.world.push.leg == leg


pushes = st.lists(
    st.builds(
        Push,
        w1=st.floats(0.0, 1.0),
        w2=st.floats(0.0, 1.0),
        leg=st.sampled_from(FRONT_LEGS),
        depth_m=st.floats(0.001, 0.12),
    ),
    min_size=1,
    max_size=5,
)


@given(seed=st.integers(0, 2**63 - 1), motions=pushes)
def test_equal_seeds_lead_to_equal_states_and_others_to_others(seed: int, motions: list[Push]) -> None:
    one, again, other = (
        outcomes(MapSimulator(KNOWN), Reset(scenario=SCENARIO, seed=s), *motions) for s in (seed, seed, seed ^ 1)
    )

    assert one == again
    assert all(a.state_crc != b.state_crc for a, b in zip(one, other, strict=True))
    assert len({outcome.state_crc for outcome in one}) == len(one)
    assert all(codec.decode(codec.encode(outcome), Outcome) == outcome for outcome in one)


@given(seed=st.integers(0, 1000), motions=pushes)
def test_without_residuals_the_seed_decides_about_the_start_only(seed: int, motions: list[Push]) -> None:
    found = outcomes(MapSimulator(KNOWN, effects=MEAN), Reset(scenario=SCENARIO, seed=seed), *motions)
    other = outcomes(MapSimulator(KNOWN, effects=MEAN), Reset(scenario=SCENARIO, seed=seed + 1), *motions)

    for index, push in enumerate(motions):
        moved, same = (displacement(o[index].world, push, o[index + 1].world) for o in (found, other))
        assert (moved.x_m, moved.y_m, moved.yaw_rad) == pytest.approx((same.x_m, same.y_m, same.yaw_rad), abs=1e-9)


def test_residuals_scatter_around_the_mean_push() -> None:
    push = Push(w1=0.5, w2=0.5, leg="FR", depth_m=0.05)
    simulator, errors = MapSimulator(KNOWN), []
    mean = KNOWN.surface("rear").displacement(
        np.array([-1.0]), np.array([0.05]), np.array([0.5]), np.array([0.5]), first=True
    )[0]
    for seed in range(400):
        before, after = outcomes(simulator, Reset(scenario=SCENARIO, seed=seed), push)
        moved = displacement(before.world, push, after.world)
        errors.append(np.array([moved.x_m, moved.y_m, moved.yaw_rad]) - mean)

    (part,) = (p for p in KNOWN.surface("rear").residuals if p.to_depth_m == 0.07)
    sd = np.sqrt(part.covariance.diagonal())
    assert np.std(errors, axis=0) == pytest.approx(sd, rel=0.15)
    assert np.abs(np.mean(errors, axis=0)).max() < 0.2 * sd.max()


def test_an_episode_starts_where_it_does_in_the_simulator() -> None:
    for seed in (1, 2):
        reset = Reset(scenario=SCENARIO, seed=seed)
        real, mapped = (s.perform(reset, with_trace=False).world for s in (Simulator(), MapSimulator()))
        for body in ("trunk", "box"):
            a, b = planar_pose(getattr(real, body)), planar_pose(getattr(mapped, body))
            assert (a.x_m, a.y_m, a.yaw_rad) == pytest.approx((b.x_m, b.y_m, b.yaw_rad), abs=3e-3)
        assert np.array(real.tips_m) == pytest.approx(np.array(mapped.tips_m), abs=6e-3)
        assert real.trunk.position_m[2] == pytest.approx(mapped.trunk.position_m[2], abs=3e-3)


def test_the_map_of_the_package_is_near_the_simulator() -> None:
    series = RandomSeries(face="rear", seed=77)
    simulator, response_map = LocalWorld(Simulator()), load_response_map()
    errors = []
    last = simulator.step(Reset(scenario=SCENARIO, seed=77))
    for index, push in enumerate(series.pushes()[:10]):
        now = simulator.step(push)
        depth_m, w1, w2 = (np.array([value]) for value in (push.depth_m, push.w1, push.w2))
        mapped = response_map.surface("rear").displacement(
            np.array([MIRROR[push.leg]]), depth_m, w1, w2, first=index == 0
        )[0]
        moved = displacement(last.world, push, now.world)
        errors.append(np.array([moved.x_m, moved.y_m, moved.yaw_rad]) - mapped)
        last = now

    forward_m, left_m, turn_rad = np.sqrt(np.mean(np.square(errors), axis=0))
    assert (forward_m < 0.003, left_m < 0.005, degrees(turn_rad) < 1.0) == (True, True, True), (
        "the simulator has changed: README of tests says how the map is measured again"
    )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"box.mass_kg": 0.5}, "expected the box of the response map, mass_kg 0.1, got mass_kg 0.5"),
        ({"box.friction": 0.9}, "expected the box of the response map, friction 0.5, got friction 0.9"),
        ({"box.size_m": (0.5, 0.5, 0.4)}, r"size_m \(0.4, 0.5, 0.4\), got size_m \(0.5, 0.5, 0.4\)"),
        ({"robot.stance.height_m": 0.46}, "expected the robot of the response map, got another one"),
        ({"realism.motor_strength": 0.8}, "without physics, got `realism` with motor_strength"),
        ({"room.slope_deg": 2.0}, "expected a level floor for a response map, got a slope of 2°"),
        (
            {"room.obstacles": [{"x_min_m": 5.0, "x_max_m": 5.5, "y_min_m": 3.0, "y_max_m": 3.5}]},
            "expected a floor without obstacles .*, got 1 of them",
        ),
    ],
)
def test_what_the_map_does_not_describe_is_refused(changes: dict[str, Any], message: str) -> None:
    world = LocalWorld(MapSimulator())
    with pytest.raises(ScenarioError, match=message):
        world.step(Reset(scenario=change_fields(SCENARIO, changes), seed=0))
    world.step(Reset(scenario=SCENARIO, seed=0))


PUSH = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)


@pytest.mark.parametrize(
    ("motion", "message"),
    [
        (Walk(), "Expected `follow` before `walk`: there is no path"),
        (Alter(box_mass_kg=1.0), "got `alter`"),
        (replace(PUSH, depth_m=0.2), "Expected a push of at most 0.12 m with the locus `swing`"),
        (replace(PUSH, locus="published"), "got 0.05 m with the locus `published`"),
        (replace(PUSH, face="left"), "Expected the robot at its station behind the left face"),
    ],
)
def test_a_motion_that_is_refused_changes_nothing(motion: Motion, message: str) -> None:
    world, undisturbed = LocalWorld(MapSimulator()), LocalWorld(MapSimulator())
    for each in (world, undisturbed):
        each.step(Reset(scenario=SCENARIO, seed=0))

    with pytest.raises(MotionError, match=message):
        world.step(motion)
    assert world.step(PUSH) == undisturbed.step(PUSH)


def test_an_episode_begins_with_a_reset() -> None:
    with pytest.raises(MotionError, match="Expected `reset` as the first motion of an episode, got `push`"):
        LocalWorld(MapSimulator()).step(PUSH)


def test_the_trace_of_a_push_has_no_ticks() -> None:
    simulator = mean_map_simulator()
    simulator.perform(Reset(scenario=SCENARIO, seed=0), with_trace=True)

    outcome = simulator.perform(PUSH, with_trace=True)
    assert outcome.trace is not None
    assert outcome.trace.tick == ()


def test_the_map_may_be_a_file(tmp_path: Path) -> None:
    write_response_map(KNOWN, tmp_path / "map.json")
    reset = Reset(scenario=SCENARIO, seed=0)

    assert outcomes(MapSimulator(tmp_path / "map.json"), reset, PUSH) == outcomes(MapSimulator(KNOWN), reset, PUSH)


def test_an_environment_in_the_map_goes_on_from_a_snapshot() -> None:
    rng = np.random.default_rng(0)
    env = PushEnv(load_task(), LocalWorld(MapSimulator()))
    env.reset(seed=1)
    for action in rng.uniform(-1.0, 1.0, (4, 4)).astype(np.float32):
        env.step(action)
    saved, action = env.snapshot(), np.array([0.1, 0.2, -1.0, 0.5], dtype=np.float32)
    observation, reward, *_ = env.step(action)
    other = PushEnv(load_task(), LocalWorld(MapSimulator()))
    other.restore(saved)

    again, reward_again, *_ = other.step(action)
    assert (again.tolist(), reward_again) == (observation.tolist(), reward)
