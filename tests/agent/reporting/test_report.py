"""Report and picture, from journals made by hand and by a mission."""

from dataclasses import replace as with_changes
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.endings import MissionResult
from agent_proc.frames.poses import planar_pose
from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.queries import query_for_box
from agent_proc.reporting.mission_record import MissionRecord, read_record
from agent_proc.reporting.picture import save_picture
from agent_proc.reporting.picture_parts import appeared, followed
from agent_proc.reporting.report import box_path_rms_m, distances_m, make_report, tracking_rms_m
from legpush.errors import JournalError
from legpush.geometry import Pose2
from legpush.history.steps import PlanRecord, StepRecord
from legpush.messages.planning import Plan, PlanQuery, Tree
from legpush.messages.stepping import Follow, Outcome, Push, Reset, Trace, Walk
from legpush.scene.reference import Arcs, Straight
from legpush.scene.scenario import Rectangle
from tests.agent.fake_world import FakeWorld, make_scenario, make_state, scenario_at_station, straight_plan

SCENARIO = make_scenario()
BOX = Pose2(x_m=6.98, y_m=3.0, yaw_rad=0.02)
DONE = MissionResult(
    success=True,
    reason="success",
    detail="box error",
    handover_distance_m=2.9,
    n_push_cycles=1,
    n_better_paths=0,
    n_replans=0,
)
REPORT_KEYS = (
    *("success", "reason", "detail", "box_position_error_m", "box_angle_error_deg", "walk_tracking_rms_m"),
    *(
        "box_path_rms_m",
        "handover_distance_m",
        "trunk_max_abs_pitch_deg",
        "trunk_max_abs_roll_deg",
        "min_support_margin_m",
    ),
    *("n_better_paths", "n_replans", "appeared"),
    *("n_push_cycles", "n_footsteps", "sim_time_s", "wall_time_s", "real_time_factor", "state_crc", "seed", "versions"),
)


def trace(ticks: range, trunks: list[tuple[float, float]], tilt: float, margin_m: float) -> Trace:
    """A trunk at these places, rolled by `tilt` and pitched by twice that, in the last tick only."""
    states = [make_state(Pose2(x_m=x, y_m=y, yaw_rad=0.0), BOX) for x, y in trunks]
    quiet = [(0.0, 0.0)] * (len(states) - 1)
    return Trace(
        tick=tuple(ticks),
        qpos=tuple(
            (
                *s.trunk.position_m,
                *s.trunk.orientation_wxyz,
                *s.joint_positions_rad,
                *s.box.position_m,
                *s.box.orientation_wxyz,
            )
            for s in states
        ),
        roll_pitch_rad=(*quiet, (-tilt, 2 * tilt)),
        tips_m=tuple(s.tips_m for s in states),
        contact_forces_n=tuple(((0.0, 0.0, 80.0),) * 4 for _ in states),
        com_m=tuple(s.trunk.position_m for s in states),
        zmp_m=((0.0, 0.0),) * len(states),
        support_margin_m=(*(0.1,) * (len(states) - 1), margin_m),
    )


BOX_QUERY = query_for_box(SCENARIO, 5, BOX, {"rear": PushEstimate(SCENARIO.box)}, None)


def box_plan(*points: tuple[float, float]) -> Plan:
    waypoints = tuple(Pose2(x_m=x_m, y_m=y_m, yaw_rad=0.0) for x_m, y_m in points)
    return Plan(status="exact", reason="", waypoints=waypoints, sides=(0,) * len(waypoints))


NOTHING = Trace(
    tick=(), qpos=(), roll_pitch_rad=(), tips_m=(), contact_forces_n=(), com_m=(), zmp_m=(), support_margin_m=()
)


def outcome(tick: int, crc: int, ticks: Trace = NOTHING, n_footsteps: int = 0) -> Outcome:
    state = replace(make_state(Pose2(x_m=5.0, y_m=3.0, yaw_rad=0.0), BOX, tick=tick), n_footsteps=n_footsteps)
    return Outcome(world=state, state_crc=crc, trace=ticks)


