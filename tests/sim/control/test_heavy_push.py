"""Pushes of heavy boxes: slow, and with the force that they take."""

from math import degrees

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.arrays import Floats
from legpush.messages.stepping import Push, Reset
from legpush.realism.settings import Profile, Realism
from legpush.scene.conventions import FrontLeg
from legpush.scene.scenario import Scenario
from sim_proc.control.posture import Posture
from sim_proc.control.push_cycle import Pusher
from sim_proc.control.steps import Steps
from sim_proc.control.watch import Watch
from sim_proc.simulator import Simulator
from tests.robots import ROBOT
from tests.sim.control.kinematic_plant import KinematicPlant

N_FOOTSTEPS = 4
"""Of a push cycle without capture steps."""


def heavy(scenario: Scenario, mass_kg: float) -> Scenario:
    """The box with another mass."""
    return replace(scenario, box=replace(scenario.box, mass_kg=mass_kg))


def first_torques(scenario: Scenario, leg: FrontLeg) -> tuple[Floats, Pusher]:
    """Torques that are commanded in the push of a plant without physics, (n, 12), and what has pushed."""
    plant = KinematicPlant(scenario.start.pose(), scenario.box)
    pusher = Pusher(Steps(Posture(plant)), scenario.box)
    log = pusher.cycle(Push(w1=0.5, w2=0.5, leg=leg, depth_m=0.05), (0.5, 0.5)).logs[0]
    return log.steps.joint_torques_n_m[:, -1], pusher


def test_a_heavy_box_is_pushed_as_deep_as_a_light_one_but_more_slowly(at_the_box: Scenario) -> None:
    heavy_box = heavy(at_the_box, 20.0).box
    plant = KinematicPlant(at_the_box.start.pose(), heavy_box)
    push = Pusher(Steps(Posture(plant)), heavy_box).cycle(Push(w1=0.5, w2=0.5, leg="FR", depth_m=0.05), (0.5, 0.5))
    assert plant.box_pose().x_m - at_the_box.box.pose.x_m == pytest.approx(0.05, abs=1e-3)
    motion = ROBOT.pushing
    slower = motion.approach_ticks + motion.press_ticks + motion.unload_ticks - motion.push_ticks
    light, _ = first_torques(at_the_box, "FR")
    assert len(push.logs[0].qpos) == len(light) + slower


def test_only_the_push_of_a_heavy_box_has_a_force_and_its_mirror_image_for_the_other_leg(at_the_box: Scenario) -> None:
    light, _ = first_torques(at_the_box, "FL")
    left, pusher = first_torques(heavy(at_the_box, 20.0), "FL")
    right, _ = first_torques(heavy(at_the_box, 20.0), "FR")
    hips_left, hips_right = left[:, [1, 4, 7, 10]], right[:, [4, 1, 10, 7]]
    np.testing.assert_allclose(hips_left, hips_right, atol=1e-6)
    assert np.abs(left[:, 1]).max() > np.abs(light[:, 1]).max() + 15.0
    # The plant without physics pushes back with 1 N: the next push knows it.
    assert pusher.resistance.force_n[0] == pytest.approx((0.5 * 20.0 * 9.81 + 1.0) / 2, abs=0.2)


def test_the_force_of_a_push_is_bounded_by_what_the_feet_can_bear(at_the_box: Scenario) -> None:
    bounded, _ = first_torques(heavy(at_the_box, 1000.0), "FL")
    usual, _ = first_torques(heavy(at_the_box, 20.0), "FL")
    assert np.abs(bounded[:, 1]).max() < 2.5 * np.abs(usual[:, 1]).max()


@pytest.mark.parametrize(("profile", "expected_n"), [("ideal", 60.0), ("ideal", 2.0), ("real", 2.0)])
def test_the_push_of_a_box_that_does_not_yield_does_not_end_in_capture_steps(
    at_the_box: Scenario, monkeypatch: pytest.MonkeyPatch, profile: Profile, expected_n: float
) -> None:
    stuck = replace(at_the_box.box, mass_kg=40.0, friction=1.0)
    simulator, beyond, raised = Simulator(), [], Watch.alarm

    def alarm(watch: Watch, com_m: Floats, velocity_m_s: Floats, tips_m: Floats) -> int | None:
        beyond.append(raised(watch, com_m, velocity_m_s, tips_m))
        return beyond[-1]

    simulator.perform(
        Reset(scenario=replace(at_the_box, box=stuck, realism=Realism(profile=profile)), seed=0), with_trace=False
    )
    assert simulator.episode is not None
    simulator.episode.pusher.resistance.force_n = np.array([expected_n, 0.0, 0.0])
    monkeypatch.setattr(Watch, "alarm", alarm)
    outcome = simulator.perform(Push(w1=0.5, w2=0.5, leg="FR", depth_m=0.08), with_trace=False)
    assert any(tick is not None for tick in beyond)
    assert not outcome.world.fallen
    assert outcome.measures is not None
    assert outcome.measures.n_footsteps == N_FOOTSTEPS


def test_pushes_of_a_box_of_20_kg_move_it_and_keep_the_robot_on_its_feet(at_the_box: Scenario) -> None:
    simulator = Simulator()
    before = simulator.perform(Reset(scenario=heavy(at_the_box, 20.0), seed=0), with_trace=False)
    roll_deg = 0.0
    legs: tuple[FrontLeg, ...] = ("FL", "FR", "FL")
    for leg in legs:
        after = simulator.perform(Push(w1=0.5, w2=0.5, leg=leg, depth_m=0.05), with_trace=True)
        assert after.measures is not None
        assert after.trace is not None
        assert after.measures.n_outside_support == 0
        roll_deg = max(roll_deg, degrees(np.abs(after.trace.roll_pitch_rad).max()))
    assert after.world.box.position_m[0] - before.world.box.position_m[0] > 0.08
    assert roll_deg < 1.8


def test_a_box_that_is_expected_to_be_light_and_does_not_move_throws_nobody_over(at_the_box: Scenario) -> None:
    simulator = Simulator()
    stuck = replace(at_the_box, box=replace(at_the_box.box, mass_kg=40.0, friction=1.0))
    simulator.perform(Reset(scenario=stuck, seed=1), with_trace=False)
    assert simulator.episode is not None
    resistance = simulator.episode.pusher.resistance
    resistance.force_n = np.array([2.0, 0.0, 0.0])
    after = simulator.perform(Push(w1=0.5, w2=0.5, leg="FR", depth_m=0.06), with_trace=False)
    assert not after.world.fallen
    assert resistance.force_n[0] > 40.0
