"""The running world: MuJoCo's model and data, measured in the order of `LEGS`, and the control loop."""

from collections.abc import Iterable
from functools import partial
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.messages.stepping import Appearance
from legpush.realism.reality import AS_ASSUMED, Reality
from legpush.scene.conventions import BOX_QPOS, JOINT_QPOS, LEGS, TRUNK_QPOS
from legpush.scene.scenario import Scenario
from sim_proc.control.body_state import BodyState
from sim_proc.control.joint_commands import COMMANDS_PER_TICK, JointCommands, Knots
from sim_proc.control.plant import TickLog, Touchdown
from sim_proc.control.watch import Watch
from sim_proc.estimation.plumb_line import PlumbLine
from sim_proc.headless import mujoco
from sim_proc.kinematics.actuator_limits import ActuatorLimits
from sim_proc.model.actual import actual_robot
from sim_proc.model.scenery import wall_name
from sim_proc.model.world import JOINT_QVEL, build_model
from sim_proc.perception import Perception, planar
from sim_proc.physics.appearing import Waiting
from sim_proc.physics.assumed_body import AssumedBody, downhill_of
from sim_proc.physics.contacts import ContactWatch
from sim_proc.physics.delay import CommandDelay
from sim_proc.physics.exact_state import exact_state
from sim_proc.physics.gusts import GustSchedule
from sim_proc.physics.inverse_dynamics import InverseDynamics
from sim_proc.physics.landing import BLOCKED_SHARE, Landing
from sim_proc.physics.moment import Moment
from sim_proc.physics.senses import senses_of
from sim_proc.physics.sensors import Sensors
from sim_proc.physics.soundness import Falls, require_sound
from sim_proc.physics.start import standing_qpos
from sim_proc.physics.state_crc import STATE, crc_of_numbers, crc_of_state
from sim_proc.physics.ticks import Ticks

PARKED_M: Final = 1000.0
"""Depth at which obstacles wait until they appear, out of reach of contacts, rays and cameras."""


