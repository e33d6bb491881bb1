"""Single steps, on a plant without physics."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.scene.conventions import LEGS, Leg
from legpush.scene.scenario import Box, PoseDeg
from sim_proc.control.gait import swing_to
from sim_proc.control.plant import TickLog
from sim_proc.control.posture import Posture
from sim_proc.control.push_force import PushForce
from sim_proc.control.step import Step
from sim_proc.control.step_motion import CAUTION
from sim_proc.control.steps import Steps
from tests.robots import ROBOT
from tests.sim.control.kinematic_plant import KinematicPlant

FAR_BOX = Box(pose=PoseDeg(x_m=9.0, y_m=9.0, yaw_deg=0.0))
SWING_TICKS = 13


@pytest.fixture
def steps() -> Steps:
    return Steps(Posture(KinematicPlant(Pose2(x_m=2.0, y_m=5.0, yaw_rad=0.0), FAR_BOX)))


def ahead(steps: Steps, leg: Leg, forward_m: float, shift_ticks: int = 16) -> Step:
    """A step of a leg by a distance ahead, while the trunk stays."""
    return Step(
        leg=leg,
        shift_ticks=shift_ticks,
        swing_ticks=SWING_TICKS,
        target_m=steps.posture.feet_m[LEGS.index(leg), :2] + [forward_m, 0.0],
        nominal_xy_m=np.array([2.0, 5.0]),
        end_velocity_m_s=np.zeros(2),
        end_yaw_rad=0.0,
        margin_m=0.055,
    )


@pytest.mark.parametrize("leg", LEGS)
def test_a_step_moves_one_foot_and_leaves_the_others_down(steps: Steps, leg: Leg) -> None:
    before = steps.posture.plant.tips_m()
    step = ahead(steps, leg, 0.1)

    log = steps.take_step([step], swing_to(ROBOT, step.target_m, SWING_TICKS))

    moved = steps.posture.plant.tips_m()[:, :2] - before[:, :2]
    expected = np.zeros((4, 2))
    expected[LEGS.index(leg), 0] = 0.1
    np.testing.assert_allclose(moved, expected, atol=1e-3)
    assert (steps.n_footsteps, steps.landed) == (1, LEGS.index(leg))
    longest = max(longer for longer, _ in CAUTION)
    assert step.n_ticks <= len(log.ctrl) <= step.n_ticks + longest


def test_the_com_is_over_the_other_feet_while_a_leg_swings(steps: Steps) -> None:
    step = ahead(steps, "FL", 0.1)
    log = steps.take_step([step], swing_to(ROBOT, step.target_m, SWING_TICKS))
    com, centre = log.com_m[-SWING_TICKS:, :2], log.tips_m[-SWING_TICKS:, 1:, :2].mean(axis=1)
    assert (com[:, 0] < 2.0).all()
    assert (com[:, 1] < 5.0).all()
    assert (np.linalg.norm(com - centre, axis=1) < 0.2).all()


def test_a_shift_that_is_too_short_for_a_stable_lift_is_made_longer(steps: Steps) -> None:
    step = ahead(steps, "FL", 0.1, shift_ticks=2)
    log = steps.take_step([step], swing_to(ROBOT, step.target_m, SWING_TICKS))
    assert len(log.ctrl) > step.n_ticks


def test_a_foot_that_does_not_land_is_no_footstep_and_goes_on_without_a_shift(steps: Steps) -> None:
    step = ahead(steps, "FR", 0.1)

    def half_way(start_m: Floats) -> Floats:
        return swing_to(ROBOT, step.target_m, 2 * SWING_TICKS)(start_m)[:SWING_TICKS]

    steps.take_step([step], half_way, lands=False)
    assert (steps.n_footsteps, steps.landed) == (0, None)
    assert steps.posture.plant.tips_m()[1, 2] > 0.05

    steps.take_step([replace(step, shift_ticks=0)], swing_to(ROBOT, step.target_m, SWING_TICKS))
    assert (steps.n_footsteps, steps.landed) == (1, 1)
    np.testing.assert_allclose(steps.posture.plant.tips_m()[1, :2], step.target_m, atol=1e-3)


def test_a_foot_that_stays_in_the_air_does_not_step_again_where_another_one_missed_its_place(
    steps: Steps, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A push broke off here: the second step had the ticks of the push, and another number of its own."""
    step = replace(ahead(steps, "FR", 0.1), push=PushForce(leg=1, force_n=np.zeros((SWING_TICKS, 3)), height_m=0.2))
    lift, lifted = steps._lift_and_swing, []

    def beside_another(*args: Any, **kwargs: Any) -> TickLog:
        lifted.append(kwargs["lands"])
        log = lift(*args, **kwargs)
        steps._missed = True
        return log

    monkeypatch.setattr(steps, "_lift_and_swing", beside_another)
    steps.take_step([step], swing_to(ROBOT, step.target_m, SWING_TICKS), lands=False)

    assert lifted == [False]


def test_a_turn_ends_at_its_yaw(steps: Steps) -> None:
    step = replace(ahead(steps, "RL", 0.0), end_yaw_rad=0.1)
    steps.take_step([step], swing_to(ROBOT, step.target_m, SWING_TICKS))
    assert steps.posture.plant.trunk_pose().yaw_rad == pytest.approx(0.1, abs=1e-6)
