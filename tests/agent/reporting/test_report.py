"""The report on a mission, from journals made by hand and by a mission."""

from math import pi, sqrt

import pytest
from msgspec.structs import replace

from agent_proc.endings import MissionResult
from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.queries import query_for_box
from agent_proc.reporting.mission_record import read_record
from agent_proc.reporting.report import Begun, box_path_rms_m, make_report, tracking_rms_m
from legpush.geometry import Pose2
from legpush.history.steps import PlanRecord, StepRecord
from legpush.messages.planning import Plan
from legpush.messages.stepping import Follow, Outcome, Perceived, Push, Reset, Walk
from legpush.scene.reference import Arcs, Straight
from tests.agent.fake_world import FakeWorld, make_state
from tests.agent.reporting.missions import BOX, NOTHING, SCENARIO, blocked_mission, journal_by_hand, outcome, trace

DONE = MissionResult(
    success=True,
    reason="success",
    detail="box error",
    remedy="",
    handover_distance_m=2.9,
    n_push_cycles=1,
    n_better_paths=0,
    n_replans=0,
)
REPORT_KEYS = (
    *("success", "reason", "detail", "remedy", "box_position_error_m", "box_angle_error_deg", "walk_tracking_rms_m"),
    *(
        "box_path_rms_m",
        "handover_distance_m",
        "trunk_max_abs_pitch_deg",
        "trunk_max_abs_roll_deg",
        "min_support_margin_m",
    ),
    *("walking", "pushing", "n_better_paths", "n_replans", "appeared"),
    *("n_push_cycles", "n_footsteps", "sim_time_s", "wall_time_s", "real_time_factor", "state_crc", "seed"),
    *("scenario", "scenario_sha256", "policy", "planner", "command", "numerics", "versions"),
    *("notes", "perceived_box_position_error_m", "perceived_box_angle_error_deg"),
)


BOX_QUERY = query_for_box(SCENARIO, 5, BOX, {"rear": PushEstimate(SCENARIO.box)}, None)
BEGUN = Begun(policy="scripted")


def box_plan(*points: tuple[float, float]) -> Plan:
    waypoints = tuple(Pose2(x_m=x_m, y_m=y_m, yaw_rad=0.0) for x_m, y_m in points)
    return Plan(status="exact", reason="", waypoints=waypoints, sides=(0,) * len(waypoints))


def pushed_to(*boxes: tuple[float, float]) -> list[StepRecord]:
    push = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)
    trunk = Pose2(x_m=5.0, y_m=3.0, yaw_rad=0.0)
    states = [make_state(trunk, Pose2(x_m=x_m, y_m=y_m, yaw_rad=0.0)) for x_m, y_m in boxes]
    return [StepRecord(push, Outcome(world=state, state_crc=0, trace=NOTHING)) for state in states]


def test_every_number_of_the_report_is_that_of_the_journal() -> None:
    report = make_report(read_record(journal_by_hand()), DONE, 0.016, {"python": "3", "ompl": None}, BEGUN)

    assert tuple(report.__struct_fields__) == REPORT_KEYS
    assert (report.success, report.reason, report.handover_distance_m) == (True, "success", 2.9)
    assert report.box_position_error_m == pytest.approx(0.02)
    assert report.box_angle_error_deg == pytest.approx(0.02 * 180 / pi)
    assert report.walk_tracking_rms_m == pytest.approx(sqrt((0.03**2 + 0.04**2) / 2))
    assert report.trunk_max_abs_roll_deg == pytest.approx(1.0)
    assert report.trunk_max_abs_pitch_deg == pytest.approx(2.0)
    assert report.min_support_margin_m == -0.02
    assert (report.n_push_cycles, report.n_footsteps, report.seed) == (1, 8, 5)
    assert report.sim_time_s == pytest.approx(0.08)
    assert report.wall_time_s == 0.016
    assert report.real_time_factor == pytest.approx(5.0)
    assert report.state_crc == "0000beef"
    assert report.versions == {"python": "3", "ompl": None}
    assert report.perceived_box_position_error_m is report.perceived_box_angle_error_deg is None


def test_a_box_that_is_perceived_beside_its_place_has_two_errors() -> None:
    *before, last = journal_by_hand()
    assert isinstance(last, StepRecord)
    world = last.outcome.world
    goal = SCENARIO.goal.pose.pose()
    box = replace(world.box, position_m=(goal.x_m, goal.y_m + 0.01, 0.2))
    perceived = Perceived(trunk=goal, trunk_tick=0, box=box, box_tick=0)
    seen = last._replace(outcome=replace(last.outcome, world=replace(world, perceived=perceived)))
    report = make_report(read_record([*before, seen]), DONE, 1.0, {}, BEGUN)
    assert report.box_position_error_m == pytest.approx(0.02)
    assert report.perceived_box_position_error_m == pytest.approx(0.01)


