"""Messages between agent and simulator: motions and their outcomes."""

from typing import Annotated, Literal

from msgspec import Meta, Struct

from legpush.bounds import MAX_APPEARING, MAX_WAYPOINTS, BoxMass, Count, Crc, Depth, Friction, PathLength, Reading, Unit
from legpush.fields import Name, Seed
from legpush.geometry import Point3, Pose2, Quaternion
from legpush.messages.common import Header
from legpush.messages.measures import Measures
from legpush.realism.reality import Reality
from legpush.scene.conventions import FrontLeg
from legpush.scene.names import Face
from legpush.scene.scenario import Scenario


class Reset(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="reset"):
    """Builds the world of a scenario and puts the robot at its start; the seed draws the offsets of robot and box."""

    scenario: Scenario
    seed: Seed


class Follow(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="follow"):
    """Sets the path for the `Walk` actions that follow; nothing moves."""

    waypoints: Annotated[tuple[Pose2, ...], Meta(min_length=1, max_length=MAX_WAYPOINTS)]


class Walk(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="walk"):
    """One gait cycle along the path: each foot makes one step."""


class Push(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="push"):
    """One push cycle: a front foot moves along a Bezier curve into the box and back; then all feet step to markers."""

    w1: Unit
    """Place of the first inner control point on its locus (Eq. 15)."""
    w2: Unit
    """Place of the second inner control point on its locus."""
    leg: FrontLeg
    depth_m: Depth
    """Distance beyond the face of the box at which the curve ends (the paper's entry value)."""
    face: Face = "rear"
    """The face that is pushed; the robot has to stand behind it."""
    locus: Literal["swing", "published"] = "swing"
    """The half circle of `w1` and `w2`: `swing` is the side of the swing, theta in [-pi/2, pi/2], `published` the
    paper's, theta in [0, pi]."""


class Alter(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="alter"):
    """Changes mass or friction of the box from here on; nothing moves."""

    box_mass_kg: BoxMass | None = None
    """The new mass; nil keeps it."""
    box_friction: Friction | None = None
    """The new friction coefficient with the floor; nil keeps it. It also holds with the robot, unless the scenario or
    `box_foot_friction` states that one."""
    box_foot_friction: Friction | None = None
    """The new friction coefficient with the feet and all other parts of the robot; nil keeps it."""


Motion = Reset | Follow | Walk | Push | Alter


