"""Messages between agent and planner: requests, cancellations and plans."""

from typing import Annotated, Literal

from msgspec import Meta, Struct

from legpush.bounds import (
    MAX_WAYPOINTS,
    Count,
    Iterations,
    PathLength,
    QueryDistance,
    QueryLength,
    Reading,
    TurnRad,
    Unit,
)
from legpush.fields import Name, Seed
from legpush.geometry import Point2, Pose2
from legpush.messages.common import Header
from legpush.scene.footprints import Footprint
from legpush.scene.names import PlannerName, Steering
from legpush.scene.occupancy import OccupancyGrid
from legpush.scene.plan_settings import Anytime, Smoothing


class TrunkPathQuery(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="trunk_path"):
    """Asks for a path of the trunk that keeps `clearance_m` from every occupied cell."""

    grid: OccupancyGrid
    start: Pose2
    goal: Pose2
    clearance_m: QueryLength
    """Least distance from the trunk centre to any occupied cell: the footprint's radius plus the margin."""
    planner: PlannerName
    seed: Seed
    max_iterations: Iterations
    """Budget of the search. Seed and iterations make the answer reproducible; a budget in seconds would not."""
    goal_bias: Unit
    """Probability that a sample is the goal."""
    step_m: QueryLength
    """Longest edge of the tree; `bit_star` and `prm_star` connect near neighbours instead."""
    goal_region_m: QueryLength
    """Radius of the goal region of Algorithm 1."""
    steering: Steering
    """How the path moves. `straight`: lines and turns on the spot. `dubins`, `reeds_shepp`: arcs and lines from the
    heading at the start to the heading at the goal; `dubins` drives forward only, `reeds_shepp` backward too."""
    min_turning_radius_m: QueryDistance
    """Least turning radius while the trunk moves forward or backward; 0 allows any."""
    smoothing: Smoothing
    """How a `straight` path is smoothed; `max_waypoints` holds for every steering."""
    anytime: Anytime | None
    """With it, the planner answers with the first path that it finds, and then with better ones; nil asks for one
    plan."""
    body: Footprint | None = None
    """The floor that the robot covers, in the frame of the trunk. It keeps `body_clearance_m` from every occupied cell,
    turns on the spot included. With nil, headings do not count."""
    body_clearance_m: QueryDistance = 0.0
    """Least distance from the body to any occupied cell."""


class PushSide(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A side of the box that can be pushed, and the space that a push there needs.

    The x axis of its pushed frame points in the direction of the push. Its origin is the point of the box that does not
    slip sideways when the box turns, like the middle of a car's rear axle.
    """

    frame: Pose2
    """The pushed frame, in the frame of the box."""
    min_turning_radius_m: QueryLength
    footprints: Annotated[tuple[Footprint, ...], Meta(min_length=1, max_length=16)]
    """Rectangles that cover the box and the robot behind it, in the pushed frame."""
    stand_off: Pose2
    """Pose of the trunk, in the pushed frame, at which its way to this side ends. Its way to another side begins there
    or farther back."""


class BoxPathQuery(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind", tag="box_path"):
    """Asks for a path of the box with the robot behind it.

    The box moves forward only and turns with a least radius (Dubins). The robot may push one side after another, if
    that is shorter or the only way.
    """

    grid: OccupancyGrid
    """The room without the box and the robot."""
    start: Pose2
    """Pose of the box."""
    goal: Pose2
    """Pose of the box."""
    sides: Annotated[tuple[PushSide, ...], Meta(min_length=1, max_length=8)]
    present_side: Count | None
    """The side that the robot stands at; nil if it stands elsewhere."""
    box: Footprint
    """The rectangle of the box that the robot walks around, in the frame of the box."""
    walk_clearance_m: QueryLength
    """Least distance from the trunk centre to any occupied cell and to the box while the robot walks around it."""
    body: Footprint | None = None
    """The floor that the robot covers, in the frame of the trunk. At a stand-off, it keeps `body_clearance_m` from
    every occupied cell. With nil, only its clearance as a disc counts there."""
    body_clearance_m: QueryDistance = 0.0
    """Least distance from the body to any occupied cell at a stand-off, and on a walk to another side."""
    side_change_m: QueryDistance
    """Cost of a change of sides, as a length of path of the box."""
    clearance_m: QueryDistance
    """Least distance from any footprint to any occupied cell."""
    run_in_m: QueryDistance
    """Length over which the path should be straight before the goal, if there is room for it."""
    position_tolerance_m: QueryDistance
    """How far from the goal position the path may end, if that saves a detour."""
    angle_tolerance_rad: TurnRad
    """The same for the heading."""
    seed: Seed
    max_iterations: Iterations
    """Budget of the search, as for the trunk."""
    goal_bias: Unit
    """Probability that a sample is the goal."""
    step_m: QueryLength
    """Longest edge of the tree."""


PlanQuery = TrunkPathQuery | BoxPathQuery


class PlanRequest(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A query with its id. A request with the id of an earlier one of the same client incarnation is that request, sent
    again."""

    header: Header
    request_id: Count
    query: PlanQuery


class PlanCancel(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Asks the planner to stop working on a request of this client."""

    header: Header
    request_id: Count


PlanStatus = Literal["exact", "approximate", "failed", "invalid", "cancelled"]


class Tree(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The search tree, for plots. `parents[i]` is the parent of node i; a root is its own parent."""

    points_m: Annotated[tuple[Point2, ...], Meta(max_length=MAX_WAYPOINTS)]
    parents: Annotated[tuple[Count, ...], Meta(max_length=MAX_WAYPOINTS)]


class Plan(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A planner's answer to a query."""

    status: PlanStatus
    """`exact`: free of collisions from start to goal. `approximate`: free of collisions, but ends short of the goal.
    `failed`: nothing was found within the budget. `invalid`: no planner could answer this query, or this one does not
    support it. `cancelled`: the client cancelled the request before there was a plan."""
    reason: str
    """Why the plan has this status, in words; may be empty for `exact`."""
    waypoints: Annotated[tuple[Pose2, ...], Meta(max_length=MAX_WAYPOINTS)] = ()
    """The path as dense poses. A path of the trunk is smoothed and heads along itself; the trunk turns on the spot
    where consecutive positions coincide. A path of the box has the poses of the box."""
    sides: Annotated[tuple[Count, ...], Meta(max_length=MAX_WAYPOINTS)] = ()
    """For each waypoint of a path of the box, the index of the side that is pushed on the way to it. The first entry is
    the side that is pushed first."""
    raw_path_m: Annotated[tuple[Point2, ...], Meta(max_length=MAX_WAYPOINTS)] = ()
    """The path of the search, before it was smoothed."""
    tree: Tree | None = None
    length_m: PathLength = 0.0
    min_clearance_m: Reading = 0.0
    """Least distance from the smoothed path to any occupied cell, measured on the exact squares of the grid."""
    n_iterations: Count = 0


class PlanResult(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The planner's answer to the request of `client_incarnation` with this `request_id`."""

    header: Header
    client_incarnation: Name
    request_id: Count
    revision: Count
    """0 for the first answer, k for the k-th better plan of a query with `anytime`."""
    final: bool
    """Whether this is the last revision."""
    plan: Plan