def journal_by_hand() -> list[StepRecord | PlanRecord]:
    """Two ticks of walking beside a path along y = 3, two ticks of pushing."""
    path = Follow(waypoints=(Pose2(x_m=1.0, y_m=3.0, yaw_rad=0.0), Pose2(x_m=5.0, y_m=3.0, yaw_rad=0.0)))
    push = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)
    return [
        StepRecord(Reset(scenario=SCENARIO, seed=5), outcome(0, 1)),
        StepRecord(path, outcome(0, 2)),
        StepRecord(Walk(), outcome(2, 3, trace(range(1, 3), [(1.0, 3.03), (1.2, 2.96)], 0.01, 0.04), 4)),
        StepRecord(push, outcome(4, 0xBEEF, trace(range(3, 5), [(1.2, 4.0), (1.2, 4.0)], pi / 180, -0.02), 8)),
    ]


def test_every_number_of_the_report_is_that_of_the_journal() -> None:
    report = make_report(read_record(journal_by_hand()), DONE, 0.016, {"python": "3", "ompl": None})

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


def test_what_was_not_measured_is_none() -> None:
    report = make_report(read_record(journal_by_hand()[:1]), DONE, 1.0, {})

    assert report.walk_tracking_rms_m is None
    assert report.box_path_rms_m is None
    assert report.trunk_max_abs_pitch_deg is None
    assert report.trunk_max_abs_roll_deg is None
    assert report.min_support_margin_m is None
    assert (report.n_push_cycles, report.sim_time_s) == (0, 0.0)


def test_the_report_of_a_mission_depends_on_its_records_alone() -> None:
    world = FakeWorld()
    result = run_mission(world, SCENARIO, 5, ScriptedPolicy())

    first, second = (make_report(read_record(iter(world.records)), result, 1.0, {}) for _ in range(2))

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


def test_the_ticks_of_a_mission_end_where_its_state_does() -> None:
    world = FakeWorld(box_offset=(0.02, 0.03, 0.05))
    run_mission(world, SCENARIO, 5, ScriptedPolicy())

    record = read_record(world.records)

    ticks, last = record.ticks(), record.steps[-1].world
    box = planar_pose(last.box)
    assert len(ticks.time_s) == last.tick
    assert ticks.time_s[-1] == pytest.approx(last.tick * 0.02)
    np.testing.assert_allclose(ticks.box[-1], [box.x_m, box.y_m, box.yaw_rad])
    np.testing.assert_allclose(ticks.trunk_m[-1], last.trunk.position_m[:2])
    np.testing.assert_allclose(ticks.tips_m[-1], last.tips_m)
    assert record.pushing()[0].world.box.position_m[:2] == (6.02, 3.03)


@pytest.mark.parametrize(
    ("point", "expected_m"),
    [((0.5, 0.3), 0.3), ((-3.0, 4.0), 5.0), ((1.5, 0.5), 0.5), ((1.0, 2.0), 1.0), ((0.9, 0.9), 0.1)],
)
def test_the_distance_to_a_path_is_that_to_its_nearest_point(point: tuple[float, float], expected_m: float) -> None:
    path = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 1.0]])

    assert distances_m(np.array([point]), path)[0] == pytest.approx(expected_m)


def test_the_distance_to_a_path_of_one_point_is_that_to_the_point() -> None:
    assert distances_m(np.array([[3.0, 4.0]]), np.zeros((1, 2)))[0] == pytest.approx(5.0)


def test_a_journal_that_does_not_begin_with_a_reset_is_refused() -> None:
    with pytest.raises(JournalError, match="Expected a reset as the first step"):
        read_record(journal_by_hand()[1:])
    with pytest.raises(JournalError, match="Expected a reset as the first step"):
        read_record([])


def test_a_step_without_its_trace_is_refused() -> None:
    motion, result = journal_by_hand()[0]
    bare = StepRecord(motion, replace(result, trace=None))  # type: ignore[arg-type]

    with pytest.raises(JournalError, match="got step 0 without one"):
        read_record([bare])


