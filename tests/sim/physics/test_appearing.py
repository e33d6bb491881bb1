"""Obstacles that appear: when, where, and what they are before and after."""

from collections.abc import Sequence

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

from legpush.geometry import Pose2
from legpush.messages.stepping import Appearance, Follow, Motion, Outcome, Push, Reset, Walk
from legpush.scene.conventions import CONTROL_PERIOD_S, JOINT_QPOS
from legpush.scene.scenario import Rectangle, Room, Scenario
from sim_proc.physics.appearing import BOX_CLEARANCE_M, NEVER, Waiting, robot_clearance_m
from sim_proc.physics.physics import Physics
from sim_proc.simulator import Simulator
from tests.robots import ROBOT
from tests.sim.commands import held

AWAY = Pose2(x_m=9.0, y_m=9.0, yaw_rad=0.0)
BLOCK = Rectangle(x_min_m=4.0, x_max_m=4.5, y_min_m=4.0, y_max_m=6.0, appears_at_s=1.0)
BACK = Follow(waypoints=tuple(Pose2(x_m=2.0 - k / 20, y_m=5.0, yaw_rad=0.0) for k in range(21)))
PUSH = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)


def with_obstacles(scenario: Scenario, *obstacles: Rectangle) -> Scenario:
    return replace(scenario, room=Room(size_m=(12.0, 10.0), obstacles=obstacles))


def perform(simulator: Simulator, scenario: Scenario, motions: Sequence[Motion]) -> list[Outcome]:
    return [simulator.perform(m, with_trace=True) for m in [Reset(scenario=scenario, seed=0), *motions]]


def stand(physics: Physics, n_ticks: int) -> None:
    targets = np.repeat(physics.data.qpos[JOINT_QPOS][None], n_ticks, axis=0)
    physics.run(held(targets))


def geom_below(physics: Physics, x_m: float, y_m: float) -> str:
    """What a ray straight down from 3 m meets first."""
    mujoco.mj_kinematics(physics.model, physics.data)
    geom = np.zeros(1, dtype=np.int32)
    down, above = np.array([0.0, 0.0, -1.0]), np.array([x_m, y_m, 3.0])
    mujoco.mj_ray(physics.model, physics.data, above, down, None, 1, -1, geom)
    return str(physics.model.geom(int(geom[0])).name)


# -- when ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("appears_at_s", "tick"), [(0.001, 1), (0.02, 1), (0.021, 2), (0.3, 15), (0.6, 30), (1.0, 50), (1.001, 51)]
)
def test_an_obstacle_is_due_at_the_first_tick_at_or_after_its_time(
    at_the_box: Scenario, appears_at_s: float, tick: int
) -> None:
    room = with_obstacles(at_the_box, replace(BLOCK, appears_at_s=appears_at_s)).room
    waiting = Waiting(room, at_the_box.box, ROBOT)

    first = next(t for t in range(1, 100) if waiting.take_due(t, AWAY, AWAY))

    assert first == tick
    assert waiting.next_tick == NEVER


def test_an_obstacle_waits_while_robot_or_box_is_near_its_place(at_the_box: Scenario) -> None:
    room = with_obstacles(at_the_box, BLOCK).room
    waiting = Waiting(room, at_the_box.box, ROBOT)

    def at_x(x_m: float) -> Pose2:
        return Pose2(x_m=x_m, y_m=5.0, yaw_rad=0.0)

    half_length_m = at_the_box.box.size_m[0] / 2
    assert waiting.take_due(60, at_x(4.2), AWAY) == []
    assert waiting.take_due(61, at_x(4.0 - robot_clearance_m(ROBOT) + 0.001), AWAY) == []
    assert waiting.take_due(62, AWAY, at_x(4.2)) == []
    assert waiting.take_due(63, AWAY, at_x(4.0 - half_length_m - BOX_CLEARANCE_M + 0.001)) == []
    near = at_x(4.0 - half_length_m - BOX_CLEARANCE_M - 0.001)
    assert waiting.take_due(64, at_x(4.0 - robot_clearance_m(ROBOT) - 0.001), near) == [0]
    assert waiting.take_due(65, AWAY, AWAY) == []


def test_each_obstacle_appears_by_itself_and_those_from_the_start_never_do(at_the_box: Scenario) -> None:
    later = [replace(BLOCK, appears_at_s=at_s) for at_s in (3.0, 1.0)]
    room = with_obstacles(at_the_box, later[0], replace(BLOCK, appears_at_s=0.0), later[1]).room
    waiting = Waiting(room, at_the_box.box, ROBOT)

    assert waiting.indices == (0, 2)
    assert waiting.next_tick == 50
    assert [waiting.take_due(tick, AWAY, AWAY) for tick in (49, 50, 149, 150)] == [[], [2], [], [0]]


# -- before and after ------------------------------------------------------------------------------------------------


