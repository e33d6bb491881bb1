"""A world that is moved step by step, as in a notebook."""

import numpy as np
import pytest

import legpush
from legpush.errors import MotionError
from legpush.plans.trunk_queries import query_to_pose


def test_a_path_is_planned_and_walked_and_the_box_is_pushed() -> None:
    with legpush.world("default", seed=0) as world:
        plan = world.plan("rear")
        assert plan.status == "exact"
        assert world.follow(plan).world.tick == 0
        n_cycles = 0
        while not world.walk().world.path.done:  # type: ignore[union-attr]
            n_cycles += 1
        assert n_cycles > 10
        before = world.box
        outcome = world.push(leg="FL", depth_m=0.05)
        assert outcome is world.outcome
        assert outcome.world.push is not None
        assert outcome.world.push.touched
        moved = before.inverse() @ world.box
        assert 0.02 < moved.x_m < 0.06


def test_a_path_to_a_pose_ends_there_and_a_query_is_asked_as_it_is() -> None:
    with legpush.world("default") as world:
        goal = legpush.Pose2(x_m=world.trunk.x_m + 1.0, y_m=world.trunk.y_m, yaw_rad=0.5)
        plan = world.plan(goal)
        assert plan.waypoints[-1] == goal
        query = query_to_pose(world.scenario, world.seed, world.trunk, goal, world.box)
        assert world.plan(query) == plan


def test_a_reset_begins_the_episode_again_and_draws_from_another_seed() -> None:
    with legpush.world("push", seed=1) as world:
        first = world.outcome.state_crc
        world.push()
        assert world.reset().state_crc == first
        assert world.reset(seed=2).state_crc != first
        assert world.seed == 2


def test_the_box_can_be_altered_and_a_motion_that_is_not_possible_is_refused() -> None:
    with legpush.world("push") as world:
        light = world.push(depth_m=0.08).world.push
        world.reset()
        world.alter(box_mass_kg=5.0)
        heavy = world.push(depth_m=0.08).world.push
        assert light is not None
        assert heavy is not None
        assert heavy.peak_force_n > 2 * light.peak_force_n
        crc = world.outcome.state_crc
        with pytest.raises(MotionError, match="follow"):
            world.walk()
        assert world.outcome.state_crc == crc


def test_outcomes_have_traces_where_they_are_asked_for() -> None:
    with legpush.world("push", trace=True) as world:
        trace = world.push().trace
        assert trace is not None
        assert np.array(trace.qpos).shape[0] == world.state.tick
    with legpush.world("push") as world:
        assert world.push().trace is None
