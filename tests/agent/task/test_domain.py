"""What episodes draw: within their intervals, in the direction of the scenario, and nothing where nothing is given."""

from math import cos, hypot, radians, sin
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from agent_proc.task.domain import Domain
from agent_proc.task.drawn import drawn_scenario, scenario_of_start
from agent_proc.task.file import load_task
from legpush.errors import ConfigError
from legpush.realism.settings import Randomization
from legpush.scenarios.checks import check_scenario
from legpush.scene.scenario import Goal, PoseDeg
from legpush.scene.station import at_station
from tests.agent.fake_world import make_scenario

SCENARIO = make_scenario(randomization=Randomization(box_xy_m=0.05, box_yaw_deg=5.0))
"""The box is at (6, 3), the goal at (7, 3), heading along x."""


@pytest.mark.parametrize("interval", [(0.0, 1.0), (2.0, 1.0), (-1.0, 1.0)])
def test_a_domain_holds_positive_intervals_only(interval: tuple[float, float]) -> None:
    with pytest.raises(ConfigError, match="mass_kg of the domain"):
        Domain(mass_kg=interval)


def test_an_angle_may_be_negative_but_its_interval_is_not_empty() -> None:
    assert Domain(goal_bearing_deg=(-20.0, 20.0)).goal_bearing_deg == (-20.0, 20.0)
    with pytest.raises(ConfigError, match="goal_yaw_deg"):
        Domain(goal_yaw_deg=(1.0, -1.0))


def test_nothing_is_drawn_where_nothing_is_given() -> None:
    random = np.random.default_rng(0)

    assert drawn_scenario(Domain(), SCENARIO, random) == SCENARIO
    assert random.random() == np.random.default_rng(0).random()


@given(
    seed=st.integers(0, 99),
    mass=st.floats(0.1, 2.0),
    low_m=st.floats(0.1, 0.5),
    bearing_deg=st.floats(0.0, 90.0),
    yaw_deg=st.floats(0.0, 90.0),
)
def test_what_is_drawn_is_within_its_interval(
    seed: int, mass: float, low_m: float, bearing_deg: float, yaw_deg: float
) -> None:
    domain = Domain(
        mass_kg=(mass, 2 * mass),
        distance_m=(low_m, 1.0),
        goal_bearing_deg=(-bearing_deg, bearing_deg),
        goal_yaw_deg=(-yaw_deg, yaw_deg),
    )
    drawn = drawn_scenario(domain, SCENARIO, np.random.default_rng(seed))
    x_m, y_m = drawn.goal.pose.x_m - 6.0, drawn.goal.pose.y_m - 3.0

    assert mass <= drawn.box.mass_kg <= 2 * mass
    assert low_m - 1e-9 <= hypot(x_m, y_m) <= 1.0 + 1e-9
    assert abs(np.degrees(np.arctan2(y_m, x_m))) <= bearing_deg + 1e-9
    assert abs(drawn.goal.pose.yaw_deg) <= yaw_deg + 1e-9


def test_a_goal_is_turned_about_the_box() -> None:
    scenario = make_scenario(goal=Goal(pose=PoseDeg(x_m=6.0, y_m=5.0, yaw_deg=90.0)))
    domain = Domain(goal_bearing_deg=(30.0, 30.0), goal_yaw_deg=(-10.0, -10.0))
    goal = drawn_scenario(domain, scenario, np.random.default_rng(0)).goal.pose

    assert (goal.x_m, goal.y_m) == pytest.approx((6.0 + 2 * cos(radians(120.0)), 3.0 + 2 * sin(radians(120.0))))
    assert goal.yaw_deg == pytest.approx(80.0)


@pytest.mark.parametrize(
    ("fields", "offsets"),
    [
        ({"box_xy_m": 0.0}, Randomization(box_xy_m=0.0, box_yaw_deg=5.0)),
        ({"box_yaw_deg": 25.0, "start_xy_m": 0.1}, Randomization(box_xy_m=0.05, box_yaw_deg=25.0, start_xy_m=0.1)),
    ],
)
def test_offsets_of_starts_replace_those_of_the_scenario(fields: dict[str, Any], offsets: Randomization) -> None:
    drawn = drawn_scenario(Domain(**fields), SCENARIO, np.random.default_rng(0))

    assert drawn.randomization == offsets


@given(seed=st.integers(0, 999))
def test_unknown_boxes_can_be_made_and_the_robot_stands_ready_behind_them(seed: int) -> None:
    task = load_task("push-l2")
    drawn = drawn_scenario(task.domain, task.scenario, np.random.default_rng(seed))
    box = drawn.box

    assert all(0.3 <= side <= 0.6 for side in box.size_m[:2])
    assert box.size_m[2] == task.scenario.box.size_m[2]
    assert 0.1 <= box.mass_kg <= 10.0
    assert 0.2 <= box.friction <= 1.0
    assert all(abs(offset) <= 0.1 for offset in box.com_offset_m)
    assert at_station(drawn.robot, drawn.start.pose(), box, box.pose.pose())
    check_scenario(drawn, "drawn")


def test_all_shapes_are_drawn_and_independent_of_the_mass() -> None:
    task = load_task("push-l2")
    boxes = [drawn_scenario(task.domain, task.scenario, np.random.default_rng(seed)).box for seed in range(200)]
    shapes = {box.shape for box in boxes}
    assert shapes == {"cuboid", "cylinder", "wedge", "l_shape"}
    means = [np.mean([box.mass_kg for box in boxes if box.shape == shape]) for shape in shapes]
    assert max(means) - min(means) < 2.5


def test_floors_rise_in_any_direction() -> None:
    task = load_task("push-l3")
    rooms = [drawn_scenario(task.domain, task.scenario, np.random.default_rng(seed)).room for seed in range(100)]
    assert all(0.0 <= room.slope_deg <= 5.0 for room in rooms)
    assert max(room.slope_deg for room in rooms) > 4.5
    assert min(room.uphill_deg for room in rooms) < -150.0 < 150.0 < max(room.uphill_deg for room in rooms)


def test_a_box_that_cannot_be_made_is_refused() -> None:
    domain = Domain(side_m=(0.3, 0.3), com_offset_m=(0.2, 0.2))
    with pytest.raises(ConfigError, match="got none in 100 draws"):
        drawn_scenario(domain, SCENARIO, np.random.default_rng(0))


def test_a_start_has_what_its_seed_draws_and_as_many_cycles_as_the_task_has_steps() -> None:
    task = load_task("push-l1")
    starts = [scenario_of_start(task, seed) for seed in (1, 1, 2)]
    assert starts[0] == starts[1] != starts[2]
    assert {start.mission.max_push_cycles for start in starts} == {task.max_steps}
