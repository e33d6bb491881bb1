"""What agent and simulator say: motions, and what they lead to."""

from typing import Annotated, Literal

from msgspec import Meta, Struct

from legpush.fields import Name, Seed
from legpush.geometry import Point2, Point3, Pose2, Quaternion
from legpush.messages.common import MAX_DEPTH_M, MAX_WAYPOINTS, Count, Header, Unit
from legpush.scene.robot import FrontLeg
from legpush.scene.scenario import Face, Scenario


class Reset(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="reset"):
    """Build the world of a scenario, with the offsets that the seed draws, and stand the robot at its start."""

    scenario: Scenario
    seed: Seed


class Follow(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="follow"):
    """Take this path for the coming `Walk` actions; nothing moves yet."""

    waypoints: Annotated[tuple[Pose2, ...], Meta(min_length=1, max_length=MAX_WAYPOINTS)]


class Walk(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="walk"):
    """One gait cycle along the path: each foot one step."""


class Push(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="push"):
    """One push cycle: a front foot along a Bezier curve into the box and back, then all feet to their markers."""

    w1: Unit
    w2: Unit
    """Places of the inner control points on their locus (Eq. 14)."""
    leg: FrontLeg
    depth_m: Annotated[float, Meta(ge=0.0, le=MAX_DEPTH_M)]
    """How far beyond the face of the box the curve ends (the paper's entry value)."""
    face: Face = "rear"
    """Which face of the box is pushed; the robot has to stand behind it."""
    locus: Literal["swing", "published"] = "swing"
    """Which half circle `w` runs along: the swing side, theta in [-pi/2, pi/2], or the paper's, [0, pi]."""


class Alter(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="alter"):
    """From here on the box is heavier, lighter or slides otherwise; nothing moves."""

    box_mass_kg: Annotated[float, Meta(ge=0.001)] | None = None
    """None: as it was."""
    box_friction: Annotated[float, Meta(gt=0.0)] | None = None
    """None: as it was."""


Motion = Reset | Follow | Walk | Push | Alter


class Action(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One step of an episode. Step 0 is its `Reset`; steps follow without gaps."""

    header: Header
    episode: Count
    step: Count
    motion: Motion
    with_trace: bool = False
    """Return the `Trace` of every tick as well."""


class TrunkState(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Pose and velocity of the trunk, world frame."""

    position_m: Point3
    orientation_wxyz: Quaternion
    linear_velocity_m_s: Point3
    angular_velocity_rad_s: Point3


class Imu(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What the inertial measurement unit in the trunk reads, trunk frame but the orientation."""

    orientation_wxyz: Quaternion
    angular_velocity_rad_s: Point3
    linear_acceleration_m_s2: Point3


class BoxState(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Pose of the box's centre, world frame."""

    position_m: Point3
    orientation_wxyz: Quaternion


class PathProgress(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How far along the path of the last `Follow` the footsteps are."""

    travelled_m: float
    length_m: float
    done: bool


class PushReport(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What the last `Push` did."""

    leg: FrontLeg
    touched: bool
    """Whether the pushing foot met the box."""
    peak_force_n: float
    """Largest contact force between foot and box, of those at the end of each tick."""


class Appearance(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """That an obstacle with `appears_at_s` stands in the room."""

    obstacle: Count
    """Its place in `room.obstacles`, from 0."""
    tick: Count
    """The one at whose end it appeared."""


class WorldState(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The state of the world at the end of a step."""

    tick: Count
    """Control periods of 0.02 s since the reset."""
    trunk: TrunkState
    joint_positions_rad: Annotated[tuple[float, ...], Meta(min_length=12, max_length=12)]
    """FL, FR, RL, RR; hip-x, hip-y, knee each."""
    joint_velocities_rad_s: Annotated[tuple[float, ...], Meta(min_length=12, max_length=12)]
    tips_m: tuple[Point3, Point3, Point3, Point3]
    """Centres of the foot spheres: FL, FR, RL, RR."""
    foot_forces_n: tuple[float, float, float, float]
    """Magnitudes of the contact forces that the foot sensors read, of floor and box together."""
    imu: Imu
    box: BoxState
    n_footsteps: Count
    fallen: bool
    path: PathProgress | None
    push: PushReport | None
    appeared: tuple[Appearance, ...]
    """What has appeared since the reset, in that order; it stays."""


class Trace(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What was recorded at every tick of the step: one row per tick in each field."""

    tick: tuple[Count, ...]
    qpos: tuple[tuple[float, ...], ...]
    """MuJoCo's generalized positions: trunk free joint (7), legs (12), box free joint (7)."""
    roll_pitch_rad: tuple[Point2, ...]
    tips_m: tuple[tuple[Point3, Point3, Point3, Point3], ...]
    contact_forces_n: tuple[tuple[Point3, Point3, Point3, Point3], ...]
    """Of floor and box together on each foot, world frame."""
    com_m: tuple[Point3, ...]
    zmp_m: tuple[Point2, ...]
    """Zero-moment point on the floor: the centre of pressure of the feet; below the CoM where no foot carries load."""
    support_margin_m: tuple[float, ...]
    """Signed distance from the CoM's ground projection to the border of the support polygon, inside positive."""


class Outcome(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a motion led to."""

    world: WorldState
    state_crc: Annotated[int, Meta(ge=0, lt=2**32)]
    """CRC-32 of MuJoCo's integration state: equal CRCs, equal physics, bit for bit."""
    trace: Trace | None = None


class Observation(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="observation"):
    """The answer to the action of this episode and step."""

    header: Header
    agent_incarnation: Name
    episode: Count
    step: Count
    outcome: Outcome


class Refusal(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="refusal"):
    """The action of this episode and step was not carried out."""

    header: Header
    agent_incarnation: Name
    episode: Count
    step: Count
    cause: Literal["out_of_step", "conflict", "invalid"]
    """`out_of_step`: not the step that comes next, see `next_*`. `conflict`: another action was carried out as this
    step. `invalid`: the action cannot be carried out in this state."""
    reason: str
    next_episode: Count
    next_step: Count
    """The step that this simulator can do next; (0, 0) of a fresh one."""


Answer = Observation | Refusal
