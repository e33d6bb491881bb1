"""A simulator without physics: a push moves the box as the response map says, and the robot stands at its station."""

from collections.abc import Callable
from functools import cache, partial
from math import cos, sin
from pathlib import Path
from struct import Struct
from typing import Final
from zlib import crc32

from agent_proc.map_world.effects import DrawnEffects, Effects, MeasuredEffects
from agent_proc.map_world.random_pushes import Stance
from agent_proc.map_world.response_map import ResponseMap, load_response_map
from legpush.errors import MotionError, ScenarioError
from legpush.geometry import Point3, Pose2, wrap_angle
from legpush.messages.stepping import (
    BoxState,
    Follow,
    Imu,
    Motion,
    Outcome,
    PathProgress,
    Push,
    PushReport,
    Reset,
    Trace,
    TrunkState,
    Walk,
    WorldState,
)
from legpush.realism.reality import drawn_reality
from legpush.scenarios.file import realism_table
from legpush.scenarios.start import drawn_poses
from legpush.scene.conventions import CONTROL_PERIOD_S
from legpush.scene.faces import TURN_RAD, pushed_box, pushed_pose
from legpush.scene.paths import path_length_m
from legpush.scene.scenario import Scenario
from legpush.scene.station import at_station, station

GRAVITY_M_S2: Final = 9.81
WALK_S: Final = 6.8
WALK_S_PER_M: Final = 3.84
"""Duration of a walk around the box, and for each metre of its path, turns included: in the simulator, walks to a face
beside the present one take 21.5 s and those to the opposite face 29 to 31 s."""
NO_TICKS: Final = Trace(
    tick=(), qpos=(), roll_pitch_rad=(), tips_m=(), contact_forces_n=(), com_m=(), zmp_m=(), support_margin_m=()
)
STATE: Final = Struct("<6d2q")
FIRST_SEED: Final = 0
REST: Final = (0.0, 0.0, 0.0)


