"""A world without physics: walking follows the path exactly, pushing moves the box as the push model says."""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import count
from math import cos, pi, radians, sin
from typing import Any
from zlib import crc32

import numpy as np

from agent_proc.push_model.model import MIRROR, nearest_model
from legpush.geometry import Pose2
from legpush.history.steps import PlanRecord, StepRecord
from legpush.lockstep.local import LocalWorld
from legpush.messages import codec
from legpush.messages.planning import BoxPathQuery, Plan, PlanQuery, TrunkPathQuery
from legpush.messages.stepping import (
    Alter,
    Appearance,
    BoxState,
    Follow,
    Imu,
    Motion,
    Outcome,
    PathProgress,
    Push,
    Reset,
    TrunkState,
    Walk,
    WorldState,
)
from legpush.plans.planner import Interrupted
from legpush.scene.conventions import CONTROL_PERIOD_S
from legpush.scene.faces import TURN_RAD, pushed_box, pushed_pose
from legpush.scene.scenario import Box, Goal, PoseDeg, Room, Scenario
from legpush.scene.station import station
from tests.agent.fake_motion import FollowedPath, between, trace_of
from tests.robots import ROBOT

STRIDE_M = 0.4
WALK_TICKS = 80
PUSH_TICKS = 150
TRUNK_HEIGHT_M = 0.48


def make_scenario(start: tuple[float, float, float] = (1.5, 3.0, 0.0), **changes: object) -> Scenario:
    """A box 4.5 m ahead of a robot in an empty room, to be pushed 1 m straight ahead."""
    fields: dict[str, object] = {
        "name": "fake",
        "room": Room(size_m=(12.0, 6.0)),
        "start": PoseDeg(x_m=start[0], y_m=start[1], yaw_deg=start[2]),
        "box": Box(pose=PoseDeg(x_m=6.0, y_m=3.0, yaw_deg=0.0)),
        "goal": Goal(pose=PoseDeg(x_m=7.0, y_m=3.0, yaw_deg=0.0)),
        **changes,
    }
    return Scenario(**fields)  # type: ignore[arg-type]


def scenario_at_station() -> Scenario:
    """The same, with the robot where it pushes from."""
    scenario = make_scenario()
    place = station(ROBOT, scenario.box, scenario.box.pose.pose())
    return make_scenario((place.x_m, place.y_m, 0.0))


def make_state(
    trunk: Pose2,
    box: Pose2,
    *,
    tick: int = 0,
    fallen: bool = False,
    path: PathProgress | None = None,
    appeared: tuple[Appearance, ...] = (),
) -> WorldState:
    """A level robot with its feet at the foot rectangle, and a level box of 0.4 m height."""
    x, y, z, w = 0.0, 0.0, sin(trunk.yaw_rad / 2), cos(trunk.yaw_rad / 2)
    orientation = (w, x, y, z)
    rest = (0.0, 0.0, 0.0)
    tips = [(float(px), float(py), 0.02) for px, py in trunk.apply(ROBOT.stance.foot_rectangle_b())]
    return WorldState(
        tick=tick,
        trunk=TrunkState(
            position_m=(trunk.x_m, trunk.y_m, TRUNK_HEIGHT_M),
            orientation_wxyz=orientation,
            linear_velocity_m_s=rest,
            angular_velocity_rad_s=rest,
        ),
        joint_positions_rad=(0.0,) * 12,
        joint_velocities_rad_s=(0.0,) * 12,
        tips_m=(tips[0], tips[1], tips[2], tips[3]),
        foot_forces_n=(80.0, 80.0, 80.0, 80.0),
        imu=Imu(orientation_wxyz=orientation, angular_velocity_rad_s=rest, linear_acceleration_m_s2=(0.0, 0.0, 9.81)),
        box=BoxState(
            position_m=(box.x_m, box.y_m, 0.2),
            orientation_wxyz=(cos(box.yaw_rad / 2), 0.0, 0.0, sin(box.yaw_rad / 2)),
        ),
        n_footsteps=0,
        fallen=fallen,
        path=path,
        push=None,
        appeared=appeared,
    )


