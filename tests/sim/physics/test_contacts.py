"""Contacts that no plan asked for: which they are, and in how many steps they last."""

from collections import Counter

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.errors import MotionError
from legpush.messages.stepping import Push, Reset
from legpush.scene.conventions import JOINT_QPOS
from legpush.scene.scenario import Box, Rectangle, Scenario
from sim_proc.headless import mujoco
from sim_proc.physics.physics import Physics
from sim_proc.simulator import Simulator
from tests.sim.commands import held


def physics_with(scenario: Scenario) -> Physics:
    return Physics(scenario, scenario.start.pose(), scenario.box.pose.pose())


def stand(physics: Physics, n_ticks: int) -> None:
    physics.run(held(np.repeat(physics.data.qpos[JOINT_QPOS][None], n_ticks, axis=0)))


def walled(scenario: Scenario, x_m: float, y_m: float, size_m: float = 0.1) -> Scenario:
    """The scenario with a pillar whose near corner is at a place."""
    pillar = Rectangle(x_min_m=x_m, x_max_m=x_m + size_m, y_min_m=y_m, y_max_m=y_m + size_m)
    return replace(scenario, room=replace(scenario.room, obstacles=(pillar,)))


def touching_pairs(physics: Physics) -> set[tuple[str, str]]:
    """Pairs of geoms that touch now, in alphabetical order."""
    mujoco.mj_forward(physics.model, physics.data)
    return pairs_of(physics)


def pairs_of(physics: Physics) -> set[tuple[str, str]]:
    """Pairs of geoms that touched in the last step, in alphabetical order."""
    names = [sorted(physics.model.geom(int(geom)).name for geom in pair) for pair in physics.data.contact.geom]
    return {(first, second) for first, second in names}


def test_feet_on_the_floor_and_the_box_on_the_floor_are_expected(at_the_box: Scenario) -> None:
    physics = physics_with(at_the_box)
    stand(physics, 5)
    assert touching_pairs(physics)
    assert physics.contacts.found() == ()
    assert physics.contacts.n_steps == 0


@pytest.mark.parametrize("shape", ["cuboid", "l_shape"])
def test_a_box_in_a_wall_is_counted_in_each_step_with_its_force(at_the_box: Scenario, shape: str) -> None:
    box = Box(shape=shape, pose=at_the_box.box.pose)  # type: ignore[arg-type]
    scenario = walled(replace(at_the_box, box=box), box.pose.x_m - 0.1, 5.249)
    physics = physics_with(scenario)
    stand(physics, 1)
    (contact, *others) = physics.contacts.found()
    assert (contact.first.partition("_")[0], contact.second) == ("box", "wall_0")
    assert contact.n_steps >= 1
    assert contact.max_force_n > 0.0
    assert all(each.n_steps <= contact.n_steps for each in others)
    assert physics.contacts.n_steps >= contact.n_steps


def test_a_leg_in_a_wall_is_counted_in_each_of_the_steps(at_the_box: Scenario) -> None:
    """Counted a second time in bare steps, with a look at all contacts after each."""
    scenario = walled(at_the_box, 2.25, 5.18)
    physics, bare = physics_with(scenario), physics_with(scenario)
    controls = physics.run(held(np.repeat(physics.data.qpos[JOINT_QPOS][None], 3, axis=0))).ctrl
    counts: Counter[tuple[str, str]] = Counter()
    n_steps = 0
    for control in controls.reshape(-1, 12):
        bare.data.ctrl[:] = control
        mujoco.mj_step(bare.model, bare.data)
        pairs = {pair for pair in pairs_of(bare) if "wall_0" in pair}
        counts.update(pairs)
        n_steps += bool(pairs)
    assert n_steps > 0
    assert physics.contacts.n_steps == n_steps
    assert {(each.first, each.second): each.n_steps for each in physics.contacts.found()} == counts


