"""The physics at the bounds of scenarios and motions: whatever is within them ends no simulator.

`LEGPUSH_EXAMPLES=400 python -m pytest tests/sim/test_extreme_scenarios.py` draws more of them than a usual test run.
"""

import os
import warnings
from itertools import chain
from math import degrees, exp, log

from hypothesis import HealthCheck, given, reject, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from legpush import bounds
from legpush.errors import MotionError
from legpush.geometry import Pose2, wrap_angle
from legpush.messages import codec
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Alter, Follow, Motion, Outcome, Push, Reset, Walk
from legpush.realism.settings import Randomization
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.faces import PUSHABLE, pushed_box, pushed_pose
from legpush.scene.footprints import behind_box
from legpush.scene.names import Face
from legpush.scene.scenario import Box, Goal, PoseDeg, Rectangle, Room, Scenario
from legpush.scene.solid import steps_to_surface
from sim_proc.simulator import Simulator
from tests.robots import ROBOT

N_EXAMPLES = int(os.environ.get("LEGPUSH_EXAMPLES", "20"))


def between(low: float, high: float) -> st.SearchStrategy[float]:
    """Either end as often as something between, every order of magnitude as likely."""
    within = st.floats(log(low), log(high)).map(lambda power: min(max(exp(power), low), high))
    return st.one_of(st.just(low), st.just(high), within)


masses = between(bounds.LEAST_BOX_MASS_KG, bounds.MAX_BOX_MASS_KG)
frictions = between(bounds.LEAST_FRICTION, bounds.MAX_FRICTION)
sides = between(bounds.LEAST_BOX_SIDE_M, bounds.MAX_BOX_SIDE_M)
lengths = between(bounds.LEAST_LENGTH_M, bounds.MAX_LENGTH_M)
coordinates = st.sampled_from([0.0, 3.0, -bounds.MAX_COORDINATE_M + 20.0, bounds.MAX_COORDINATE_M - 20.0])
"""20 m within the bounds, so that the robot beside the box is within them, too."""
headings = st.floats(-bounds.MAX_TURN_DEG, bounds.MAX_TURN_DEG)
units = st.floats(0.0, 1.0)


@st.composite
def boxes(draw: st.DrawFn) -> Box:
    length_m, width_m, height_m = draw(sides), draw(sides), draw(sides)
    shape = draw(st.sampled_from(["cuboid", "cylinder", "wedge", "l_shape"]))
    box = Box(
        pose=PoseDeg(x_m=draw(coordinates), y_m=draw(coordinates), yaw_deg=draw(headings)),
        size_m=(length_m, length_m if shape == "cylinder" else width_m, height_m),
        shape=shape,  # type: ignore[arg-type]
        mass_kg=draw(masses),
        friction=draw(frictions),
        foot_friction=draw(st.none() | frictions),
    )
    step = draw(st.sampled_from([(0.0, 0.0, 0.0), (1.0, -1.0, 1.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1e-300)]))
    steps = 0.89 * steps_to_surface(box.shape, box.size_m, step)
    x_m, y_m, z_m = (part * min(steps, 1.0) for part in step)
    return replace(box, com_offset_m=(x_m, y_m, z_m))


@st.composite
def extents(draw: st.DrawFn, near_m: float) -> tuple[float, float]:
    """The sides of an obstacle along an axis, the first of them within 1 m of a place."""
    most_m, thinnest_m = bounds.MAX_COORDINATE_M, 2 * bounds.LEAST_THICKNESS_M
    low_m = min(max(near_m + draw(st.floats(-1.0, 1.0)), -most_m), most_m - thinnest_m)
    return low_m, min(low_m + draw(between(thinnest_m, most_m)), most_m)


@st.composite
def obstacles(draw: st.DrawFn, near: Pose2) -> tuple[Rectangle, ...]:
    """Obstacles that lie over one another at the robot and the box, some of which appear later."""
    found = []
    for _ in range(draw(st.sampled_from([0, 1, 5, bounds.MAX_OVERLAP]))):
        x_low_m, x_high_m = draw(extents(near.x_m))
        y_low_m, y_high_m = draw(extents(near.y_m))
        found.append(
            Rectangle(
                x_min_m=x_low_m,
                x_max_m=x_high_m,
                y_min_m=y_low_m,
                y_max_m=y_high_m,
                appears_at_s=draw(st.sampled_from([0.0, 0.02, bounds.MAX_TIME_S])),
            )
        )
    return tuple(found)


