"""One example of every message, with every optional field filled in; the golden files are made of these."""

from collections.abc import Mapping

from msgspec.structs import replace

from legpush.bus.channels import Message
from legpush.geometry import Pose2
from legpush.messages.common import PROTOCOL_VERSION, Header, Role
from legpush.messages.measures import TORQUE_BINS, Measures, UnexpectedContact
from legpush.messages.planning import (
    BoxPathQuery,
    Plan,
    PlanCancel,
    PlanRequest,
    PlanResult,
    PushSide,
    Tree,
    TrunkPathQuery,
)
from legpush.messages.stepping import (
    Action,
    Alter,
    Appearance,
    BoxState,
    Follow,
    Imu,
    Motion,
    Observation,
    Outcome,
    PathProgress,
    Perceived,
    Push,
    PushReport,
    Refusal,
    Reset,
    Trace,
    TrunkState,
    Walk,
    WorldState,
)
from legpush.messages.telemetry import Copies, Copy, Fact, Origin, Published, Reward, RewardTerm, Status, Taken
from legpush.realism.reality import drawn_reality
from legpush.realism.settings import FloorTiles, FootForceSensors, Gusts, ImuSensor, JointEncoders, PoseSensor, Realism
from legpush.scene.footprints import Footprint
from legpush.scene.occupancy import OccupancyGrid
from legpush.scene.plan_settings import Smoothing
from legpush.scene.scenario import Box, Goal, PoseDeg, Rectangle, Room, Scenario


def header(role: Role, name: str = "main", run: str = "test", sequence: int = 7) -> Header:
    """A header as the bus makes it."""
    return Header(
        protocol=PROTOCOL_VERSION, run=run, role=role, name=name, incarnation=f"{role}-0a1b2c", sequence=sequence
    )


