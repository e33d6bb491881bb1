import pytest

from agent_proc.studies.mission_cell import MISSION
from legpush.errors import ConfigError
from legpush.study.paths import flattened, require_path

from .stub import STUB


@pytest.mark.parametrize(
    "path", ["seed", "box.mass_kg", "goal.pose.x_m", "room.obstacles", "planning.anytime.n_improvements"]
)
def test_fields_of_the_cell_and_of_the_scenario_are_found(path: str) -> None:
    require_path(path, STUB, "f")


def test_fields_of_an_optional_record_are_found() -> None:
    require_path("random_room.obstacles", MISSION, "f")


@pytest.mark.parametrize(
    ("path", "error"),
    [
        ("box.mas_kg", r"f: unknown field `box.mas_kg` \(did you mean `mass_kg`\?\); valid here: pose, .*, in box"),
        ("colour", r"unknown field `colour`; valid here: seed, .*, or a field of the scenario \(name, room"),
        ("seed.a", "unknown field `seed.a`; valid here: nothing, in seed"),
        ("changes", "unknown field `changes`"),
    ],
)
def test_an_unknown_field_is_refused_with_the_valid_ones(path: str, error: str) -> None:
    with pytest.raises(ConfigError, match=error):
        require_path(path, STUB, "f")


def test_tables_become_paths_but_a_record_that_may_be_absent_stays_a_value() -> None:
    table = {"seed": 1, "box": {"pose": {"x_m": 1.0}}, "reference": {"kind": "circle"}}
    assert flattened(table, STUB) == {"seed": 1, "box.pose.x_m": 1.0, "reference": {"kind": "circle"}}
    assert flattened(table)["reference.kind"] == "circle"
