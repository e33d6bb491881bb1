"""What was measured of the motions of a phase, from journals made by hand."""

import dataclasses

import pytest
from msgspec.structs import replace

from agent_proc.endings import MissionResult
from agent_proc.reporting.mission_record import MissionRecord, read_record
from agent_proc.reporting.phases import phase_report, travel_m, unexpected_notes
from agent_proc.reporting.report import Begun, make_report
from legpush.history.steps import StepRecord
from legpush.messages.stepping import Push, Walk
from tests.agent.reporting.missions import journal_by_hand
from tests.legpush.examples import MEASURES
from tests.robots import ROBOT

RESULT = MissionResult(
    success=True,
    reason="success",
    detail="",
    remedy="",
    handover_distance_m=None,
    n_push_cycles=1,
    n_better_paths=0,
    n_replans=0,
)


def measured() -> MissionRecord:
    """A gait cycle of 5 cm and a push, both with the measures of the example; the push with others in part."""
    records = [
        StepRecord(motion, replace(outcome, measures=measures))
        for record in journal_by_hand()
        if isinstance(record, StepRecord)
        for motion, outcome in (record,)
        for measures in (
            MEASURES
            if isinstance(motion, Walk)
            else replace(MEASURES, n_footsteps=0, landing_speeds_m_s=(), unexpected=())
            if isinstance(motion, Push)
            else None,
        )
    ]
    return read_record(records)


def test_a_phase_has_the_measures_of_its_motions_alone() -> None:
    record = measured()
    walking = phase_report([step for step in record.steps if isinstance(step.motion, Walk)], ROBOT)
    assert walking is not None
    assert (walking.n_steps, walking.n_footsteps, walking.n_outside_support) == (20, 4, 3)
    assert (walking.max_torque_n_m.hip_x, walking.max_torque_n_m.knee) == (10.0, 30.0)
    assert walking.share_at_torque_limit == pytest.approx(12 / 240)
    assert walking.least_to_joint_limit_deg == pytest.approx(-0.573, abs=1e-3)
    assert walking.touchdowns_per_footstep == 1.25
    assert walking.usual_landing_speed_m_s == pytest.approx(0.1097)
    assert walking.travel_m == pytest.approx(0.2119, abs=1e-4)
    assert walking.cost_of_transport == pytest.approx(12.5 / (ROBOT.mass_kg * 9.81 * walking.travel_m))
    assert walking.unexpected == MEASURES.unexpected


def test_torques_of_a_report_are_at_most_the_largest_one() -> None:
    record = measured()
    walking = phase_report(record.steps, ROBOT)
    assert walking is not None
    for joint in ("hip_x", "hip_y", "knee"):
        assert getattr(walking.usual_torque_n_m, joint) <= getattr(walking.max_torque_n_m, joint)


def test_a_phase_without_footsteps_and_landings_has_no_numbers_of_them() -> None:
    record = measured()
    pushing = phase_report([step for step in record.steps if isinstance(step.motion, Push)], ROBOT)
    assert pushing is not None
    assert (pushing.touchdowns_per_footstep, pushing.usual_landing_speed_m_s) == (None, None)
    assert pushing.max_push_moment_n_m == 2.5


def test_unexpected_contacts_are_noted_in_the_report() -> None:
    record = measured()
    (note,) = unexpected_notes(record.steps)
    assert note == "unexpected contacts: FL_lower with wall_0 (2 physics steps, 7.5 N)"
    assert make_report(record, RESULT, 1.0, {}, Begun(policy="scripted")).notes == (note,)
    assert unexpected_notes(read_record(journal_by_hand()).steps) == ()


def test_ways_of_motions_apart_from_each_other_are_not_joined() -> None:
    record = measured()
    walk = next(step for step in record.steps if isinstance(step.motion, Walk))
    ticks = walk.ticks
    away = dataclasses.replace(ticks, time_s=ticks.time_s + 100.0, trunk_m=ticks.trunk_m + 50.0)
    later = dataclasses.replace(walk, ticks=away)
    both = phase_report([walk, later], ROBOT)
    one = phase_report([walk], ROBOT)
    assert both is not None
    assert one is not None
    assert both.travel_m == pytest.approx(2 * one.travel_m)
    assert travel_m(ticks.trunk_m) == one.travel_m