class MapSimulator:
    """Pushes a box without physics. Nothing stops the box, and the robot never falls.

    A walk ends after one gait cycle exactly at the end of its path, with the time that such walks take. What stands in
    the way is not noticed.

    Start poses and residuals follow from the seed of the reset, so equal motions lead to equal states.
    """

    def __init__(
        self,
        response_map: ResponseMap | Path | None = None,
        *,
        effects: Callable[[ResponseMap], Effects] = MeasuredEffects,
    ) -> None:
        """Use a map, the one in a file, or the one of the default box; `effects` makes what pushes do of it.

        Raises:
            ConfigError: The file cannot be used.
        """
        if not isinstance(response_map, ResponseMap):
            response_map = _default_map() if response_map is None else load_response_map(response_map)
        self._map = response_map
        self._effects = effects(response_map)
        self._checked: Scenario | None = None
        self._scenario: Scenario | None = None
        self._seed = 0
        self._way: tuple[Pose2, ...] = ()
        self._path: PathProgress | None = None

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        """Carry out a motion; the trace has no ticks.

        Raises:
            MotionError: It is another motion, or the present state does not allow it.
            ScenarioError: The map does not describe this box, robot or floor.
        """
        if isinstance(motion, Reset):
            self._reset(motion)
        elif self._scenario is None:
            raise MotionError(
                f"Expected `reset` as the first motion of an episode, got `{motion.__struct_config__.tag}`"
            )
        elif isinstance(motion, Push):
            self._push(self._scenario, motion)
        elif isinstance(motion, Follow):
            length_m = path_length_m(motion.waypoints, self._scenario.robot.stance.foot_circle_m)
            self._way = motion.waypoints
            self._path = PathProgress(travelled_m=0.0, length_m=length_m, done=length_m == 0.0)
        elif isinstance(motion, Walk):
            self._walk()
        else:
            raise MotionError(
                "Expected `reset`, `push`, `follow` or `walk` in a world without physics, got "
                f"`{motion.__struct_config__.tag}`"
            )
        return Outcome(world=self._world(), state_crc=self._state_crc(), trace=NO_TICKS if with_trace else None)

    def require_described(self, scenario: Scenario) -> None:
        """Require a scenario that the map describes.

        Raises:
            ScenarioError: Box, robot or floor are others, or the robot does not know what it senses.
        """
        if n_obstacles := len(scenario.room.obstacles):
            raise ScenarioError(
                f"{scenario.name}: expected a floor without obstacles for a world without physics, got "
                f"{n_obstacles} of them"
            )
        self._effects.require_described(scenario)
        _require_ideal(scenario, FIRST_SEED)

    def _reset(self, reset: Reset) -> None:
        scenario = reset.scenario
        if scenario is not self._checked:
            self.require_described(scenario)
            self._checked = scenario
        self._scenario, self._seed = scenario, reset.seed
        _require_ideal(scenario, reset.seed)
        self._trunk, self._box = drawn_poses(scenario, reset.seed)
        self._box_height_m = scenario.box.size_m[2]
        self._stance = self._map.stances.start
        self._tick, self._n_pushes, self._n_footsteps = 0, 0, 0
        self._way, self._path = (), None
        self._is_fresh = True
        self._last_push: Push | None = None
        self._effects.begin(scenario, reset.seed)

    def _walk(self) -> None:
        """Come to the end of the path.

        Raises:
            MotionError: There is none.
        """
        if self._path is None:
            raise MotionError("Expected `follow` before `walk`: there is no path")
        if self._path.done:
            raise MotionError("The path is walked to its end: expected another `follow` before `walk`")
        length_m = self._path.length_m
        self._path = PathProgress(travelled_m=length_m, length_m=length_m, done=True)
        self._trunk, self._stance, self._is_fresh = self._way[-1], self._map.stances.start, True
        self._tick += round((WALK_S + WALK_S_PER_M * length_m) / CONTROL_PERIOD_S)
        self._n_footsteps += 4

    def _push(self, scenario: Scenario, push: Push) -> None:
        robot, before = scenario.robot, pushed_pose(self._box, push.face)
        box = pushed_box(scenario.box, push.face)
        if not at_station(robot, self._trunk, box, before):
            raise MotionError(f"Expected the robot at its station behind the {push.face} face, got it at {self._trunk}")
        pushed = self._effects.after(before, push, first=self._is_fresh)
        self._box = Pose2(x_m=pushed.x_m, y_m=pushed.y_m, yaw_rad=wrap_angle(pushed.yaw_rad - TURN_RAD[push.face]))
        self._stance = getattr(self._map.stances, push.leg)
        self._trunk = station(robot, box, pushed) @ self._stance.trunk
        self._n_pushes += 1
        self._tick += self._map.ticks_per_push
        self._n_footsteps += self._map.footsteps_per_push
        self._last_push, self._path, self._is_fresh = push, None, False

    def _state_crc(self) -> int:
        """CRC-32 of the poses, and of seed and number of pushes, from which the residuals to come follow."""
        poses = (c for pose in (self._trunk, self._box) for c in (pose.x_m, pose.y_m, pose.yaw_rad))
        return crc32(STATE.pack(*poses, self._n_pushes, self._seed))

    def _world(self) -> WorldState:
        response_map, stance, trunk, box = self._map, self._stance, self._trunk, self._box
        orientation = _turned(trunk.yaw_rad)
        robot, push = response_map.robot, self._last_push
        return WorldState(
            tick=self._tick,
            trunk=TrunkState(
                position_m=(trunk.x_m, trunk.y_m, stance.trunk_height_m),
                orientation_wxyz=orientation,
                linear_velocity_m_s=REST,
                angular_velocity_rad_s=REST,
            ),
            joint_positions_rad=stance.joint_positions_rad,
            joint_velocities_rad_s=(0.0,) * 12,
            tips_m=_tips_w(stance, trunk),
            foot_forces_n=(robot.mass_kg * GRAVITY_M_S2 / 4,) * 4,
            imu=Imu(
                orientation_wxyz=orientation,
                angular_velocity_rad_s=REST,
                linear_acceleration_m_s2=(0.0, 0.0, GRAVITY_M_S2),
            ),
            box=BoxState(position_m=(box.x_m, box.y_m, self._box_height_m / 2), orientation_wxyz=_turned(box.yaw_rad)),
            n_footsteps=self._n_footsteps,
            fallen=False,
            path=self._path,
            push=None
            if push is None
            else PushReport(leg=push.leg, touched=True, peak_force_n=response_map.peak_force_n),
            appeared=(),
        )


def mean_map_simulator() -> MapSimulator:
    """A simulator of the default box whose pushes have no residuals."""
    return MapSimulator(effects=partial(MeasuredEffects, residuals=False))


def unknown_box_simulator() -> MapSimulator:
    """A simulator of boxes of any size, of which each episode draws another one."""
    return MapSimulator(effects=DrawnEffects)


def _require_ideal(scenario: Scenario, seed: int) -> None:
    """Require a world that is what the robot takes it to be (`ScenarioError`)."""
    if not drawn_reality(scenario.realism, seed).ideal:
        raise ScenarioError(
            f"{scenario.name}: expected a world that is what the robot takes it to be, without physics, got "
            f"`realism` with {', '.join(realism_table(scenario.realism))}"
        )


_default_map = cache(load_response_map)


def _tips_w(stance: Stance, trunk: Pose2) -> tuple[Point3, Point3, Point3, Point3]:
    """Centres of the foot spheres, world frame."""
    c, s = cos(trunk.yaw_rad), sin(trunk.yaw_rad)
    fl, fr, rl, rr = ((trunk.x_m + c * x - s * y, trunk.y_m + s * x + c * y, z) for x, y, z in stance.tips_m)
    return fl, fr, rl, rr


def _turned(yaw_rad: float) -> tuple[float, float, float, float]:
    """Quaternion of a level body with this heading."""
    return cos(yaw_rad / 2), 0.0, 0.0, sin(yaw_rad / 2)
