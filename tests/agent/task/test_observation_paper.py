"""The observation of Eq. 18: the vector says what its table says."""

import numpy as np
from msgspec.structs import replace

from agent_proc.frames.push_view import push_view
from agent_proc.task.observation_paper import PAPER
from agent_proc.task.observation_table import as_markdown, bounds, read_table
from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.messages.stepping import WorldState
from legpush.scene.conventions import LEGS
from tests.agent.fake_world import make_scenario, make_state

SCENARIO = make_scenario()
TRUNK = Pose2(x_m=5.0, y_m=2.0, yaw_rad=0.3)
BOX = Pose2(x_m=6.0, y_m=3.0, yaw_rad=np.pi / 2)


def observe(world: WorldState) -> Floats:
    return read_table(PAPER, push_view(world, SCENARIO))


def test_the_observation_has_25_elements_in_the_order_of_the_paper() -> None:
    names = [entry.name for entry in PAPER]

    assert sum(entry.size for entry in PAPER) == 25 == len(observe(make_state(TRUNK, BOX)))
    assert names == [
        "body",
        "box_corner_1",
        "box_corner_2",
        *(f"tip_{leg}" for leg in LEGS),
        "goal_corner_1",
        "goal_corner_2",
    ]


def test_each_entry_of_the_table_reads_what_its_name_says() -> None:
    world = make_state(TRUNK, BOX)
    observation = observe(world)
    places = np.cumsum([0, *(entry.size for entry in PAPER)])
    values = {entry.name: observation[places[i] : places[i + 1]] for i, entry in enumerate(PAPER)}

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

    observation = observe(replace(world, box=tilted))

    np.testing.assert_allclose(observation[5], 0.2 + 0.2 * np.sin(pitch) + 0.2 * np.cos(pitch))


def test_the_bounds_hold_the_observation_and_follow_the_room() -> None:
    low, high = bounds(PAPER, SCENARIO)
    observation = observe(make_state(TRUNK, BOX))

    assert low.shape == high.shape == observation.shape
    assert (low < observation).all()
    assert (observation < high).all()
    np.testing.assert_allclose(high[:3], [13.0, 7.0, 1.4])


def test_the_observation_shares_no_memory_with_the_next_one() -> None:
    world = make_state(TRUNK, BOX)
    first = observe(world)
    second = observe(world)

    assert not np.shares_memory(first, second)
    np.testing.assert_array_equal(first, second)


def test_the_documentation_lists_every_entry_with_its_elements() -> None:
    lines = as_markdown(PAPER).splitlines()

    rows = [line for line in lines if "`" in line]
    assert len(rows) == len(PAPER)
    assert rows[0] == "| 0 to 2 | `body` | xyz | m | world | trunk centre |"
    assert rows[-1].startswith("| 23 to 24 | `goal_corner_2` | xy |")