POSE = Pose2(x_m=1.0, y_m=2.5, yaw_rad=-0.5)
SCENARIO = Scenario(
    name="example",
    room=Room(
        size_m=(6.0, 4.0),
        obstacles=(
            Rectangle(x_min_m=2.0, x_max_m=2.5, y_min_m=0.0, y_max_m=3.0),
            Rectangle(x_min_m=3.0, x_max_m=3.1, y_min_m=2.0, y_max_m=4.0, appears_at_s=2.5),
        ),
    ),
    start=PoseDeg(x_m=1.0, y_m=1.0, yaw_deg=0.0),
    box=Box(pose=PoseDeg(x_m=4.0, y_m=2.0, yaw_deg=10.0), foot_friction=0.8, com_offset_m=(0.05, -0.1, 0.02)),
    goal=Goal(pose=PoseDeg(x_m=5.0, y_m=2.0, yaw_deg=10.0)),
)
REALISM = Realism(
    profile="real",
    joint_friction_n_m=0.5,
    payload_kg=(0.0, 5.0),
    payload_x_m=0.1,
    payload_y_m=0.0,
    payload_z_m=(0.1, 0.2),
    com_x_m=(-0.02, 0.02),
    com_y_m=0.01,
    com_z_m=-0.01,
    motor_strength=(0.9, 1.1),
    foot_friction=0.8,
    slope_deg=1.5,
    uphill_deg=(0.0, 90.0),
    command_latency_s=0.02,
    gusts=Gusts(force_n=(50.0, 100.0), duration_s=0.2, at_s=3.0, every_s=(5.0, 6.0), direction_deg=(0.0, 360.0)),
    floor=FloorTiles(height_m=0.02, size_m=0.25),
    box_pose=PoseSensor(noise_m=0.01, noise_deg=1.0, rate_hz=10.0, latency_s=0.05, dropouts=0.02),
    localization=PoseSensor(noise_m=0.02, noise_deg=1.0, rate_hz=2.0, latency_s=0.0, dropouts=(0.0, 0.1)),
    imu=ImuSensor(
        gyro_noise_rad_s=0.0035,
        gyro_bias_rad_s=(0.0, 0.002),
        accelerometer_noise_m_s2=0.06,
        accelerometer_bias_m_s2=0.05,
    ),
    encoders=JointEncoders(noise_rad=0.0005),
    foot_forces=FootForceSensors(noise_n=4.0, bias_n=(0.0, 5.0)),
    sensor_latency_s=0.02,
)
RESET = Reset(scenario=SCENARIO, seed=3)
QUERY = TrunkPathQuery(
    grid=OccupancyGrid(n_columns=3, n_rows=2, resolution_m=0.5, origin_m=(0.0, -1.0), cells=bytes([0, 1, 0, 0, 0, 1])),
    start=POSE,
    goal=Pose2(x_m=0.1, y_m=0.2, yaw_rad=3.0),
    clearance_m=0.45,
    planner="rrt",
    seed=4294967295,
    max_iterations=1000,
    goal_bias=0.05,
    step_m=0.5,
    goal_region_m=0.25,
    steering="straight",
    min_turning_radius_m=0.0,
    smoothing=Smoothing(),
    anytime=None,
)
BOX_QUERY = BoxPathQuery(
    grid=QUERY.grid,
    start=POSE,
    goal=QUERY.goal,
    sides=(
        PushSide(
            frame=Pose2(x_m=0.0, y_m=-0.15, yaw_rad=1.5),
            min_turning_radius_m=0.7,
            footprints=(Footprint(pose=POSE, length_m=0.4, width_m=0.5),),
            stand_off=POSE,
        ),
    ),
    present_side=0,
    box=Footprint(pose=POSE, length_m=0.4, width_m=0.5),
    walk_clearance_m=0.45,
    side_change_m=0.5,
    clearance_m=0.05,
    run_in_m=0.4,
    position_tolerance_m=0.01,
    angle_tolerance_rad=0.02,
    seed=3,
    max_iterations=1000,
    goal_bias=0.1,
    step_m=1.0,
)
PLAN = Plan(
    status="exact",
    reason="",
    waypoints=(POSE, Pose2(x_m=0.1, y_m=0.2, yaw_rad=3.0)),
    sides=(0, 0),
    raw_path_m=((1.0, 2.5), (0.1, 0.2)),
    tree=Tree(points_m=((1.0, 2.5), (0.1, 0.2)), parents=(0, 0)),
    length_m=2.47,
    min_clearance_m=0.5,
    n_iterations=12,
)
TIPS = ((0.3, 0.17, 0.02), (0.3, -0.17, 0.02), (-0.3, 0.17, 0.02), (-0.3, -0.17, 0.02))
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
WORLD = WorldState(
    tick=215,
    trunk=TrunkState(
        position_m=(0.1, 0.2, 0.48),
        orientation_wxyz=UPRIGHT,
        linear_velocity_m_s=(0.01, 0.0, -0.001),
        angular_velocity_rad_s=(0.0, 1e-300, -0.0),
    ),
    joint_positions_rad=tuple(0.1 * i for i in range(12)),
    joint_velocities_rad_s=tuple(-0.01 * i for i in range(12)),
    tips_m=TIPS,
    foot_forces_n=(78.1, 78.2, 77.9, 78.0),
    imu=Imu(
        orientation_wxyz=UPRIGHT, angular_velocity_rad_s=(0.0, 0.0, 0.01), linear_acceleration_m_s2=(0.0, 0.0, 9.81)
    ),
    box=BoxState(position_m=(4.0, 2.0, 0.2), orientation_wxyz=UPRIGHT),
    n_footsteps=48,
    fallen=False,
    path=PathProgress(travelled_m=1.25, length_m=2.47, done=False),
    push=PushReport(leg="FR", touched=True, peak_force_n=12.5),
    appeared=(Appearance(obstacle=1, tick=130),),
)
PERCEIVED = Perceived(
    trunk=Pose2(x_m=0.12, y_m=0.19, yaw_rad=0.01),
    trunk_tick=200,
    box=BoxState(position_m=(4.01, 1.99, 0.2), orientation_wxyz=UPRIGHT),
    box_tick=210,
)
TRACE = Trace(
    tick=(214, 215),
    qpos=((0.1,) * 26, (0.2,) * 26),
    roll_pitch_rad=((0.0, 0.01), (0.0, 0.02)),
    tips_m=(TIPS, TIPS),
    contact_forces_n=(
        ((0.3, 0.1, 78.1), (0.2, 0.0, 78.2), (0.0, 0.1, 77.9), (0.0, 0.0, 78.0)),
        ((0.3, 0.1, 78.1), (0.2, 0.0, 78.2), (0.0, 0.0, 0.0), (0.0, 0.0, 78.0)),
    ),
    com_m=((0.1, 0.2, 0.48), (0.1, 0.2, 0.48)),
    zmp_m=((0.1, 0.2), (0.1, 0.2)),
    support_margin_m=(0.14, 0.05),
    zmp_margin_m=(0.13, 0.06),
    capture_margin_m=(0.12, 0.07),
    foot_moment_n_m=((0.1, -0.2, 0.0), (0.3, 0.4, -0.1)),
    joint_velocities_rad_s=((0.5,) * 12, (-0.5,) * 12),
    joint_torques_n_m=((1.5,) * 12, (-25.0,) * 12),
    trunk_velocity_m_s=((0.2, 0.0, 0.01), (0.21, -0.01, 0.0)),
    imu_angular_velocity_rad_s=((0.0, 0.1, 0.0), (0.01, 0.0, -0.1)),
    imu_acceleration_m_s2=((0.0, 0.0, 9.81), (0.1, 0.2, 9.7)),
)
NO_TORQUES = (0,) * (TORQUE_BINS - 1)
MEASURES = Measures(
    n_steps=20,
    n_footsteps=4,
    max_torques_n_m=(10.0, 20.0, 30.0) * 4,
    max_speeds_rad_s=(1.0, 2.0, 3.0) * 4,
    max_powers_w=(5.0, 20.0, 60.0) * 4,
    n_at_torque_limit=(0, 1, 2) * 4,
    least_to_limits_rad=(0.6, 0.5, -0.01) * 4,
    torque_counts=(
        (80, *(0,) * (TORQUE_BINS - 1)),
        (*(0,) * (TORQUE_BINS - 1), 80),
        (40, 40, *(0,) * (TORQUE_BINS - 2)),
    ),
    positive_work_j=12.5,
    min_support_margin_m=-0.02,
    n_outside_support=3,
    min_zmp_margin_m=0.01,
    min_capture_margin_m=0.005,
    max_push_moment_n_m=2.5,
    n_touchdowns=5,
    n_loadings=4,
    landing_speeds_m_s=(0.09, 0.11, 0.1, 0.08),
    max_penetration_m=0.0008,
    n_unexpected_steps=2,
    unexpected=(UnexpectedContact(first="FL_lower", second="wall_0", n_steps=2, max_force_n=7.5),),
)


