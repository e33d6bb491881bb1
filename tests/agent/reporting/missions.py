"""Missions to report on: journals made by hand, and missions in a world without physics."""

from math import pi

from msgspec.structs import replace

from agent_proc.endings import MissionResult
from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.reporting.mission_record import MissionRecord, read_record
from legpush.geometry import Pose2
from legpush.history.steps import PlanRecord, StepRecord
from legpush.messages.planning import Plan, PlanQuery, Tree
from legpush.messages.stepping import Follow, Outcome, Push, Reset, Trace, Walk
from legpush.scene.scenario import Rectangle
from tests.agent.fake_world import FakeWorld, make_scenario, make_state, scenario_at_station, straight_plan

SCENARIO = make_scenario()
BOX = Pose2(x_m=6.98, y_m=3.0, yaw_rad=0.02)


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