@st.composite
def scenarios(draw: st.DrawFn) -> tuple[Scenario, Face]:
    """Scenarios whose robot stands ready to push at a face, but for the offsets that the seed draws."""
    box = draw(boxes())
    face = draw(st.sampled_from(PUSHABLE[box.shape]))
    station = behind_box(pushed_box(box, face), pushed_pose(box.pose.pose(), face), ROBOT.station_m)
    offset_m = draw(st.sampled_from([0.0, 0.0, 0.0, 0.1, bounds.MAX_LENGTH_M]))
    turn_deg = draw(st.sampled_from([0.0, 0.0, 0.0, 3.0, bounds.MAX_TURN_DEG]))
    scenario = Scenario(
        name="extreme",
        room=Room(
            size_m=(draw(lengths), draw(lengths)),
            obstacles=draw(obstacles(draw(st.sampled_from([station, box.pose.pose()])))),
            wall_height_m=draw(lengths),
            slope_deg=draw(st.sampled_from([0.0, bounds.MAX_SLOPE_DEG])),
            uphill_deg=draw(headings),
        ),
        start=PoseDeg(x_m=station.x_m, y_m=station.y_m, yaw_deg=degrees(wrap_angle(station.yaw_rad))),
        box=box,
        goal=Goal(pose=box.pose),
        randomization=Randomization(
            start_xy_m=offset_m, start_yaw_deg=turn_deg, box_xy_m=offset_m, box_yaw_deg=turn_deg
        ),
    )
    return scenario, face


pushes = st.builds(
    Push,
    w1=units,
    w2=units,
    leg=st.sampled_from(FRONT_LEGS),
    depth_m=st.one_of(st.just(bounds.MAX_DEPTH_M), st.floats(0.0, bounds.MAX_DEPTH_M)),
    locus=st.sampled_from(["swing", "published"]),
)
alters = st.builds(Alter, box_mass_kg=masses, box_friction=frictions, box_foot_friction=st.none() | frictions)


@st.composite
def follows(draw: st.DrawFn) -> Follow:
    """Paths from where the robot stands, in its frame, to anywhere."""
    yaws = st.floats(-bounds.MAX_YAW_RAD, bounds.MAX_YAW_RAD)
    places = st.builds(Pose2, x_m=coordinates, y_m=coordinates, yaw_rad=yaws)
    return Follow(waypoints=(Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0), *draw(st.lists(places, max_size=3))))


def alone(motion: Motion) -> tuple[Motion, ...]:
    """The motion as a sequence of its own."""
    return (motion,)


def with_walk(follow: Follow) -> tuple[Motion, ...]:
    """A path with two gait cycles on it."""
    return (follow, Walk(), Walk())


@given(
    drawn=scenarios(),
    seed=st.integers(0, 2**32 - 1),
    motions=st.lists(st.one_of(pushes.map(alone), alters.map(alone), follows().map(with_walk)), max_size=4),
)
@settings(max_examples=N_EXAMPLES, deadline=None, database=None, suppress_health_check=list(HealthCheck))
def test_every_motion_within_the_bounds_is_carried_out_or_refused(
    drawn: tuple[Scenario, Face], seed: int, motions: list[tuple[Motion, ...]]
) -> None:
    scenario, face = drawn
    assert codec.decode(codec.encode(scenario), Scenario) == scenario
    simulator = Simulator()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            outcome = simulator.perform(Reset(scenario=scenario, seed=seed), with_trace=True)
        except MotionError:  # the robot would stand in a wall or in the box
            reject()
        for motion in (Push(w1=0.5, w2=0.5, leg="FL", depth_m=bounds.MAX_DEPTH_M, face=face), *chain(*motions)):
            assert codec.decode(codec.encode(outcome), Outcome) == outcome
            try:
                outcome = simulator.perform(placed(motion, face, outcome), with_trace=True)
            except MotionError:
                continue
        assert codec.decode(codec.encode(outcome), Outcome) == outcome


def placed(motion: Motion, face: Face, outcome: Outcome) -> Motion:
    """The same motion for where the robot is: a push at its face, and a path from its place."""
    match motion:
        case Push():
            return replace(motion, face=face)
        case Follow(waypoints=waypoints):
            trunk = planar_pose(outcome.world.trunk)
            return replace(motion, waypoints=(trunk, *waypoints[1:]))
        case _:
            return motion
