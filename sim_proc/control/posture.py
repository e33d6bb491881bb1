"""The commanded posture of the robot, its correction by measured feet, and the joint commands that track a motion."""

from copy import copy

import numpy as np

from legpush.arrays import Floats
from legpush.scene.conventions import CONTROL_PERIOD_S, JOINTS
from sim_proc.control.balance import foot_forces
from sim_proc.control.joint_commands import interpolated, knots, ramped
from sim_proc.control.plant import Plant, TickLog, Touchdown
from sim_proc.control.push_force import PushForce, pushing_forces
from sim_proc.control.swing import minimum_jerk
from sim_proc.control.watch import Watch
from sim_proc.gravity import GRAVITY_M_S2
from sim_proc.kinematics.leg import SIDE, LegKinematics
from sim_proc.kinematics.reach import require_reach


class Posture:
    """The commanded posture of a robot whose trunk is level at its standing height."""

    def __init__(self, plant: Plant) -> None:
        """Begin with the posture in which the robot stands."""
        self.plant = plant
        robot = plant.robot
        self._kinematics = LegKinematics(robot)
        self._height_m = self.height_goal_m = robot.stance.height_m
        """Commanded height of the trunk, and the one that it is brought to."""
        self._climb_m = robot.rough.climb_m_s * CONTROL_PERIOD_S
        self._max_speeds_rad_s = np.array(len(SIDE) * [joint.max_speed_rad_s for joint in robot.joints.in_order()])
        self._press_m = robot.gait.press_m
        self._uncorrected: Floats = 1.0 - minimum_jerk(robot.gait.reanchor_ticks)
        """Share of a correction by measured feet that is left after each of the first ticks."""
        self._tolerance_m = robot.gait.landing_speed_m_s * robot.gait.landing_ticks * CONTROL_PERIOD_S
        trunk = plant.trunk_pose()
        self.trunk_xy_m: Floats = trunk.xy()
        self.yaw_rad = trunk.yaw_rad
        self.yaw_rate_rad_s = 0.0
        self.feet_m: Floats = plant.tips_m().copy()
        self.joints_rad: Floats = plant.joints_rad()
        self._joint_velocities_rad_s: Floats = np.zeros(12)
        self._joint_torques_n_m: Floats | None = None
        """Velocities and torques that were commanded last; no torques yet while the robot stands at its start."""
        self.com_state: Floats = np.zeros((3, 2))
        """Planned position, velocity and acceleration of the centre of mass over the ground, (3, 2)."""
        self.com_offset_m: Floats = np.zeros(2)
        """From the trunk to the centre of mass as last measured, world frame, (2,)."""
        self.measure()

    def measure(self, *, heights: bool = False) -> None:
        """Replace the commanded feet by the measured ones, and move the commanded trunk along with them.

        Their heights are replaced with `heights`, where they are not nearly the same.

        Feet roll and settle by a few millimetres, and legs whose commands ignore it push against each other. The planar
        motion that best fits the commanded feet onto the measured ones is applied to the commanded trunk.
        """
        plant = self.plant
        commanded, measured = self.feet_m[:, :2], plant.tips_m()[:, :2]
        centre_c, centre_m = commanded.mean(axis=0), measured.mean(axis=0)
        from_c, from_m = commanded - centre_c, measured - centre_m
        cross = (from_c[:, 0] * from_m[:, 1] - from_c[:, 1] * from_m[:, 0]).sum()
        turn = float(np.arctan2(cross, (from_c * from_m).sum()))
        c, s = np.cos(turn), np.sin(turn)
        self.trunk_xy_m = centre_m + np.array([[c, -s], [s, c]]) @ (self.trunk_xy_m - centre_c)
        self.yaw_rad += turn
        self.feet_m[:, :2] = measured
        if heights:
            for leg, height_m in enumerate(self.feet_m[:, 2].tolist()):
                self.put_down(leg, height_m)
        self.com_offset_m = plant.com_m()[:2] - plant.trunk_pose().xy()
        self.com_state[0] = self.trunk_xy_m + self.com_offset_m

    def measured(self) -> "Posture":
        """A copy of this posture, corrected by the measured feet. This one stays as it is."""
        other = copy(self)
        other.feet_m, other.com_state = self.feet_m.copy(), self.com_state.copy()
        other.measure()
        return other

    def require_reach(
        self, what: str, leg: int, trunk_xy_m: Floats, yaw_rad: Floats, curve_m: Floats, within_m: Floats
    ) -> None:
        """Check that a leg follows a curve (n, 3), to distances (n,), from trunks (n, 2) and (n,).

        `what` names the curve in the error.

        Raises:
            MotionError: The limits of the joints, with the robot's margin, do not allow it.
        """
        feet = np.repeat(curve_m[:, None], len(SIDE), axis=1)
        heights = np.full(len(feet), self._height_m)
        tips_h = self._tips_h(trunk_xy_m, _rotations(-yaw_rad), feet, heights)[:, leg]
        require_reach(
            self._kinematics,
            what,
            tips_h,
            float(SIDE[leg]),
            margin_deg=self.plant.robot.pushing.reach_margin_deg,
            within_m=within_m,
        )

    def stand(self, n_ticks: int) -> TickLog:
        """Stand still with the load on all feet."""
        return self.track(
            np.repeat(self.trunk_xy_m[None], n_ticks, axis=0),
            np.full(n_ticks, self.yaw_rad),
            np.repeat(self.feet_m[None], n_ticks, axis=0),
            np.ones((n_ticks, 4)),
            np.repeat(self.com_state[:1], n_ticks, axis=0),
            np.zeros((n_ticks, 2)),
        )

    def track(
        self,
        trunk_xy_m: Floats,
        yaw_rad: Floats,
        feet_m: Floats,
        load_share: Floats,
        zmp_m: Floats,
        acceleration_m_s2: Floats,
        until: Touchdown | None = None,
        watch: Watch | None = None,
        push: PushForce | None = None,
        uncorrected: Floats | None = None,
    ) -> TickLog:
        """Carry out a motion of trunk (n, 2) and (n,) and feet (n, 4, 3), one row per tick, world frame.

        It ends early at a touchdown, and where the robot is too far from its plan.

        `load_share` (n, 4), `zmp_m` (n, 2) and `acceleration_m_s2` (n, 2) give the forces of the feet, and `push` the
        force of one of them on the box.

        Joint targets come from inverse kinematics. Their velocities, and the torques of the planned foot forces and of
        the planned motion, are fed forward. A correction by measured feet is spread over the first ticks.
        """
        n = len(yaw_rad)
        from_world = _rotations(-np.append(self.yaw_rad, yaw_rad))
        trunks = np.concatenate([self.trunk_xy_m[None], trunk_xy_m])
        heights = self._heights_m(n)
        joints = self._inverse(trunks, from_world, np.concatenate([self.feet_m[None], feet_m]), heights)
        present, planned, from_world = joints[0].ravel(), joints[1:], from_world[1:]
        against_fall = acceleration_m_s2 - GRAVITY_M_S2 * self.plant.downhill
        balance = feet_m, load_share, zmp_m, against_fall, self.plant.mass_kg
        forces = foot_forces(*balance) if push is None else pushing_forces(*balance, push)
        forces[:, :, :2] = np.einsum("nij,nlj->nli", from_world, forces[:, :, :2])
        torques = -np.einsum("nlij,nli->nlj", self._kinematics.jacobian(planned, SIDE), forces).reshape(n, 12)
        planned = planned.reshape(n, 12)
        left = (self._uncorrected if uncorrected is None else uncorrected)[:n]
        # Measured feet move the joints of the commanded trunk and feet away from the last commands.
        planned[: len(left)] += left[:, None] * (self.joints_rad - present)
        motion = knots(self.joints_rad, self._joint_velocities_rad_s, planned)
        torques += self.plant.inverse_dynamics_n_m(motion, yaw_rad)
        before = torques[0] if self._joint_torques_n_m is None else self._joint_torques_n_m
        log = self.plant.run(interpolated(motion, np.concatenate([before[None], torques])), until, watch)
        last = len(log.qpos) - 1
        self.joints_rad, self._joint_velocities_rad_s = (
            motion.positions_rad[last + 1],
            motion.velocities_rad_s[last + 1],
        )
        self._joint_torques_n_m = torques[last]
        self._height_m = float(heights[last + 1])
        self.trunk_xy_m, self.yaw_rad, self.feet_m = trunk_xy_m[last].copy(), float(yaw_rad[last]), feet_m[last].copy()
        if until is not None and until.stops_leg and log.touched_down and last < until.landing_tick:
            self._stop_leg(until.leg)
        return log

    def commanded_tips_b(self) -> Floats:
        """Where the feet are commanded to be, (4, 3), trunk frame."""
        tips: Floats = self._kinematics.forward(self.joints_rad.reshape(len(SIDE), 3), SIDE) + self._kinematics.hips_b
        return tips

    def react(self, tips_b: Floats, forces_b: Floats) -> TickLog:
        """Move the feet to `tips_b` (4, 3) in one tick, and push with `forces_b` (4, 3) on the floor; trunk frame.

        The joints move evenly, at most as fast as they can. Where trunk and feet are planned to be is not changed.
        """
        joints = self._kinematics.inverse(tips_b - self._kinematics.hips_b, SIDE, saturate=True)
        torques = -np.einsum("lij,li->lj", self._kinematics.jacobian(joints, SIDE), forces_b).ravel()
        farthest = CONTROL_PERIOD_S * self._max_speeds_rad_s
        step = np.clip(joints.ravel() - self.joints_rad, -farthest, farthest)
        before = torques if self._joint_torques_n_m is None else self._joint_torques_n_m
        log = self.plant.run(ramped(self.joints_rad, self.joints_rad + step, before, torques))
        self.joints_rad = self.joints_rad + step
        self._joint_velocities_rad_s, self._joint_torques_n_m = step / CONTROL_PERIOD_S, torques
        return log

    def resume(self, touchdown_m: float, contact_n: float, *, uneven: bool = False) -> None:
        """Go on from where trunk and feet are, after a motion that was not planned.

        A foot that carries `contact_n` is down, and its planned height is `touchdown_m`. The others are put down as
        high as those stand, or where they are if the floor is uneven.
        """
        state = self.plant.body_state()
        trunk = self.plant.trunk_pose()
        self.trunk_xy_m, self.yaw_rad, self.yaw_rate_rad_s = trunk.xy(), trunk.yaw_rad, 0.0
        self.feet_m = self.plant.tips_m().copy()
        down = state.loads_n >= contact_n
        if uneven:
            down[:] = True
        for leg in np.flatnonzero(down).tolist():
            self.put_down(leg, touchdown_m)
        self.feet_m[~down, 2] = self.feet_m[down, 2].mean() if down.any() else touchdown_m
        self.com_offset_m = self.plant.com_m()[:2] - self.trunk_xy_m
        self.com_state = np.stack([self.trunk_xy_m + self.com_offset_m, state.com_velocity_m_s[:2], np.zeros(2)])

    def put_down(self, leg: int, planned_m: float) -> None:
        """Take over the measured height of a foot that is down, or the planned one if that is nearly the same.

        A foot is pressed a little into the floor.
        """
        height_m = self.plant.tips_m()[leg, 2] - self._press_m
        self.feet_m[leg, 2] = planned_m if abs(height_m - planned_m) <= self._tolerance_m else height_m

    def _stop_leg(self, leg: int) -> None:
        """Command a leg that met the floor on its way to stay where it is."""
        joints = slice(leg * len(JOINTS), (leg + 1) * len(JOINTS))
        self.joints_rad[joints] = self.plant.joints_rad()[joints]
        self._joint_velocities_rad_s[joints] = 0.0
        self.feet_m[leg] = self.plant.tips_m()[leg]

    def _heights_m(self, n_ticks: int) -> Floats:
        """Heights of the trunk now and at the ends of ticks, (n + 1,), which go evenly to the goal."""
        change_m, farthest_m = self.height_goal_m - self._height_m, self._climb_m * np.arange(n_ticks + 1)
        heights: Floats = self._height_m + np.clip(change_m, -farthest_m, farthest_m)
        return heights

    def _inverse(self, trunk_xy_m: Floats, from_world: Floats, feet_m: Floats, heights_m: Floats) -> Floats:
        """Joint angles, (n, 4, 3), of trunks (n, 2) at heights (n,) with rotations (n, 2, 2) into their frames.

        The feet are at `feet_m` (n, 4, 3).
        """
        return self._kinematics.inverse(self._tips_h(trunk_xy_m, from_world, feet_m, heights_m), SIDE, saturate=True)

    def _tips_h(self, trunk_xy_m: Floats, from_world: Floats, feet_m: Floats, heights_m: Floats) -> Floats:
        """Feet in their hip frames, (n, 4, 3)."""
        tips_b = feet_m.copy()
        tips_b[:, :, :2] -= trunk_xy_m[:, None]
        tips_b[:, :, 2] -= heights_m[:, None]
        tips_b[:, :, :2] = np.einsum("nij,nlj->nli", from_world, tips_b[:, :, :2])
        return tips_b - self._kinematics.hips_b


def _rotations(yaw_rad: Floats) -> Floats:
    """Planar rotations, (n, 2, 2)."""
    rotations, sine = np.empty((len(yaw_rad), 2, 2)), np.sin(yaw_rad)
    rotations[:, 0, 0] = rotations[:, 1, 1] = np.cos(yaw_rad)
    rotations[:, 0, 1], rotations[:, 1, 0] = -sine, sine
    return rotations