class Physics:
    """The robot beside the box in MuJoCo, a `Plant`. Only `run` advances it."""

    late_ticks = None
    """By how many ticks the joints are known to move later than commanded: nobody looks."""

    def __init__(self, scenario: Scenario, trunk: Pose2, box: Pose2, reality: Reality = AS_ASSUMED) -> None:
        """Stand the robot at `trunk` and the box at `box`, at rest, in a world as `reality` has it."""
        self.robot = robot = scenario.robot
        """The numbers of the robot, as control knows them."""
        self._reality, self.actual_robot = reality, actual_robot(robot, reality)
        """The numbers of the robot as they are."""
        self._numbers_crc = crc_of_numbers(robot, reality)
        self.model = build_model(scenario, reality)
        self.data = mujoco.MjData(self.model)
        model, data = self.model, self.data
        self._ticks = Ticks(model, data, forces=reality.has_gusts)
        self._tip_sites = np.array([model.site(f"{leg}_tip").id for leg in LEGS])
        self._trunk_body = model.body("trunk").id
        self.assumed = AssumedBody(model if reality.as_assumed else build_model(scenario))
        self._plumb_line = PlumbLine(self.assumed.downhill)
        self.actual_downhill: Floats = downhill_of(model)
        """The same of the floor as it is."""
        self.mass_kg = self.assumed.mass_kg
        self._sensors = sensors = Sensors(model)
        self._joint_sensors = sensors.joint_positions, sensors.joint_velocities, sensors.joint_torques
        joints = robot.joints.in_order()
        self._compliances = np.array(len(LEGS) * [1.0 / joint.position_gain_n_m_rad for joint in joints])
        self._velocity_gains = np.array(len(LEGS) * [joint.velocity_gain_n_m_s_rad for joint in joints])
        self._limits, self._falls = ActuatorLimits(self.actual_robot), Falls(robot)
        self._dynamics = InverseDynamics(self.assumed.model, robot)
        self.contacts = ContactWatch(model, sensors)
        """Counts the contacts that no plan asked for."""
        data.qpos[:] = standing_qpos(scenario, trunk, box)
        self._places, self._box = (trunk, box), scenario.box
        data.ctrl[:] = data.qpos[JOINT_QPOS]
        self._delay = CommandDelay(reality.command_latency_s, data.ctrl)
        self._gusts = GustSchedule(reality, self._trunk_body)
        self._waiting = Waiting(scenario.room, scenario.box, robot)
        for index in self._waiting.indices:
            data.mocap_pos[self._wall(index), 2] = -PARKED_M
        self.appeared: tuple[Appearance, ...] = ()
        """Obstacles that have appeared, in that order."""
        mujoco.mj_forward(model, data)
        self.tick, self.fallen = 0, False
        self.perception = Perception(reality, data.qpos, scenario.box)
        self.senses = senses_of(reality, sensors, model, data)
        """The robot's own sensors."""

    @property
    def downhill(self) -> Floats:
        """Where a plumb line from one metre above the floor meets it, relative to the point below that, [m/m], (2,)."""
        return self._plumb_line.downhill

    def inverse_dynamics_n_m(self, motion: Knots, yaw_rad: Floats) -> Floats:
        """Torques at all knots but the first, (n, 12): what a motion of the joints takes."""
        return self._dynamics.torques_n_m(motion, yaw_rad)

    def run(self, commands: JointCommands, until: Touchdown | None = None, watch: Watch | None = None) -> TickLog:
        """Track joint commands, one row per tick; stop early at a fall, or after the tick of a touchdown or an alarm.

        Alarms are rare: all ticks are simulated at once, and those up to an alarm are simulated again. A servo is
        commanded `q + (torque + Kv velocity) / Kp`, and its torque stays within its limits. Tips, forces and the CoM
        are those at the beginning of the last physics step. An obstacle that is due is put in its place at the end of a
        tick.

        Raises:
            LegpushError: MuJoCo warned, or the state stopped being finite.
        """
        feed_forward = commands.torques_n_m + self._velocity_gains * commands.velocities_rad_s
        planned = commands.positions_rad + self._compliances * feed_forward
        landing, began = None if until is None else self._landing(until, commands), self._moment()
        self._gusts.begin_run(self.tick)
        speed, controls = self.data.qvel[:3].copy(), planned.copy()
        self.senses.begin_run(self.tick, len(controls))
        qpos, sensors = self._simulate(controls, landing)
        felt_n = partial(self.senses.pressing_n, began.tick)
        alarm = None if watch is None else self._sensors.alarm(watch, sensors, felt_n)
        if alarm is not None and alarm + 1 < len(qpos):
            self._go_back(began)
            planned = planned[: alarm + 1]
            controls = planned.copy()
            qpos, sensors = self._simulate(controls, landing)
        rows = sensors.reshape(-1, sensors.shape[-1])
        beyond = self._limits.beyond(*(rows[:, columns].copy(order="F") for columns in self._joint_sensors)).any()
        if beyond or self.contacts.suspects(sensors) or (self.fallen and len(qpos) < len(controls)):
            # Limits at angles and speeds cost much and are met rarely, and so are unexpected contacts and falls: only
            # then is the motion simulated step by step.
            self._go_back(began)
            controls = planned.copy()
            qpos, sensors = self._simulate(controls, landing, stepwise=True, limited=bool(beyond))
        require_sound(self.data.warning.number, qpos, self.tick)
        if self._reality.senses.exact:
            self._plumb_line.feel(*self._sensors.imu(sensors), self.data.qvel[:3] - speed)
        steps, felt = self._sensors.steps(sensors), self.senses.of_tick(len(qpos) - 1, sensors)
        self.perception.take(self.tick - len(qpos) + 1, qpos, steps.tips_m[:, -1])
        self.senses.end_run(len(qpos))
        return TickLog(
            qpos=qpos,
            tips_m=steps.tips_m[:, -1],
            floor_forces_n=steps.floor_forces_n[:, -1],
            box_forces_n=steps.box_forces_n[:, -1],
            com_m=steps.com_m[:, -1],
            ctrl=controls[: len(qpos)],
            steps=steps,
            touched_down=landing is not None and landing.touched_down(len(qpos) - 1, felt),
            not_down=None if landing is None or alarm is not None else landing.not_down(len(qpos) - 1, felt),
            left_plan=alarm is not None,
        )

    def _moment(self) -> Moment:
        """All that a motion changes, as it is now."""
        state = np.empty(mujoco.mj_stateSize(self.model, STATE))
        mujoco.mj_getState(self.model, self.data, state, STATE)
        return Moment(state, self.tick, self._waiting.copy(), self.appeared, self.contacts.copy(), self._delay.copy())

    def _go_back(self, to: Moment) -> None:
        """Go back to a moment at which the robot stood."""
        mujoco.mj_setState(self.model, self.data, to.state, STATE)
        self.tick, self.appeared, self.fallen = to.tick, to.appeared, False
        self._waiting, self.contacts, self._delay = to.waiting.copy(), to.contacts.copy(), to.delay.copy()

    def _landing(self, touchdown: Touchdown, commands: JointCommands) -> Landing:
        holds = commands.positions_rad + self._compliances * commands.torques_n_m
        allowed_rad = BLOCKED_SHARE * self._compliances * self._limits.peak_n_m
        senses, lag = self.senses, (self.senses.joints, commands.positions_rad, allowed_rad)
        return Landing(touchdown, senses.forces, holds, lag, least_n=senses.least_touch_n, late_steps=senses.late_steps)

    def _simulate(
        self, controls: Floats, landing: Landing | None, *, stepwise: bool = False, limited: bool = False
    ) -> tuple[Floats, Floats]:
        """Run ticks with controls (n, steps, 12) up to a fall, a touchdown or a warning.

        Return `qpos` of each tick and the sensors of all steps. The controls become those that were commanded. With
        `stepwise`, contacts are watched, and with `limited`, torques are limited at the angles and speeds of each step.
        """
        n = len(controls)
        qpos, sensors = np.empty((n, self.model.nq)), np.empty((n, COMMANDS_PER_TICK, self.model.nsensordata))
        k = 0
        while k < n:
            self._gusts.blow(self.data, self.tick)
            if stepwise or (landing is not None and landing.may_stop(k)):
                ticks = slice(k, k + 1)
                planned = controls[k] if landing is None else self.senses.meanwhile(landing, k, controls[k], sensors)
                self._run_steps(self._delay.one_by_one(planned), sensors[k], limited=limited)
                qpos[k] = self.data.qpos
            else:
                last = n if landing is None else landing.next_look(k, n)
                change = min(self._waiting.next_tick, self._gusts.next_change(self.tick))
                ticks = slice(k, min(last, k + max(change - self.tick, 1)))
                qpos[ticks] = self._ticks.run(self.model, self._delay.of_ticks(controls[ticks]), sensors[ticks])
            k = ticks.stop
            self.tick += k - ticks.start
            self.senses.feel(ticks.start * COMMANDS_PER_TICK, sensors[ticks].reshape(-1, sensors.shape[-1]))
            if self._waiting.next_tick <= self.tick:
                self._let_appear(self.tick)
            for tick, row in enumerate(qpos[ticks, :6].tolist(), ticks.start):
                if self._falls.include(row):
                    self.fallen = True
                    return qpos[: tick + 1], sensors[: tick + 1]
            if np.count_nonzero(self.data.warning.number):
                break
            if landing is not None and landing.ends(k - 1, self.senses.of_tick(k - 1, sensors)):
                break
        return qpos[:k], sensors[:k]

    def _run_steps(self, controls: Iterable[Floats], sensors: Floats, *, limited: bool) -> None:
        """Run one tick step by step with controls (steps, 12), fill in the sensors of its steps, and watch contacts."""
        model, data, contacts, bounds = self.model, self.data, self.contacts, self.model.actuator_forcerange
        step, ctrl, sensordata = mujoco.mj_step, data.ctrl, data.sensordata
        contacts.begin_tick()
        for control, row in zip(controls, sensors, strict=True):
            if limited:
                bounds[:, 0], bounds[:, 1] = self._limits.bounds_n_m(data.qpos[JOINT_QPOS], data.qvel[JOINT_QVEL])
            ctrl[:] = control
            step(model, data)
            row[:] = sensordata
            if data.ncon != contacts.n_known:
                contacts.look(model, data)
        if limited:
            bounds[:, 0], bounds[:, 1] = -self._limits.peak_n_m, self._limits.peak_n_m

    def begin(self) -> None:
        """Begin the episode at tick 0, with robot and box at rest in their places on the floor.

        The robot may have stood before, until the floor carried it.
        """
        data = self.data
        for columns, place in zip((TRUNK_QPOS, BOX_QPOS), self._places, strict=True):
            data.qpos[columns][:2] = place.xy()
        data.qvel[:], data.time = 0.0, 0.0
        mujoco.mj_forward(self.model, data)
        self.tick = 0
        self.perception = Perception(self._reality, data.qpos, self._box)

    def alter(self, scenario: Scenario) -> None:
        """Go on with a scenario that differs from the present one only in mass or friction of the box."""
        self.model = build_model(scenario, self._reality)

    def _let_appear(self, tick: int) -> None:
        """Put obstacles in their places that can appear at the end of a tick."""
        for index in self._waiting.take_due(tick, self.trunk_pose(), planar(self.data.qpos[BOX_QPOS])):
            self.data.mocap_pos[self._wall(index)] = self.model.body(wall_name(index)).pos
            self.appeared += (Appearance(obstacle=index, tick=tick),)

    def _wall(self, index: int) -> int:
        """Row of an obstacle that appears later in MuJoCo's `mocap_pos`."""
        return int(self.model.body(wall_name(index)).mocapid[0])

    def sensor(self, name: str) -> Floats:
        """A copy of the reading of a sensor of the model."""
        return np.array(self.data.sensordata[self._sensors.of[name]])

    def body_state(self) -> BodyState:
        """The motion of trunk, feet and centre of mass."""
        return exact_state(self.data, self._trunk_body, self._sensors)

    def joints_rad(self) -> Floats:
        """Joint angles, (12,)."""
        return np.array(self.data.qpos[JOINT_QPOS])

    def tips_m(self) -> Floats:
        """Centres of the foot spheres, (4, 3)."""
        return np.array(self.data.site_xpos[self._tip_sites])

    def foot_forces_n(self) -> Floats:
        """Forces of floor and box on the feet, (4, 3)."""
        return self._sensors.foot_forces_n(self.data.sensordata)

    def push_forces_n(self, log: TickLog, leg: int) -> Floats:
        """Forces of a foot on the box as the foot feels them, means over each tick of a run that just ended, (n, 3)."""
        return self.senses.push_forces_n(self.tick - len(log.qpos), log.steps.forces_on_box_n(leg))

    def com_m(self) -> Floats:
        """Centre of mass of the robot as control takes it to be, (3,)."""
        if not self._reality.as_assumed:
            return self.assumed.com_m(self.data.qpos)
        return np.array(self.data.subtree_com[self._trunk_body])

    def box_pose(self) -> Pose2:
        """Pose of the box as it is perceived, projected to the floor."""
        return planar(self.perception.box(self.data.qpos))

    def place_of_world(self) -> Pose2 | None:
        """Where the frame of the world is taken to be, in the one of all measurements; None if they are the same."""
        return self.perception.place_of_world()

    def trunk_pose(self) -> Pose2:
        """Pose of the trunk, projected to the floor."""
        return planar(self.data.qpos[TRUNK_QPOS])

    def state_crc(self, more: bytes = b"") -> int:
        """CRC-32 of the numbers of robot and episode, MuJoCo's integration state, all that is on its way, and more."""
        under_way = self._delay.as_bytes() + self.perception.as_bytes() + self.senses.as_bytes()
        return crc_of_state(self.model, self.data, under_way + more, self._numbers_crc)