def test_a_pushing_leg_may_touch_the_box_and_another_may_not(at_the_box: Scenario) -> None:
    for leg, n_pairs in (("FL", 0), ("FR", 1)):
        physics = physics_with(at_the_box)
        physics.contacts.expect(leg)  # type: ignore[arg-type]
        foot = physics.data.site("FL_tip").xpos
        length, width, _ = at_the_box.box.size_m
        physics.data.qpos[19:21] = foot[0] + length / 2 + 0.015, foot[1] + width / 2 - 0.03
        stand(physics, 1)
        found = physics.contacts.found()
        assert [(each.first, each.second) for each in found] == [("FL_foot", "box")][:n_pairs]
        assert physics.contacts.suspects(physics.data.sensordata) == bool(n_pairs)


@pytest.mark.parametrize("is_walled", [False, True])
def test_the_numbers_of_contacts_tell_whether_to_look_at_them(is_walled: bool, at_the_box: Scenario) -> None:
    physics = physics_with(walled(at_the_box, 2.25, 5.18) if is_walled else at_the_box)
    stand(physics, 1)
    assert physics.contacts.suspects(physics.data.sensordata) == is_walled


def test_a_motion_that_is_simulated_again_is_counted_once(at_the_box: Scenario) -> None:
    """A motion beyond the limits of the actuators is simulated a second time, with them."""
    scenario = walled(at_the_box, 2.25, 5.18)
    physics = physics_with(scenario)
    targets = np.repeat(physics.data.qpos[JOINT_QPOS][None], 2, axis=0)
    targets[:, 2] += [0.5, 1.0]
    physics.run(held(targets))
    assert 0 < physics.contacts.n_steps <= 20


def test_each_motion_is_counted_by_itself(at_the_box: Scenario) -> None:
    physics = physics_with(walled(at_the_box, 2.25, 5.18))
    stand(physics, 1)
    assert physics.contacts.n_steps > 0
    physics.contacts.expect(None)
    assert (physics.contacts.n_steps, physics.contacts.found()) == (0, ())


def test_a_box_that_is_pushed_along_a_wall_is_told_in_the_measures_of_each_push(at_the_box: Scenario) -> None:
    _, width, _ = at_the_box.box.size_m
    scenario = walled(at_the_box, at_the_box.box.pose.x_m - 0.1, at_the_box.box.pose.y_m + width / 2 - 0.001, 1.0)
    simulator = Simulator()
    simulator.perform(Reset(scenario=scenario, seed=0), with_trace=False)
    for _ in range(2):
        push = Push(w1=0.3, w2=0.7, leg="FR", depth_m=0.03)
        measures = simulator.perform(push, with_trace=False).measures
        assert measures is not None
        assert ("box", "wall_0") in [(each.first, each.second) for each in measures.unexpected]
        assert 0 < measures.n_unexpected_steps <= measures.n_steps


def test_a_usual_push_has_no_unexpected_contact(at_the_box: Scenario) -> None:
    simulator = Simulator()
    simulator.perform(Reset(scenario=at_the_box, seed=0), with_trace=False)
    measures = simulator.perform(Push(w1=0.3, w2=0.7, leg="FR", depth_m=0.05), with_trace=False).measures
    assert measures is not None
    assert (measures.n_unexpected_steps, measures.unexpected) == (0, ())


@pytest.mark.parametrize(
    ("place", "match"),
    [
        ((4.5, 5.0), r"apart at the start, got `\w+` 0\.\d+ m deep in `\w+`"),
        ((2.0, 5.0), r"deep in `wall_0`|`wall_0` 0\.\d+ m deep"),
    ],
)
def test_a_robot_in_the_box_or_in_a_wall_cannot_begin(
    at_the_box: Scenario, place: tuple[float, float], match: str
) -> None:
    wall = Rectangle(x_min_m=2.0, x_max_m=2.2, y_min_m=4.0, y_max_m=6.0)
    x_m, y_m = place
    box = replace(at_the_box.box, pose=replace(at_the_box.box.pose, x_m=4.5, y_m=5.0))
    scenario = replace(
        at_the_box,
        room=replace(at_the_box.room, obstacles=(wall,)),
        box=box,
        start=replace(at_the_box.start, x_m=x_m, y_m=y_m),
    )
    simulator = Simulator()
    with pytest.raises(MotionError, match=match):
        simulator.perform(Reset(scenario=scenario, seed=0), with_trace=False)
    assert simulator.episode is None