def test_what_was_not_measured_is_none() -> None:
    report = make_report(read_record(journal_by_hand()[:1]), DONE, 1.0, {}, BEGUN)

    assert report.walk_tracking_rms_m is None
    assert report.box_path_rms_m is None
    assert report.trunk_max_abs_pitch_deg is None
    assert report.trunk_max_abs_roll_deg is None
    assert report.min_support_margin_m is None
    assert (report.walking, report.pushing, report.notes) == (None, None, ())
    assert (report.n_push_cycles, report.sim_time_s) == (0, 0.0)


def test_the_report_of_a_mission_depends_on_its_records_alone() -> None:
    world = FakeWorld()
    result = run_mission(world, SCENARIO, 5, ScriptedPolicy())

    first, second = (make_report(read_record(iter(world.records)), result, 1.0, {}, BEGUN) for _ in range(2))

    assert first == second
    assert first.n_push_cycles == result.n_push_cycles
    assert first.walk_tracking_rms_m == pytest.approx(0.0, abs=0.02)
    assert first.sim_time_s == pytest.approx(world.records[-1][1].world.tick * 0.02)  # type: ignore[union-attr]


def test_each_gait_cycle_is_measured_against_the_path_that_was_followed_then() -> None:
    records = journal_by_hand()
    other = Follow(waypoints=(Pose2(x_m=1.0, y_m=2.0, yaw_rad=0.0), Pose2(x_m=5.0, y_m=2.0, yaw_rad=0.0)))
    walk = StepRecord(Walk(), outcome(6, 4, trace(range(5, 6), [(2.0, 2.5)], 0.0, 0.1)))

    record = read_record([*records, StepRecord(other, outcome(4, 4)), walk])

    walks = [step for step in record.steps if isinstance(step.motion, Walk)]
    assert tracking_rms_m(walks) == pytest.approx(sqrt((0.03**2 + 0.04**2 + 0.5**2) / 3))
    assert tracking_rms_m([]) is None


def test_the_report_says_what_appeared_when_and_how_often_that_was_in_the_way() -> None:
    report = make_report(*blocked_mission(), 1.0, {}, BEGUN)

    assert [(each.obstacle, each.time_s) for each in report.appeared] == [(1, 3.2), (2, pytest.approx(4.8))]
    assert report.n_replans == 1


def test_each_push_is_measured_against_the_path_of_the_box_that_was_planned_last() -> None:
    start = StepRecord(Reset(scenario=SCENARIO, seed=5), outcome(0, 1))
    first = PlanRecord(BOX_QUERY, box_plan(*((6.0 + k / 20, 3.0) for k in range(21))))
    second = PlanRecord(BOX_QUERY, box_plan(*((6.4, 3.0 + k / 20) for k in range(21))))
    records: list[StepRecord | PlanRecord] = [
        start,
        first,
        *pushed_to((6.2, 3.03), (6.4, 2.96)),
        second,
        *pushed_to((6.4, 3.1), (6.45, 3.3)),
    ]

    assert box_path_rms_m(read_record(records).steps) == pytest.approx(sqrt((0.03**2 + 0.04**2 + 0.05**2) / 4))
    assert box_path_rms_m(read_record([start, *pushed_to((6.2, 3.0))]).steps) is None


def test_where_a_path_crosses_itself_what_counts_is_the_part_ahead() -> None:
    start = StepRecord(Reset(scenario=SCENARIO, seed=5), outcome(0, 1))
    there = [(6.0 + k / 20, 3.0) for k in range(41)]
    around = [(8.0, 3.0 + k / 20) for k in range(41)]
    back = [(8.0 - k / 20, 5.0) for k in range(21)]
    across = [(7.0, 5.0 - k / 20) for k in range(61)]
    boxes = [(6.4, 3.0), (6.8, 3.0), (7.0, 3.2), (7.2, 3.0), (7.6, 3.0)]
    plan = PlanRecord(BOX_QUERY, box_plan(*there, *around, *back, *across))
    records: list[StepRecord | PlanRecord] = [start, plan, *pushed_to(*boxes)]

    assert box_path_rms_m(read_record(records).steps) == pytest.approx(sqrt(0.2**2 / 5))


def test_a_reference_is_the_path_of_the_box_whatever_is_planned_besides() -> None:
    reference = Arcs(radius_m=1.0, segments=(Straight(length_m=1.0),))
    start = StepRecord(Reset(scenario=replace(SCENARIO, reference=reference), seed=5), outcome(0, 1))

    other = PlanRecord(BOX_QUERY, box_plan((6.0, 4.0), (7.0, 4.0)))
    records: list[StepRecord | PlanRecord] = [start, other, *pushed_to((6.2, 3.02))]

    assert box_path_rms_m(read_record(records).steps) == pytest.approx(0.02)