def branching_plan(query: PlanQuery) -> Plan:
    """A straight plan with a tree and a raw path."""
    plan = straight_plan(query)
    corner = (query.start.x_m, query.goal.y_m)
    points = ((query.start.x_m, query.start.y_m), corner, (query.goal.x_m, query.goal.y_m))
    return replace(plan, raw_path_m=points, tree=Tree(points_m=points, parents=(0, 0, 1)))


def whole_mission() -> tuple[MissionRecord, MissionResult]:
    world = FakeWorld(planner=branching_plan)
    result = run_mission(world, SCENARIO, 5, ScriptedPolicy())
    return read_record(world.records), result


def unplanned_mission() -> tuple[MissionRecord, MissionResult]:
    world = FakeWorld(planner=lambda _: Plan(status="invalid", reason="walled in"))
    result = run_mission(world, SCENARIO, 5, ScriptedPolicy())
    return read_record(world.records), result


def push_alone() -> tuple[MissionRecord, MissionResult]:
    world = FakeWorld()
    result = run_mission(world, scenario_at_station(), 5, ScriptedPolicy())
    return read_record(world.records), result


def blocked_mission() -> tuple[MissionRecord, MissionResult]:
    """Two obstacles appear, one in the way, and a third would have."""
    wall = Rectangle(x_min_m=3.2, x_max_m=3.4, y_min_m=2.0, y_max_m=4.0)
    gate, aside, late = (replace(wall, appears_at_s=at_s) for at_s in (2.0, 4.0, 1e6))
    aside = replace(aside, y_min_m=0.0, y_max_m=1.0)
    world = FakeWorld(planner=branching_plan)
    scenario = replace(SCENARIO, room=replace(SCENARIO.room, obstacles=(late, gate, aside)))
    result = run_mission(world, scenario, 5, ScriptedPolicy())
    return read_record(world.records), result


def test_the_report_says_what_appeared_when_and_how_often_that_was_in_the_way() -> None:
    report = make_report(*blocked_mission(), 1.0, {})

    assert [(each.obstacle, each.time_s) for each in report.appeared] == [(1, 3.2), (2, pytest.approx(4.8))]
    assert report.n_replans == 1


def test_a_path_is_given_up_that_an_obstacle_appeared_in_and_no_other() -> None:
    record, _ = blocked_mission()

    assert [given_up for _, given_up in followed(record)] == [True, False, False]
    assert [each.obstacle for each in appeared(record)] == [1, 2]
    assert not any(given_up for _, given_up in followed(whole_mission()[0]))


@pytest.mark.parametrize("mission", [whole_mission, unplanned_mission, push_alone, blocked_mission])
def test_every_mission_can_be_drawn(mission: object, tmp_path: Path, recwarn: pytest.WarningsRecorder) -> None:
    record, result = mission()  # type: ignore[operator]

    save_picture(record, result, tmp_path / "mission.png")

    assert (tmp_path / "mission.png").read_bytes().startswith(b"\x89PNG")
    assert [str(warning.message) for warning in recwarn] == []


def test_a_picture_of_another_mission_is_another_picture(tmp_path: Path) -> None:
    record, result = whole_mission()
    save_picture(record, result, tmp_path / "a.png")
    save_picture(record, result, tmp_path / "b.png")
    save_picture(with_changes(record, seed=6), result, tmp_path / "c.png")

    a, b, c = ((tmp_path / f"{name}.png").read_bytes() for name in "abc")
    assert a == b
    assert a != c


def pushed_to(*boxes: tuple[float, float]) -> list[StepRecord]:
    push = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)
    trunk = Pose2(x_m=5.0, y_m=3.0, yaw_rad=0.0)
    states = [make_state(trunk, Pose2(x_m=x_m, y_m=y_m, yaw_rad=0.0)) for x_m, y_m in boxes]
    return [StepRecord(push, Outcome(world=state, state_crc=0, trace=NOTHING)) for state in states]


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