class Action(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One step of an episode. Step 0 is its `Reset`; the numbers of the steps have no gaps."""

    header: Header
    episode: Count
    step: Count
    motion: Motion
    with_trace: bool = False
    """Whether the outcome has a `Trace`, with a row for every tick."""


class TrunkState(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Pose and velocity of the trunk, world frame."""

    position_m: Point3
    orientation_wxyz: Quaternion
    linear_velocity_m_s: Point3
    angular_velocity_rad_s: Point3


class Imu(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Readings of the inertial measurement unit in the trunk. The orientation is that of the trunk in the world; the
    other values are in the trunk frame."""

    orientation_wxyz: Quaternion
    angular_velocity_rad_s: Point3
    linear_acceleration_m_s2: Point3


class BoxState(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Pose of the box's centre, world frame."""

    position_m: Point3
    orientation_wxyz: Quaternion


class Perceived(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is known of robot and box, see `realism` in a scenario. The other poses of a `WorldState` are the true ones,
    by which success is judged."""

    trunk: Pose2
    """Where the trunk is, on the floor, as the robot is located in the world."""
    trunk_tick: Count
    """When it was located; since then it has measured its own motion."""
    box: BoxState
    """The pose of the box as it was measured last. Height and tilt are exact."""
    box_tick: Count
    """When it was measured."""


class PathProgress(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How far the footsteps have come along the path of the last `Follow`."""

    travelled_m: PathLength
    length_m: PathLength
    done: bool


class PushReport(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Contact of the last `Push`."""

    leg: FrontLeg
    touched: bool
    """Whether the pushing foot touched the box."""
    peak_force_n: Reading
    """Largest contact force between foot and box at the end of any tick."""


class Appearance(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An obstacle with `appears_at_s` that has appeared in the room."""

    obstacle: Count
    """Index of the obstacle in `room.obstacles`."""
    tick: Count
    """The tick at the end of which it appeared."""


class WorldState(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The state of the world at the end of a step."""

    tick: Count
    """Control periods of 0.02 s since the reset."""
    trunk: TrunkState
    joint_positions_rad: Annotated[tuple[Reading, ...], Meta(min_length=12, max_length=12)]
    """Legs in the order FL, FR, RL, RR; of each leg hip-x, hip-y, knee."""
    joint_velocities_rad_s: Annotated[tuple[Reading, ...], Meta(min_length=12, max_length=12)]
    """In the same order."""
    tips_m: tuple[Point3, Point3, Point3, Point3]
    """Centres of the foot spheres of FL, FR, RL, RR."""
    foot_forces_n: tuple[Reading, Reading, Reading, Reading]
    """Magnitude of the contact force on each foot, from floor and box together."""
    imu: Imu
    box: BoxState
    n_footsteps: Count
    """Steps of single feet since the reset."""
    fallen: bool
    """Whether the robot has fallen; then only a `Reset` is possible."""
    path: PathProgress | None
    """Nil before a `Follow`, and after a `Push`."""
    push: PushReport | None
    """Nil before the first `Push`."""
    appeared: Annotated[tuple[Appearance, ...], Meta(max_length=MAX_APPEARING)]
    """Obstacles that have appeared since the reset, in that order; they stay."""
    perceived: Perceived | None = None
    """Nil if robot and box are known as they are."""


class Trace(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Measurements at every tick of a step: each field has one row per tick. Positions in `qpos`, and the angles of the
    trunk, are those at the end of the tick; other quantities are those at the beginning of its last physics step, 2 ms
    before."""

    tick: tuple[Count, ...]
    qpos: tuple[tuple[Reading, ...], ...]
    """Generalized positions as in MuJoCo: free joint of the trunk (7), legs (12), free joint of the box (7)."""
    roll_pitch_rad: tuple[tuple[Reading, Reading], ...]
    tips_m: tuple[tuple[Point3, Point3, Point3, Point3], ...]
    contact_forces_n: tuple[tuple[Point3, Point3, Point3, Point3], ...]
    """Contact force on each foot, from floor and box together, world frame."""
    com_m: tuple[Point3, ...]
    """Centre of mass of the robot."""
    zmp_m: tuple[tuple[Reading, Reading], ...]
    """Zero-moment point on the floor: the centre of pressure of the feet, or the point below the CoM if no foot carries
    load."""
    support_margin_m: tuple[Reading, ...]
    """Distance from the CoM's projection on the floor to the border of the support polygon, positive inside: the least
    one in the physics steps of the tick, with the loaded feet as `Measures` defines them. Before protocol 8: that of
    the last step, with all feet that carried at least 1 N."""
    zmp_margin_m: tuple[Reading, ...] = ()
    """The same distance for the zero-moment point. This and the fields below are empty before protocol 8."""
    capture_margin_m: tuple[Reading, ...] = ()
    """The same distance for the capture point."""
    foot_moment_n_m: tuple[Point3, ...] = ()
    """Moment of all forces on the feet, from floor and box, about the CoM, world frame: the sum of Eq. 9."""
    joint_velocities_rad_s: tuple[tuple[Reading, ...], ...] = ()
    """Speeds of the twelve joints, in the order of `qpos`."""
    joint_torques_n_m: tuple[tuple[Reading, ...], ...] = ()
    """Torques of the twelve servos."""
    trunk_velocity_m_s: tuple[Point3, ...] = ()
    """Velocity of the middle of the trunk, world frame."""
    imu_angular_velocity_rad_s: tuple[Point3, ...] = ()
    """What the gyroscope reads without noise, frame of the trunk."""
    imu_acceleration_m_s2: tuple[Point3, ...] = ()
    """What the accelerometer reads without noise, frame of the trunk: at rest, it points up with 9.81 m/s²."""


class Outcome(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Result of a motion."""

    world: WorldState
    state_crc: Crc
    """CRC-32 of the robot's numbers and the simulator's whole state: equal CRCs mean equal states of equal robots, bit
    for bit."""
    trace: Trace | None = None
    measures: Measures | None = None
    """Nil if nothing moved, and before protocol 8."""
    reality: Reality | None = None
    """What the seed drew from `realism`. Nil if all is as assumed and known, and for motions other than a reset."""


class Observation(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="observation"):
    """The answer to the action of this episode and step."""

    header: Header
    agent_incarnation: Name
    episode: Count
    step: Count
    outcome: Outcome


class Refusal(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="refusal"):
    """Says that the action of this episode and step was not carried out."""

    header: Header
    agent_incarnation: Name
    episode: Count
    step: Count
    cause: Literal["out_of_step", "conflict", "invalid"]
    """`out_of_step`: the step is not the next one; `next_episode` and `next_step` say which is. `conflict`: another
    action was carried out as this step, or the simulator works for another agent that is alive. `invalid`: the action
    cannot be carried out in the present state, or the simulator failed in this episode."""
    reason: str
    next_episode: Count
    next_step: Count
    """With `next_episode`, the step that this simulator expects next; (0, 0) for a fresh simulator."""


Answer = Observation | Refusal
