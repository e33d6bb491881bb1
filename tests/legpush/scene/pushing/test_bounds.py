"""Bounds of the force that moves a box, and of that which the robot can push with."""

import pytest
from msgspec.structs import replace

from legpush.scenarios.file import load_scenario
from legpush.scene.pushing.bounds import cannot_push, least_force_n, most_force_n
from legpush.scene.scenario import Scenario

SCENARIO = load_scenario("push")
ROBOT = SCENARIO.robot


def with_box(**fields: float) -> Scenario:
    return replace(SCENARIO, box=replace(SCENARIO.box, **fields))


def test_a_push_beside_the_middle_takes_less_than_the_friction_of_the_box() -> None:
    box = with_box(mass_kg=20.0, friction=0.5).box
    straight_n = 0.5 * 20.0 * 9.81
    assert 0.6 * straight_n < least_force_n(ROBOT, box, "rear", 0.0) < 0.8 * straight_n


def test_the_force_is_in_proportion_to_the_mass_and_less_down_a_slope() -> None:
    light, heavy = (with_box(mass_kg=mass_kg).box for mass_kg in (1.0, 3.0))
    level = least_force_n(ROBOT, light, "rear", 0.0)
    assert least_force_n(ROBOT, heavy, "rear", 0.0) == pytest.approx(3 * level)
    assert 0.0 < least_force_n(ROBOT, light, "rear", 8.0) < level
    assert least_force_n(ROBOT, replace(light, friction=0.01), "rear", 8.0) == 0.0


def test_slippery_feet_and_a_weak_hip_bound_the_force() -> None:
    usual_n = most_force_n(ROBOT, SCENARIO.box, "rear")
    slippery = replace(ROBOT, legs=replace(ROBOT.legs, foot_friction=0.2))
    assert most_force_n(slippery, SCENARIO.box, "rear") == pytest.approx(0.2 * ROBOT.mass_kg * 9.81)
    hip = replace(ROBOT.joints.hip_y, max_torque_n_m=ROBOT.joints.hip_y.max_torque_n_m / 2)
    weak = replace(ROBOT, joints=replace(ROBOT.joints, hip_y=hip))
    assert most_force_n(weak, SCENARIO.box, "rear") == pytest.approx(usual_n / 2)


@pytest.mark.parametrize(
    ("mass_kg", "friction", "is_refused"),
    [(0.1, 0.5, False), (30.0, 0.5, False), (20.0, 1.0, False), (60.0, 0.5, True), (40.0, 1.0, True)],
)
def test_a_box_is_refused_with_both_forces_once_no_face_can_be_pushed(
    mass_kg: float, friction: float, is_refused: bool
) -> None:
    why = cannot_push(with_box(mass_kg=mass_kg, friction=friction))
    assert (why is not None) == is_refused
    if why is not None:
        assert f"the box of {mass_kg:g} kg with friction {friction:g} takes at least" in why
        assert "N at most" in why
