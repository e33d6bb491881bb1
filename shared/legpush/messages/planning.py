"""What agent and planner say: queries, and plans."""

from typing import Annotated, Literal

from msgspec import Meta, Struct

from legpush.fields import Name, Seed
from legpush.geometry import Point2, Pose2
from legpush.messages.common import MAX_WAYPOINTS, Count, Header, Unit
from legpush.scene.footprints import Footprint
from legpush.scene.occupancy import OccupancyGrid
from legpush.scene.scenario import Anytime, PlannerName, Smoothing, Steering


class TrunkPathQuery(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="trunk_path"):
    """Ask for a path of the trunk that keeps `clearance_m` from every occupied cell."""

    grid: OccupancyGrid
    start: Pose2
    goal: Pose2
    clearance_m: Annotated[float, Meta(gt=0.0)]
    """Least distance from the trunk centre to anything occupied: the footprint's radius plus the margin."""
    planner: PlannerName
    seed: Seed
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
    seed: Seed
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
