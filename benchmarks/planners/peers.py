"""The kind of cell that compares our planners with planners of other projects at the same clearance.

Ours return a smooth path with headings, theirs return corners. The time is that from the query to the path, including
the map. `pip install 'legpush[bench]'` installs the others; python_motion_planning is under the GPL.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import cache, partial
from time import perf_counter
from typing import Any, Final, Literal, get_args

from msgspec import Struct
from msgspec.structs import replace

from benchmarks.planners.compare import MEASURES
from benchmarks.planners.maps import question
from benchmarks.planners.measures import measured, points_of
from legpush.arrays import Floats
from legpush.errors import ConfigError
from legpush.fields import Seed
from legpush.messages.planning import TrunkPathQuery
from legpush.scene.names import PlannerName
from legpush.scene.plan_settings import Anytime, Smoothing
from legpush.study.cells import CellKind, Column, as_it_is
from planner_proc.planning import make_plans
from planner_proc.smoothing import polylines

Planner = Callable[[TrunkPathQuery, int], Floats | None]
Label = Literal[
    "legpush rrt_connect",
    "legpush rrt",
    "legpush rrt_star",
    "legpush rrt_connect, not smoothed",
    "python_motion_planning RRT",
    "python_motion_planning RRT*",
    "python_motion_planning RRT* until as short",
    "pathplanning rrt",
    "pathplanning rrt_connect",
]
LABELS: Final[tuple[Label, ...]] = get_args(Label)
NOT_SMOOTHED: Final = Smoothing(method="none")
"""Leaves the corners, as the others do, but shortens the path."""
UNTIL: Final = "python_motion_planning RRT* until as short"
"""Continues until its path is as short as that of our `rrt_connect` with the same seed."""
WARM_UP_SEED: Final = 1_000_000

COLUMNS: Final = (
    Column(name="seconds", unit="s", about="from the query to the path", may_differ=True),
    Column(name="found", unit="", about="whether there is a path"),
    *MEASURES,
)


class Peer(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A planner, a map and a seed."""

    seed: Seed
    map: str
    """One of `benchmarks.planners.maps`."""
    planner: Label
    compiled: bool = True
    """Whether python_motion_planning runs through Numba. Without it, NUMBA_DISABLE_JIT=1 has to be set."""


def peer(cell: Peer) -> Mapping[str, Any]:
    """Plan one request, time it, and measure the path.

    Raises:
        ConfigError: The environment compiles, or does not compile, as the cell wants.
    """
    plan, query = _planner(cell.planner, cell.compiled), question(cell.map)
    if cell.planner == UNTIL:
        _length_m(query, cell.seed)
    else:
        _warm_up(cell.planner, cell.map, cell.compiled)
    begin_s = perf_counter()
    points_m = plan(query, cell.seed)
    row: dict[str, Any] = {"seconds": perf_counter() - begin_s, "found": points_m is not None}
    if points_m is None:
        return row | dict.fromkeys(column.name for column in MEASURES)
    return row | asdict(measured(query, points_m))


@cache
def _warm_up(label: Label, name: str, compiled: bool) -> None:
    """Plan once, since the first call of a process compiles code and fills caches."""
    _planner(label, compiled)(question(name), WARM_UP_SEED)


def _planner(label: Label, compiled: bool) -> Planner:
    from benchmarks.planners import peer_planners as peers

    if compiled != peers.COMPILED:
        raise ConfigError(
            f"Expected NUMBA_DISABLE_JIT={int(not compiled)} in the environment for compiled = {compiled}"
        )
    match label.split(" ", 1):
        case "legpush", "rrt_connect, not smoothed":
            return partial(_ours, planner="rrt_connect", smoothing=NOT_SMOOTHED)
        case "legpush", "rrt" | "rrt_connect" | "rrt_star" as name:
            return partial(_ours, planner=name)
        case "python_motion_planning", "RRT":
            return partial(peers.motion_planning, star=False)
        case "python_motion_planning", "RRT*":
            return partial(peers.motion_planning, star=True)
        case "python_motion_planning", _:
            return partial(peers.motion_planning, star=True, until=_length_m)
        case _, name:
            return partial(peers.path_planning, planner=name)
    raise ConfigError(f"Expected a planner among {', '.join(LABELS)}, got {label}")


@cache
def _length_m(query: TrunkPathQuery, seed: int) -> float:
    """Return the length of the path of our `rrt_connect`, or 0 without one."""
    points_m = _ours(query, seed, planner="rrt_connect")
    return 0.0 if points_m is None else polylines.length(points_m)


def _ours(
    query: TrunkPathQuery, seed: int, *, planner: PlannerName, smoothing: Smoothing | None = None
) -> Floats | None:
    """Return the points of the first exact path of one of our planners."""
    anytime = Anytime(n_improvements=1, improvement_iterations=1) if planner == "rrt_star" else None
    asked = replace(query, planner=planner, seed=seed, anytime=anytime, smoothing=smoothing or query.smoothing)
    plan = next(make_plans(asked, lambda: False))
    return points_of(plan) if plan.status == "exact" else None


PEER: Final = CellKind(specification=Peer, run=peer, resolved=Peer, resolve=as_it_is, columns=COLUMNS)
"""The kind of cell."""