def test_what_has_not_appeared_changes_no_motion_though_the_box_is_pushed_through_its_place(
    at_the_box: Scenario,
) -> None:
    front_m = at_the_box.box.pose.x_m + 0.2
    ahead = replace(BLOCK, x_min_m=front_m + 0.02, appears_at_s=1000.0)
    motions = [PUSH, replace(PUSH, leg="FR")]

    empty = perform(Simulator(), with_obstacles(at_the_box), motions)
    parked = perform(Simulator(), with_obstacles(at_the_box, ahead), motions)

    assert empty[-1].world.box.position_m[0] > at_the_box.box.pose.x_m + 0.04
    assert [outcome.world for outcome in parked] == [outcome.world for outcome in empty]
    assert [outcome.trace for outcome in parked] == [outcome.trace for outcome in empty]


def test_it_is_nowhere_before_and_in_its_place_after(at_the_box: Scenario) -> None:
    scenario = with_obstacles(at_the_box, replace(BLOCK, appears_at_s=0.1))
    physics = Physics(scenario, at_the_box.start.pose(), at_the_box.box.pose.pose())

    stand(physics, 4)
    assert geom_below(physics, 4.2, 5.0) == "floor"
    assert not physics.appeared

    stand(physics, 3)
    assert geom_below(physics, 4.2, 5.0) == "wall_0"
    assert geom_below(physics, 4.6, 5.0) == "floor"
    assert physics.appeared == (Appearance(obstacle=0, tick=5),)
    np.testing.assert_allclose(physics.data.geom("wall_0").xpos, [4.25, 5.0, 0.3])


@pytest.mark.parametrize(("appears_at_s", "is_stopped"), [(0.02, True), (1000.0, False)])
def test_a_box_that_slides_is_stopped_by_what_has_appeared(
    at_the_box: Scenario, appears_at_s: float, is_stopped: bool
) -> None:
    box = at_the_box.box.pose
    front_m = box.x_m + 0.2
    wall = replace(BLOCK, x_min_m=front_m + 0.25, x_max_m=front_m + 0.5, appears_at_s=appears_at_s)
    physics = Physics(with_obstacles(at_the_box, wall), at_the_box.start.pose(), box.pose())
    physics.data.qvel[18] = 2.5

    stand(physics, 100)

    moved_m = physics.box_pose().x_m - box.x_m
    assert moved_m > 0.15
    assert (moved_m < 0.26) == is_stopped


def test_the_observation_says_what_has_appeared_and_when_and_it_stays(at_the_box: Scenario) -> None:
    behind = Rectangle(x_min_m=2.0, x_max_m=2.2, y_min_m=4.8, y_max_m=5.2, appears_at_s=0.5)
    scenario = with_obstacles(at_the_box, behind, BLOCK)
    box_away = replace(scenario, box=replace(scenario.box, pose=replace(scenario.box.pose, x_m=8.0)))

    outcomes = perform(Simulator(), box_away, [BACK, Walk(), Walk(), Walk(), Walk()])

    assert outcomes[0].world.appeared == outcomes[1].world.appeared == ()
    first = Appearance(obstacle=1, tick=round(BLOCK.appears_at_s / CONTROL_PERIOD_S))
    assert outcomes[2].world.appeared == (first,)
    _, second = outcomes[-1].world.appeared
    assert second.obstacle == 0
    ticks = {tick: qpos for o in outcomes if o.trace for tick, qpos in zip(o.trace.tick, o.trace.qpos, strict=True)}
    assert ticks[second.tick][0] <= 2.0 - robot_clearance_m(ROBOT) < ticks[second.tick - 1][0]


def test_equal_actions_lead_to_equal_states_and_a_reset_puts_everything_back(at_the_box: Scenario) -> None:
    scenario = with_obstacles(at_the_box, replace(BLOCK, y_min_m=7.0, y_max_m=8.0, appears_at_s=0.5))
    motions = [PUSH, replace(PUSH, leg="FR")]
    simulator = Simulator()

    first, again = perform(simulator, scenario, motions), perform(simulator, scenario, motions)
    elsewhere = perform(Simulator(), scenario, motions)

    assert again == elsewhere == first
    assert [len(outcome.world.appeared) for outcome in again] == [0, 1, 1]


def test_whether_something_has_appeared_is_part_of_the_state(at_the_box: Scenario) -> None:
    there = replace(BLOCK, y_min_m=7.0, y_max_m=8.0, appears_at_s=0.5)
    worlds = [with_obstacles(at_the_box, replace(there, appears_at_s=at_s)) for at_s in (0.5, 1000.0)]

    appeared, parked = (perform(Simulator(), world, [PUSH]) for world in worlds)

    assert appeared[0].state_crc == parked[0].state_crc
    assert appeared[1].state_crc != parked[1].state_crc
    assert appeared[1].trace == parked[1].trace
