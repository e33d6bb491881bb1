"""Every message of the protocol: one frozen record each, SI units, world frame unless a name says otherwise.

Each travels as a MessagePack map with exactly these fields. A name without a default is required, an unknown one is
refused, and every number must be finite.
"""

from typing import Annotated, Final, Literal

from msgspec import Meta, Struct

from legpush.geometry import Pose2
from legpush.robot import FrontLeg
from legpush.room_shapes import Footprint
from legpush.scenario import Anytime, Face, PlannerName, Scenario, Smoothing, Steering

PROTOCOL_VERSION: Final = 5

Role = Literal["planner", "sim", "agent", "launcher", "recorder"]
Name = Annotated[str, Meta(pattern=r"^[A-Za-z0-9_-]{1,64}$(?!\n)")]
Count = Annotated[int, Meta(ge=0)]
Unit = Annotated[float, Meta(ge=0.0, le=1.0)]
Point2 = tuple[float, float]
Point3 = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

MAX_CELLS: Final = 4096 * 4096
MAX_WAYPOINTS: Final = 100_000
MAX_DEPTH_M: Final = 0.25
"""Of a push."""


class Header(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Who says it, in which run."""

    protocol: int
    run: Name
    role: Role
    name: Name
    incarnation: Name
    """Drawn anew each time the process starts: a restarted peer is another one."""
    sequence: Count
    """Counts what this incarnation published under this key, from 0; a gap or a repeat shows loss or duplication."""


# -- plan/<client>/request, plan/<client>/cancel, plan/<client>/result -----------------------------------------------


class OccupancyGrid(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Square cells; row 0 lies at the lowest y, column 0 at the lowest x; outside is occupied."""

    n_columns: Annotated[int, Meta(ge=1, le=MAX_CELLS)]
    n_rows: Annotated[int, Meta(ge=1, le=MAX_CELLS)]
    resolution_m: Annotated[float, Meta(gt=0.0)]
    origin_m: Point2
    """World position of the lower left corner of cell (0, 0)."""
    cells: Annotated[bytes, Meta(min_length=1, max_length=MAX_CELLS)]
    """One byte per cell, row after row: 0 free, 1 occupied."""


class TrunkPathQuery(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="trunk_path"):
    """Ask for a path of the trunk that keeps `clearance_m` from every occupied cell."""

    grid: OccupancyGrid
    start: Pose2
    goal: Pose2
    clearance_m: Annotated[float, Meta(gt=0.0)]
    """Least distance from the trunk centre to anything occupied: the footprint's radius plus the margin."""
    planner: PlannerName
    seed: Annotated[int, Meta(ge=0, lt=2**32)]
    max_iterations: Annotated[int, Meta(ge=1, le=10_000_000)]
    """Budget; with the seed it makes the answer reproducible, which a wall-clock budget would not."""
    goal_bias: Unit
    step_m: Annotated[float, Meta(gt=0.0)]
    """Longest edge of the tree; `bit_star` and `prm_star` join what is near instead."""
    goal_region_m: Annotated[float, Meta(gt=0.0)]
    """Radius of the goal region of Algorithm 1."""
    steering: Steering
    """`straight`: lines, and turns on the spot. `dubins`, `reeds_shepp`: arcs and lines from the start's heading to the
    goal's, forward only or backward too."""
    min_turning_radius_m: Annotated[float, Meta(ge=0.0)]
    """Of the path where it moves; 0 for any."""
    smoothing: Smoothing
    """For `straight`; `max_waypoints` for all."""
    anytime: Anytime | None
    """With it the first path found is answered at once, and so many better ones follow."""


class PushSide(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A face of the box that can be pushed, and what that takes.

    The frame that is pushed has its x axis in the pushing direction, and its origin where the box does not slip
    sideways when it turns, as between the rear wheels of a car.
    """

    frame: Pose2
    """The frame that is pushed, in the frame of the box."""
    min_turning_radius_m: Annotated[float, Meta(gt=0.0)]
    footprints: Annotated[tuple[Footprint, ...], Meta(min_length=1, max_length=16)]
    """What moves along, box and robot, in the frame that is pushed."""
    stand_off: Pose2
    """Where the trunk's way to this side ends, in the same frame; its way to another side begins there, or behind."""


class BoxPathQuery(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="box_path"):
    """Ask for a path of the box, with the robot behind it: forward only, with a minimum turning radius (Dubins), from
    one side after another where that is shorter or the only way.
    """

    grid: OccupancyGrid
    """Without the box and the robot."""
    start: Pose2
    """Of the box, like the goal."""
    goal: Pose2
    sides: Annotated[tuple[PushSide, ...], Meta(min_length=1, max_length=8)]
    present_side: Count | None
    """Which of them the robot stands at; None where it stands elsewhere."""
    box: Footprint
    """What the robot walks around from one side to another, in the frame of the box."""
    walk_clearance_m: Annotated[float, Meta(gt=0.0)]
    """Least distance of the trunk's centre from anything occupied, the box included, where it walks."""
    side_change_m: Annotated[float, Meta(ge=0.0)]
    """How much more path of the box a change of sides is worth."""
    clearance_m: Annotated[float, Meta(ge=0.0)]
    """Least distance from any footprint to anything occupied."""
    run_in_m: Annotated[float, Meta(ge=0.0)]
    """A path should be straight for so long before the goal, where there is the space for it."""
    position_tolerance_m: Annotated[float, Meta(ge=0.0)]
    angle_tolerance_rad: Annotated[float, Meta(ge=0.0)]
    """How far from the goal pose the path may end, where that saves a way around."""
    seed: Annotated[int, Meta(ge=0, lt=2**32)]
    max_iterations: Annotated[int, Meta(ge=1, le=10_000_000)]
    """Budget of the search, as for the trunk."""
    goal_bias: Unit
    step_m: Annotated[float, Meta(gt=0.0)]
    """Longest edge of the tree."""


PlanQuery = TrunkPathQuery | BoxPathQuery


class PlanRequest(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A query, addressed: equal ids of one client incarnation are the same request, sent again."""

    header: Header
    request_id: Count
    query: PlanQuery


class PlanCancel(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Stop working on this request of mine."""

    header: Header
    request_id: Count


PlanStatus = Literal["exact", "approximate", "failed", "invalid", "cancelled"]


class Tree(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The search tree, for plots: node i hangs on node `parents[i]`, a root on itself."""

    points_m: Annotated[tuple[Point2, ...], Meta(max_length=MAX_WAYPOINTS)]
    parents: Annotated[tuple[Count, ...], Meta(max_length=MAX_WAYPOINTS)]


class Plan(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a planner found for a `PlanQuery`."""

    status: PlanStatus
    """`exact`: start to goal, collision-free. `approximate`: collision-free, ends short of the goal. `failed`: nothing
    within the budget. `invalid`: the request itself cannot be met; `reason` says why. `cancelled`: as was asked for."""
    reason: str
    waypoints: Annotated[tuple[Pose2, ...], Meta(max_length=MAX_WAYPOINTS)] = ()
    """The path, dense. Of the trunk: smoothed, heading along it; turns on the spot where consecutive positions
    coincide. Of the box: its poses."""
    sides: Annotated[tuple[Count, ...], Meta(max_length=MAX_WAYPOINTS)] = ()
    """Of a path of the box: the side from which it is pushed to each waypoint, and from the first one on."""
    raw_path_m: Annotated[tuple[Point2, ...], Meta(max_length=MAX_WAYPOINTS)] = ()
    tree: Tree | None = None
    length_m: float = 0.0
    min_clearance_m: float = 0.0
    """Least distance of the smoothed path to anything occupied, measured on the grid's exact cells."""
    n_iterations: Count = 0


class PlanResult(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The answer to the `PlanRequest` of `client_incarnation` with this `request_id`."""

    header: Header
    client_incarnation: Name
    request_id: Count
    revision: Count
    """0 of the first answer; with `anytime`, the k-th better one."""
    final: bool
    """Whether this is the last revision."""
    plan: Plan


# -- sim/<name>/action -----------------------------------------------------------------------------------------------


class Reset(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="reset"):
    """Build the world of a scenario, with the offsets that the seed draws, and stand the robot at its start."""

    scenario: Scenario
    seed: Annotated[int, Meta(ge=0, lt=2**32)]


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


# -- sim/<name>/observation ------------------------------------------------------------------------------------------


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
    foot_forces_n: tuple[tuple[float, float, float, float], ...]
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


# -- tap/<role>/<name>/status ----------------------------------------------------------------------------------------


class Status(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a process is doing, for people to watch; the protocol never depends on it."""

    header: Header
    phase: str
    fraction: Unit | None = None
    """Share of the phase that is done, where it is known."""
    detail: str = ""
    waiting_for: str = ""
    """Whom the process waits for, if it does."""


# -- tap/<role>/<name>/copies, tap/<role>/<name>/taken ---------------------------------------------------------------


class Copy(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A message that was published, byte for byte."""

    key: str
    sequence: Count
    """Of its header."""
    time_ns: Count
    """When it was published, since 1970."""
    payload: bytes


class Published(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How much was published under a key."""

    key: str
    n: Count
    """The sequence of the next message under this key."""


class Fact(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A file that a recording should have: what a process works with, or what came of it."""

    name: Annotated[str, Meta(pattern=r"^[A-Za-z0-9_.-]{1,64}$(?!\n)")]
    media_type: str
    data: bytes


class Origin(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Whose messages are copied: those of this incarnation."""

    role: Role
    name: Name
    incarnation: Name


class Copies(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Copies of what a process published, in that order, for recorders; sent again until it is `Taken`."""

    header: Header
    origin: Origin
    """The sender itself, or in a replay whom it stands for."""
    batch: Count
    """Counts the origin's batches, from 0; the next one comes when this one is taken."""
    copies: tuple[Copy, ...]
    published: tuple[Published, ...]
    """Of every key that this origin has used: what is not among the copies of any batch is lost to recorders."""
    facts: tuple[Fact, ...]
    final: bool
    """Whether the origin ends: nothing follows."""


class Taken(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A recorder has this batch."""

    header: Header
    origin_incarnation: Name
    batch: Count
