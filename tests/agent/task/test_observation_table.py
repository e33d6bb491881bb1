"""Observation tables: vector, bounds, names and documentation follow from the entries."""

import numpy as np

from agent_proc.frames.push_view import push_view
from agent_proc.task.observation_table import BEYOND_M, Entry, as_markdown, bounds, element_names, read_table
from legpush.geometry import Pose2
from tests.agent.fake_world import make_scenario, make_state

SCENARIO = make_scenario()
VIEW = push_view(
    make_state(Pose2(x_m=5.0, y_m=3.0, yaw_rad=0.0), Pose2(x_m=6.0, y_m=2.9, yaw_rad=0.0), tick=7), SCENARIO
)
TABLE = (
    Entry(name="place", axes="xy", size=2, read=lambda view: view.box_w.xy(), meaning="where the box is"),
    Entry(
        name="tick",
        axes="t",
        size=1,
        read=lambda view: np.array([float(view.world.tick)]),
        meaning="what time it is",
        unit="1",
        frame="none",
        limits=lambda _: (np.array([0.0]), np.array([np.inf])),
    ),
)


def test_the_vector_has_the_entries_one_after_the_other() -> None:
    np.testing.assert_array_equal(read_table(TABLE, VIEW), [6.0, 2.9, 7.0])


def test_each_element_has_a_name_of_its_own() -> None:
    assert element_names(TABLE) == ("place[0]", "place[1]", "tick[0]")


def test_bounds_are_those_of_the_room_unless_an_entry_has_its_own() -> None:
    low, high = bounds(TABLE, SCENARIO)

    np.testing.assert_array_equal(low, [-BEYOND_M, -BEYOND_M, 0.0])
    np.testing.assert_array_equal(high, [12.0 + BEYOND_M, 6.0 + BEYOND_M, np.inf])


def test_the_documentation_counts_the_elements() -> None:
    assert as_markdown(TABLE).splitlines()[2:] == [
        "| 0 to 1 | `place` | xy | m | world | where the box is |",
        "| 2 | `tick` | t | 1 | none | what time it is |",
    ]
