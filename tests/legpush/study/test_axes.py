import pytest

from legpush.errors import ConfigError
from legpush.study.axes import read_axes, spread

from .stub import STUB


def test_ranges_rise_by_their_step_and_lists_stay_as_they_are() -> None:
    axes = read_axes({"seed": {"first": 5, "n": 3, "step": 2}, "factor": [1.0, 4.0]}, [], {}, STUB, "f")
    assert [[axis.at(place) for place in range(axis.n)] for axis in axes] == [
        [{"seed": 5}, {"seed": 7}, {"seed": 9}],
        [{"factor": 1.0}, {"factor": 4.0}],
    ]


def test_a_range_of_fractions_rises_by_fractions() -> None:
    (axis,) = read_axes({"factor": {"first": 0, "n": 3, "step": 0.25}}, [], {}, STUB, "f")
    assert [axis.at(place)["factor"] for place in range(3)] == [0, 0.25, 0.5]


def test_fields_vary_together_or_in_all_combinations() -> None:
    (axis,) = read_axes({}, [{"seed": {"first": 0, "n": 2}, "box.mass_kg": [0.1, 0.5]}], {}, STUB, "f")
    assert [axis.at(place) for place in range(axis.n)] == [
        {"seed": 0, "box.mass_kg": 0.1},
        {"seed": 1, "box.mass_kg": 0.5},
    ]


def test_a_table_in_axes_is_a_field_of_a_record() -> None:
    (axis,) = read_axes({"box": {"pose": {"x_m": [1.0, 2.0]}}}, [], {}, STUB, "f")
    assert list(axis.columns) == ["box.pose.x_m"]


@pytest.mark.parametrize(
    ("axes", "together", "error"),
    [
        ({"sed": [1]}, [], r"f: at axes: unknown field `sed` \(did you mean `seed`\?\)"),
        ({"seed": []}, [], "`seed`: expected a list of values, or a range .*, got an empty list"),
        ({"seed": 3}, [], "expected a list of values, .*, got 3"),
        ({"seed": {"first": 1, "n": 0}}, [], "expected a range such as"),
        ({"seed": {"first": 1, "n": 2, "stop": 3}}, [], "expected a range such as"),
        ({"seed": [1, 2, 1]}, [], r"expected different values of seed, got \(1,\) twice"),
        ({"seed": [1]}, [{"seed": [2]}], "expected each field once, got `seed` twice"),
        ({"factor": [1.0]}, [], "expected each field once, got `factor` twice"),
        ({}, [{"seed": [1, 2], "kill_at": [1]}], "expected lists of equal length, got seed: 2, kill_at: 1"),
        ({}, [{}], "expected fields with lists of values, got an empty table"),
    ],
)
def test_what_is_no_axis_is_refused_with_its_place(
    axes: dict[str, object], together: list[dict[str, object]], error: str
) -> None:
    with pytest.raises(ConfigError, match=error):
        read_axes(axes, together, {"factor": 1.0}, STUB, "f")


def test_fields_of_another_record_are_changes_and_tables_are_joined() -> None:
    plain, changes = spread({"seed": 3, "box.mass_kg": 0.5}, STUB)
    assert plain == {"seed": 3, "changes": {"box.mass_kg": 0.5}}
    assert changes == {"box.mass_kg": 0.5}
