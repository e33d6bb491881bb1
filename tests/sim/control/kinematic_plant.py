"""A plant without physics: joints follow their commands exactly, and feet on the floor stay where they are."""

from math import atan2

import numpy as np
from scipy.spatial.transform import Rotation

from legpush.arrays import Flags, Floats
from legpush.geometry import Pose2
from legpush.scene.conventions import N_QPOS
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box
from sim_proc.control.body_state import BodyState
from sim_proc.control.joint_commands import COMMAND_PERIOD_S, COMMANDS_PER_TICK, JointCommands, Knots
from sim_proc.control.plant import StepLog, TickLog, Touchdown
from sim_proc.control.watch import Watch
from sim_proc.gravity import GRAVITY_M_S2
from sim_proc.kinematics.leg import SIDE, LegKinematics
from tests.robots import ROBOT

COM_BELOW_TRUNK_M = 0.05
TOUCHING_M = 1e-4
"""A foot stands if its sphere is at most this far above the floor."""


class KinematicPlant:
    """A robot whose level trunk moves as its standing feet make it, and a box that its front feet push ahead."""

    def __init__(
        self,
        trunk: Pose2,
        box: Box,
        *,
        falls_at_tick: int | None = None,
        thrown_at_tick: int | None = None,
        robot: RobotSpec = ROBOT,
    ) -> None:
        """Stand at `trunk`, beside the box at its nominal pose.

        In the tick `thrown_at_tick` a watch sees the robot a metre beside its plan.
        """
        self.fallen = False
        self.robot = robot
        self._kinematics = LegKinematics(robot)
        self.mass_kg = 32.0
        self.downhill = np.zeros(2)
        self.late_ticks = None
        self.n_ticks = 0
        self._trunk, self._box, self._box_pose = trunk, box, box.pose.pose()
        self._joints = self._kinematics.standing_joints_rad()
        self._falls_at_tick, self._thrown_at_tick = falls_at_tick, thrown_at_tick

    def trunk_pose(self) -> Pose2:
        return self._trunk

    def place_of_world(self) -> Pose2 | None:
        return None

    def box_pose(self) -> Pose2:
        return self._box_pose

    def body_state(self) -> BodyState:
        still = np.zeros(3)
        return BodyState(
            position_m=np.array([*self._trunk.xy(), self.robot.stance.height_m]),
            rotation=Rotation.from_euler("z", self._trunk.yaw_rad).as_matrix(),
            velocity_m_s=still,
            angular_velocity_rad_s=still,
            tips_m=self.tips_m(),
            loads_n=self._floor_forces()[:, 2],
            com_m=self.com_m(),
            com_velocity_m_s=still,
        )

    def push_forces_n(self, log: TickLog, leg: int) -> Floats:
        return log.steps.forces_on_box_n(leg)

    def joints_rad(self) -> Floats:
        return self._joints.ravel().copy()

    def tips_m(self) -> Floats:
        tips = self._tips_b()
        tips[:, :2] = self._trunk.apply(tips[:, :2])
        tips[:, 2] += self.robot.stance.height_m
        return tips

    def com_m(self) -> Floats:
        return np.array([*self._trunk.xy(), self.robot.stance.height_m - COM_BELOW_TRUNK_M])

    def inverse_dynamics_n_m(self, motion: Knots, yaw_rad: Floats) -> Floats:
        assert len(motion.positions_rad) == len(yaw_rad) + 1
        return np.zeros_like(motion.positions_rad[1:])

    def run(self, commands: JointCommands, until: Touchdown | None = None, watch: Watch | None = None) -> TickLog:
        assert commands.positions_rad.shape == commands.torques_n_m.shape
        before, last = commands.velocities_rad_s[:, -2], commands.velocities_rad_s[:, -1]
        ends = commands.positions_rad[:, -1] + COMMAND_PERIOD_S * (last + 0.5 * (last - before))
        rows: list[tuple[Floats, ...]] = []
        touched_down = left_plan = False
        for tick, (command, end) in enumerate(zip(commands.positions_rad, ends, strict=True)):
            self._move(end.reshape(4, 3))
            rows.append((self._qpos(), self.tips_m(), self._floor_forces(), self._push_box(), self.com_m(), command))
            self.n_ticks += 1
            if self.n_ticks == self._falls_at_tick:
                self.fallen = True
                break
            if watch is not None and self.n_ticks == self._thrown_at_tick:
                thrown = np.full((tick + 1, 3), 9.0)
                left_plan = watch.alarm(thrown, np.zeros_like(thrown), np.zeros((tick + 1, 4, 3))) is not None
                break
            if until is not None and tick >= until.first_tick:
                touched_down = bool(rows[-1][2][until.leg, 2] >= until.force_n)
                if touched_down and tick < until.landing_tick:
                    break
        qpos, tips, floor, box, com, ctrl = (np.array(column) for column in zip(*rows, strict=True))
        n = len(qpos)
        steps = StepLog(
            tips_m=_each_step(tips),
            floor_forces_n=_each_step(floor),
            box_forces_n=_each_step(box),
            com_m=_each_step(com),
            com_velocity_m_s=np.zeros((n, COMMANDS_PER_TICK, 3)),
            joint_positions_rad=ctrl,
            joint_velocities_rad_s=commands.velocities_rad_s[:n],
            joint_torques_n_m=commands.torques_n_m[:n],
            trunk_velocity_m_s=np.zeros((n, COMMANDS_PER_TICK, 3)),
            imu_angular_velocity_rad_s=np.zeros((n, COMMANDS_PER_TICK, 3)),
            imu_acceleration_m_s2=np.zeros((n, COMMANDS_PER_TICK, 3)),
        )
        return TickLog(
            qpos=qpos,
            tips_m=tips,
            floor_forces_n=floor,
            box_forces_n=box,
            com_m=com,
            ctrl=ctrl,
            steps=steps,
            touched_down=touched_down,
            left_plan=left_plan,
        )

    def _move(self, joints_rad: Floats) -> None:
        """Place the trunk so that the feet that stand before and after the move stay where they are."""
        standing, places = self._standing(), self.tips_m()[:, :2]
        self._joints = joints_rad
        both = standing & self._standing()
        assert both.sum() >= 2
        tips_b, places = self._tips_b()[both, :2], places[both]
        centre_b, centre = tips_b.mean(axis=0), places.mean(axis=0)
        (x_b, y_b), (x, y) = (tips_b - centre_b).T, (places - centre).T
        yaw = atan2((x_b * y - y_b * x).sum(), (x_b * x + y_b * y).sum())
        away = centre - Pose2(x_m=0.0, y_m=0.0, yaw_rad=yaw).apply(centre_b[None])[0]
        self._trunk = Pose2(x_m=float(away[0]), y_m=float(away[1]), yaw_rad=yaw)

    def _tips_b(self) -> Floats:
        return self._kinematics.hips_b + self._kinematics.forward(self._joints, SIDE)

    def _standing(self) -> Flags:
        standing: Flags = (
            self._tips_b()[:, 2] + self.robot.stance.height_m <= self.robot.legs.foot_radius_m + TOUCHING_M
        )
        return standing

    def _floor_forces(self) -> Floats:
        """Standing feet share the weight evenly."""
        forces = np.zeros((4, 3))
        standing = self._standing()
        forces[standing, 2] = self.mass_kg * GRAVITY_M_S2 / standing.sum()
        return forces

    def _push_box(self) -> Floats:
        """Move the box out of the front feet, with 1 N on a foot that moves it."""
        forces = np.zeros((4, 3))
        length, width, height = self._box.size_m
        for leg, tip in enumerate(self.tips_m()[:2]):
            x, y = self._box_pose.inverse().apply(tip[None, :2])[0]
            inside_m = x + self.robot.legs.foot_radius_m + length / 2
            if 0.0 < inside_m < length / 2 and abs(y) < width / 2 and tip[2] < height:
                self._box_pose = self._box_pose @ Pose2(x_m=float(inside_m), y_m=0.0, yaw_rad=0.0)
                forces[leg, 0] = -1.0
        return forces

    def _qpos(self) -> Floats:
        def pose(place: Pose2, height_m: float) -> list[float]:
            return [place.x_m, place.y_m, height_m, np.cos(place.yaw_rad / 2), 0.0, 0.0, np.sin(place.yaw_rad / 2)]

        box_height_m = self._box.size_m[2] / 2
        qpos = np.array(
            [*pose(self._trunk, self.robot.stance.height_m), *self._joints.ravel(), *pose(self._box_pose, box_height_m)]
        )
        assert qpos.shape == (N_QPOS,)
        return qpos


def _each_step(rows: Floats) -> Floats:
    """Rows of ticks, the same in each physics step."""
    return np.repeat(rows[:, None], COMMANDS_PER_TICK, axis=1)
