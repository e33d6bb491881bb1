"""Columns of a mission about its phases."""

from agent_proc.reporting.mission_record import read_record
from agent_proc.reporting.report import Begun, make_report
from agent_proc.studies.phase_numbers import PHASE_COLUMNS, phase_numbers
from legpush.runs.report import PhaseReport
from tests.agent.reporting.missions import journal_by_hand
from tests.agent.reporting.test_phases import RESULT, measured

UNITS = {"_n_m": "N m", "_rad_s": "rad/s", "_w": "W", "_deg": "deg", "_j": "J", "_m_s": "m/s", "_m": "m"}


def test_every_column_has_its_value_and_its_unit() -> None:
    values = phase_numbers(make_report(measured(), RESULT, 1.0, {}, Begun(policy="scripted")))
    assert list(values) == [column.name for column in PHASE_COLUMNS]
    for column in PHASE_COLUMNS:
        unit = next((unit for ending, unit in UNITS.items() if column.name.endswith(ending)), "")
        assert column.unit == unit, column.name
    assert values["walk_hip_y_max_torque_n_m"] == 20.0
    assert values["walk_touchdowns_per_footstep"] == 1.25
    assert values["push_max_push_moment_n_m"] == 2.5
    assert values["walk_unexpected"] == "FL_lower:wall_0 2 7.5 N"
    assert values["push_unexpected"] == ""


def test_a_phase_that_did_not_happen_has_no_numbers() -> None:
    values = phase_numbers(make_report(read_record(journal_by_hand()[:1]), RESULT, 1.0, {}, Begun(policy="scripted")))
    assert set(values.values()) == {None}


def test_every_field_of_a_phase_is_a_column_or_left_out_on_purpose() -> None:
    names = {column.name.partition("_")[2] for column in PHASE_COLUMNS}
    for field in PhaseReport.__struct_fields__:
        assert any(name.endswith(field) for name in names) or field == "n_footsteps"