def straight_plan(query: PlanQuery) -> Plan:
    """The straight line from start to goal, turning evenly on the way; the box at its first face."""
    points = np.linspace(query.start.xy(), query.goal.xy(), 50)
    turn = query.goal.yaw_rad - query.start.yaw_rad
    yaws = query.start.yaw_rad + (turn - 2 * pi * round(turn / (2 * pi))) * np.linspace(0.0, 1.0, 50)
    poses = (Pose2(x_m=float(x), y_m=float(y), yaw_rad=float(yaw)) for (x, y), yaw in zip(points, yaws, strict=True))
    sides = (0,) * 50 if isinstance(query, BoxPathQuery) else ()
    return Plan(status="exact", reason="", waypoints=tuple(poses), sides=sides)


@dataclass
class KinematicSimulator:
    """Walks along the path exactly, and moves the box as the push model says."""

    box_offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """From the nominal pose of the box: x, y in m and yaw in rad."""
    walk_stride_m: float = STRIDE_M
    push_scale: float = 1.0
    lost_depth_m: float = 0.0
    """Part of the depth of each push that does not move the box."""
    turn_scale: float = 1.0
    """Of the turn alone."""
    sideways_m: float = 0.0
    """How far a box slips to its left with each push."""
    falls_in: Callable[[Motion, int], bool] = lambda _motion, _n: False
    """Whether the robot falls in this motion, the n-th of its kind from 1."""
    noise: np.random.Generator | None = None
    n_done: Counter[type[Motion]] = field(default_factory=Counter)
    """Motions by their kind."""
    _tick: int = 0
    _appeared: tuple[Appearance, ...] = ()

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        """Carry out one motion."""
        before = None if isinstance(motion, Reset) else (self._trunk, self._box)
        n_ticks = self._move(motion)
        self.n_done[type(motion)] += 1
        fallen = self.falls_in(motion, self.n_done[type(motion)])
        begin, self._tick = self._tick, self._tick + n_ticks
        self._let_appear()
        world = make_state(
            self._trunk, self._box, tick=self._tick, fallen=fallen, path=self._progress(), appeared=self._appeared
        )
        trace = trace_of(begin, self._ticks(n_ticks, *(before or (self._trunk, self._box)))) if with_trace else None
        return Outcome(world=world, state_crc=crc32(codec.encode(world)), trace=trace)

    @property
    def tick(self) -> int:
        """Now."""
        return self._tick

    def _move(self, motion: Motion) -> int:
        """Change the state; returns the ticks that it took."""
        match motion:
            case Reset():
                self._scenario = motion.scenario
                self._trunk = motion.scenario.start.pose()
                nominal = motion.scenario.box.pose.pose()
                dx, dy, turn = self.box_offset
                self._box = Pose2(x_m=nominal.x_m + dx, y_m=nominal.y_m + dy, yaw_rad=nominal.yaw_rad + turn)
                self._path: FollowedPath | None = None
                self._tick = 0
                self._appeared = ()
                return 0
            case Follow():
                self._path = FollowedPath(motion.waypoints)
                return 0
            case Walk():
                if self._path is None:
                    raise ValueError("Expected a path before a walk")
                self._trunk = self._path.advance(self.walk_stride_m)
                return WALK_TICKS
            case Push():
                self._box = self._pushed(motion)
                box, pose = pushed_box(self._scenario.box, motion.face), pushed_pose(self._box, motion.face)
                self._trunk = station(ROBOT, box, pose)
                self._path = None
                return PUSH_TICKS
            case Alter():
                return 0

    def _ticks(self, n_ticks: int, trunk: Pose2, box: Pose2) -> list[WorldState]:
        """States in which everything moves evenly from these poses to the present ones."""
        shares = [k / n_ticks for k in range(1, n_ticks + 1)]
        return [make_state(between(trunk, self._trunk, share), between(box, self._box, share)) for share in shares]

    def _let_appear(self) -> None:
        """Obstacles appear when they are due, whatever is in their place, at the end of a step."""
        there = {each.obstacle for each in self._appeared}
        for index, obstacle in enumerate(self._scenario.room.obstacles):
            if 0.0 < obstacle.appears_at_s <= self._tick * CONTROL_PERIOD_S and index not in there:
                self._appeared += (Appearance(obstacle=index, tick=self._tick),)

    def _pushed(self, push: Push) -> Pose2:
        before = pushed_pose(self._box, push.face)
        box = np.array([[before.x_m, before.y_m, before.yaw_rad]])
        mirror, depth = np.array([MIRROR[push.leg]]), np.array([max(push.depth_m - self.lost_depth_m, 0.0)])
        scale = self.push_scale
        factor, slip = (1.0, 0.0) if self.noise is None else self.noise.normal([1.0, 0.0], [0.1, radians(0.2)])
        model = nearest_model(pushed_box(self._scenario.box, push.face))
        x, y, yaw = model.push(box, mirror, depth, scale * factor, scale * factor * self.turn_scale)[0]
        pushed = Pose2(x_m=float(x), y_m=float(y), yaw_rad=float(yaw) + slip - TURN_RAD[push.face])
        return pushed @ Pose2(x_m=0.0, y_m=self.sideways_m, yaw_rad=0.0)

    def _progress(self) -> PathProgress | None:
        return None if self._path is None else self._path.progress()


