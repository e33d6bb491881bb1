"""Realism that does not fit the robot or the room is refused by field."""

import pytest

from legpush.errors import ScenarioError
from legpush.scenarios.changes import override
from legpush.scenarios.file import dump_scenario, load_scenario, scenario_table


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"realism.floor.height_m": 0.09}, "realism.floor.height_m.*step height of the robot, 0.08 m.*got 0.09 m"),
        ({"realism.floor.height_m": [0.01, 0.2]}, "realism.floor.height_m.*got 0.2 m"),
        ({"realism.floor.height_m": 0.02, "realism.floor.size_m": 0.05}, "realism.floor.size_m.*5000 tiles"),
        ({"realism.gusts.force_n": 100.0}, "realism.gusts.*duration_s"),
        ({"realism.command_latency_s": -0.1}, "realism.command_latency_s"),
        ({"realism.gyro": 0.1}, "gyro"),
    ],
)
def test_what_cannot_be_simulated_is_refused_by_field(changes: dict[str, object], told: str) -> None:
    with pytest.raises(ScenarioError, match=told):
        override(load_scenario("default"), changes)


def test_items_are_set_by_their_paths_and_written_as_they_are_stated() -> None:
    changed = override(
        load_scenario("default"),
        {"realism.profile": "real", "realism.motor_strength": [0.8, 0.9], "realism.box_pose.noise_m": 0.02},
    )
    assert scenario_table(changed)["realism"] == {
        "profile": "real",
        "motor_strength": (0.8, 0.9),
        "box_pose": {"noise_m": 0.02},
    }
    assert "realism" not in scenario_table(load_scenario("default"))
    assert 'profile = "real"' in dump_scenario(changed)