def _action(motion: Motion, step: int) -> Action:
    return Action(header=header("agent"), episode=1700000000000, step=step, motion=motion, with_trace=step > 0)


MESSAGES: Mapping[str, Message] = {
    "plan_request": PlanRequest(header=header("agent"), request_id=2, query=QUERY),
    "plan_request_box": PlanRequest(header=header("agent"), request_id=3, query=BOX_QUERY),
    "plan_cancel": PlanCancel(header=header("agent"), request_id=3),
    "plan_result": PlanResult(
        header=header("planner"), client_incarnation="agent-0a1b2c", request_id=2, revision=0, final=True, plan=PLAN
    ),
    "action_reset": _action(RESET, 0),
    "action_follow": _action(Follow(waypoints=PLAN.waypoints), 1),
    "action_walk": _action(Walk(), 2),
    "action_push": _action(Push(w1=0.25, w2=0.75, leg="FL", depth_m=0.12, face="left"), 3),
    "action_alter": _action(Alter(box_mass_kg=0.9, box_friction=0.3, box_foot_friction=0.6), 4),
    "observation": Observation(
        header=header("sim"),
        agent_incarnation="agent-0a1b2c",
        episode=1700000000000,
        step=3,
        outcome=Outcome(
            world=replace(WORLD, perceived=PERCEIVED),
            state_crc=0xDEADBEEF,
            trace=TRACE,
            measures=MEASURES,
            reality=drawn_reality(REALISM, 3),
        ),
    ),
    "refusal": Refusal(
        header=header("sim"),
        agent_incarnation="agent-0a1b2c",
        episode=1700000000000,
        step=9,
        cause="out_of_step",
        reason="got step 9 of episode 1700000000000; next is step 4 of episode 1700000000000",
        next_episode=1700000000000,
        next_step=4,
    ),
    "status": Status(
        header=header("agent"), phase="walking", fraction=0.5, detail="cycle 8 of 16", waiting_for="sim main"
    ),
    "copies": Copies(
        header=header("sim"),
        origin=Origin(role="sim", name="main", incarnation="sim-0a1b2c"),
        batch=4,
        copies=(
            Copy(key="legpush/v5/test/sim/main/observation", sequence=9, time_ns=1700000000000000000, payload=b"0"),
        ),
        published=(Published(key="legpush/v5/test/sim/main/observation", n=10, since=9),),
        facts=(Fact(name="model.xml", media_type="application/xml", data=b"<mujoco/>"),),
        final=True,
    ),
    "reward": Reward(
        header=header("agent"),
        sim="main",
        episode=3,
        step=7,
        value=0.68,
        terms=(RewardTerm(name="position", value=0.7), RewardTerm(name="cycle", value=-0.02)),
    ),
    "taken": Taken(header=header("recorder"), origin_incarnation="sim-0a1b2c", batch=4),
}