def straight_better(query: PlanQuery, _revision: int) -> Plan:
    """A better plan that is the same one again."""
    return straight_plan(query)


class FakeWorld(LocalWorld):
    """A local world with a kinematic simulator, which keeps what was asked, answered and told."""

    def __init__(
        self,
        planner: Callable[[PlanQuery], Plan] = straight_plan,
        better: Callable[[PlanQuery, int], Plan] = straight_better,
        simulator: "KinematicSimulator | None" = None,
        **of_simulator: Any,
    ) -> None:
        """`planner` answers queries, `better` their revisions; the rest are fields of a `KinematicSimulator`."""
        self.simulator = simulator or KinematicSimulator(**of_simulator)
        self.records: list[StepRecord | PlanRecord] = []
        self.told: list[tuple[str, float | None, str]] = []
        self.rewards: list[dict[str, float]] = []
        self.n_cancelled = 0
        self.planner, self.better = planner, better
        super().__init__(self.simulator, self._make_plans, on_record=self.records.append)

    def cancel_plan(self) -> None:
        """Count it."""
        self.n_cancelled += 1

    def tell(self, phase: str, fraction: float | None, detail: str) -> None:
        """Keep what people are told."""
        self.told.append((phase, fraction, detail))

    def tell_reward(self, terms: Mapping[str, float]) -> None:
        """Keep what the last step earned."""
        self.rewards.append(dict(terms))

    def motions(self, kind: type[Motion]) -> list[Motion]:
        """All motions of one kind."""
        return [r.motion for r in self.records if isinstance(r, StepRecord) and isinstance(r.motion, kind)]

    def queries(self) -> list[TrunkPathQuery]:
        """All queries for a path of the trunk."""
        return [r.query for r in self.records if isinstance(r, PlanRecord) and isinstance(r.query, TrunkPathQuery)]

    def box_queries(self) -> list[BoxPathQuery]:
        """All queries for a path of the box."""
        return [r.query for r in self.records if isinstance(r, PlanRecord) and isinstance(r.query, BoxPathQuery)]

    def _make_plans(self, query: PlanQuery, _interrupted: Interrupted) -> Iterator[Plan]:
        yield self.planner(query)
        for revision in count(1):
            yield self.better(query, revision)
