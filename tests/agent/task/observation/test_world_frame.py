"""The observation of Eq. 19, and what the published code reads: each term reads what its name says."""

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.frames.push_view import push_view
from agent_proc.task.file import load_task
from agent_proc.task.observation.world_frame import BoxCorner, FootForces
from agent_proc.task.observed import observe
from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.messages.stepping import WorldState
from legpush.scene.conventions import LEGS
from legpush.scene.scenario import Box, PoseDeg
from tests.agent.fake_world import make_scenario, make_state

SCENARIO = make_scenario()
TRUNK = Pose2(x_m=5.0, y_m=2.0, yaw_rad=0.3)
BOX = Pose2(x_m=6.0, y_m=3.0, yaw_rad=np.pi / 2)
PAPER = load_task("paper-text", SCENARIO)


def seen(world: WorldState) -> dict[str, Floats]:
    """The parts of the observation by the names of their terms."""
    view = push_view(world, SCENARIO)
    return {name: term.read(view, 1.0) for name, term in PAPER.observation_terms.items()}


def test_the_observation_has_25_elements_in_the_order_of_the_paper() -> None:
    values = seen(make_state(TRUNK, BOX))

    assert list(values) == [
        "body",
        "box_corner_1",
        "box_corner_2",
        *(f"tip_{leg}" for leg in LEGS),
        "goal_corner_1",
        "goal_corner_2",
    ]
    assert sum(map(len, values.values())) == 25


def test_each_term_reads_what_its_name_says() -> None:
    world = make_state(TRUNK, BOX)
    values = seen(world)

    np.testing.assert_allclose(values["body"], world.trunk.position_m)
    # A box of 0.4 m x 0.5 m x 0.4 m that looks along y: its front left corner is at lower x.
    np.testing.assert_allclose(values["box_corner_1"], [6.0 - 0.25, 3.0 + 0.2, 0.4])
    np.testing.assert_allclose(values["box_corner_2"], [6.0 + 0.25, 3.0 + 0.2, 0.4])
    for index, leg in enumerate(LEGS):
        np.testing.assert_allclose(values[f"tip_{leg}"], world.tips_m[index])
    np.testing.assert_allclose(values["goal_corner_1"], [7.2, 3.25])
    np.testing.assert_allclose(values["goal_corner_2"], [7.2, 2.75])


def test_a_tilted_box_lifts_its_corners() -> None:
    world = make_state(TRUNK, BOX)
    pitch = 0.1
    tilted = replace(
        world.box, position_m=(6.0, 3.0, 0.2), orientation_wxyz=(np.cos(pitch / 2), 0.0, -np.sin(pitch / 2), 0.0)
    )
    corner = seen(replace(world, box=tilted))["box_corner_1"]

    np.testing.assert_allclose(corner[2], 0.2 + 0.2 * np.sin(pitch) + 0.2 * np.cos(pitch))


def test_frozen_corners_are_those_of_the_box_where_the_scenario_puts_it() -> None:
    turned = make_scenario(box=Box(pose=PoseDeg(x_m=6.0, y_m=3.0, yaw_deg=90.0)))
    moved, there = (push_view(make_state(TRUNK, Pose2(x_m=x, y_m=3.0, yaw_rad=np.pi / 2)), turned) for x in (7.0, 6.0))

    for corner in (1, 2):
        live, frozen = BoxCorner(corner=corner), BoxCorner(corner=corner, frozen=True)
        np.testing.assert_allclose(frozen.read(moved, 1.0), live.read(there, 1.0), atol=1e-12)
        assert abs(live.read(moved, 1.0) - live.read(there, 1.0)).max() == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("forces", "expected"),
    [((80.0, 40.0, 160.0, 0.0), (0.5, 0.25, 1.0, 0.0)), ((0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0))],
)
def test_forces_are_read_in_newtons_or_over_the_largest(
    forces: tuple[float, float, float, float], expected: tuple[float, ...]
) -> None:
    view = push_view(replace(make_state(TRUNK, BOX), foot_forces_n=forces), SCENARIO)

    np.testing.assert_array_equal(FootForces().read(view, 1.0), forces)
    np.testing.assert_array_equal(FootForces(by_largest=True).read(view, 1.0), expected)


def test_the_observation_shares_no_memory_with_the_next_one() -> None:
    view = push_view(make_state(TRUNK, BOX), SCENARIO)
    first, second = observe(PAPER, view), observe(PAPER, view)

    assert not np.shares_memory(first, second)
    np.testing.assert_array_equal(first, second)
