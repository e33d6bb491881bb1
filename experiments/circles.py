"""`python -m experiments.circles`: repeats one action, which pushes the box along a circle (Figs. 18 to 20).

Each circle is two turns, to the left or right, at one of several depths and frictions, with a simulator in this
process. As in the paper, q(t) = A sin(omega t + phi) + c is fitted to the steady part of a coordinate; of x and y, the
one that fits worse is reported. A row per circle goes to `results/circles.csv`, the box after each cycle to
`results/circles_series.csv.gz`, and the picture, beside the published series, to `results/circles.png`.
"""

import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import product
from math import degrees, pi
from typing import Annotated, Any, Final, Literal

import numpy as np
import tyro
from rich.progress import track
from scipy.optimize import curve_fit, least_squares

from experiments.plots.circles import draw
from experiments.evaluations import RESULTS, write_table
from legpush.arrays import Floats
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, Reset
from legpush.scene.robot import CONTROL_PERIOD_S, FrontLeg
from legpush.scene.scenario import STATION_M, Box, Goal, PoseDeg, Randomization, Room, Scenario
from sim_proc.simulator import Simulator

Direction = Literal["left", "right"]
PUSHED_BY: Final[dict[Direction, FrontLeg]] = {"left": "FR", "right": "FL"}
"""The leg for each direction: a foot right of the middle turns the box to the left."""
DEPTHS_M: Final = (0.03, 0.05, 0.08)
FRICTIONS: Final = (0.3, 0.5, 0.8)
USUAL: Final = (0.05, 0.5)
"""Depth and friction that are measured from several starts."""
SEEDS: Final = (40_000, 40_001, 40_002, 40_003, 40_004)
N_TURNS: Final = 2.0
STEADY_FROM_CYCLE: Final = 5
W: Final = 0.5
"""Both inner control points of the curve lie at the top of their locus."""
MOST_CYCLES: Final = 600
SAMPLE_TICKS: Final = 10
"""Ticks between two points of the fitted series."""
SIDE_M: Final = 8.0


@dataclass(frozen=True, kw_only=True)
class Circle:
    """One circle to measure."""

    direction: Direction
    depth_m: float
    friction: float
    seed: int


@dataclass(frozen=True, kw_only=True)
class Course:
    """The motion of the box along a circle."""

    cycles: Floats
    """Time, x, y and heading (continuous) after each push cycle and before the first, (n + 1, 4)."""
    samples: Floats
    """Time, x and y every `SAMPLE_TICKS`, (m, 3)."""
    max_abs_roll_deg: float
    max_abs_pitch_deg: float
    min_support_margin_m: float


@dataclass(frozen=True, kw_only=True)
class Config:
    """How to run the study."""

    jobs: Annotated[int, tyro.conf.arg(help="How many circles to measure at once.")] = 2


def circles() -> list[Circle]:
    """Return all circles: every depth and friction once, the usual ones from several starts."""
    cases = product(PUSHED_BY, DEPTHS_M, FRICTIONS)
    return [
        Circle(direction=direction, depth_m=depth_m, friction=friction, seed=seed)
        for direction, depth_m, friction in cases
        for seed in (SEEDS if (depth_m, friction) == USUAL else SEEDS[:1])
    ]


def main(config: Config) -> int:
    """Measure all circles, write the tables and draw."""
    planned = circles()
    with ProcessPoolExecutor(config.jobs) as pool:
        courses = list(track(pool.map(push_around, planned), total=len(planned), description="circles"))
    rows = [row(circle, course) for circle, course in zip(planned, courses, strict=True)]
    write_table(rows, RESULTS / "circles.csv")
    write_table(list(_series(planned, courses)), RESULTS / "circles_series.csv.gz")
    draw()
    for one in rows:
        print(
            f"{one['direction']:5s} depth {one['depth_m']} m friction {one['friction']}  radius {one['radius_m']:.3f} m"
            f"  {one['turn_deg_per_cycle']:.2f} deg/cycle  R2 {one['r2']:.4f}  closing {100 * one['closing_m']:.1f} cm"
        )
    return 0


def push_around(circle: Circle) -> Course:
    """Push until the box has turned `N_TURNS` times."""
    scenario = _scenario(circle.friction)
    simulator = Simulator()
    outcome = simulator.perform(Reset(scenario=scenario, seed=circle.seed), with_trace=False)
    push = Push(w1=W, w2=W, leg=PUSHED_BY[circle.direction], depth_m=circle.depth_m)
    box = planar_pose(outcome.world.box)
    start_rad = heading_rad = box.yaw_rad
    cycles = [(0.0, box.x_m, box.y_m, heading_rad)]
    samples: list[Floats] = []
    tilt_deg, margin_m = np.zeros(2), np.inf
    while abs(heading_rad - start_rad) < 2 * pi * N_TURNS:
        outcome = simulator.perform(push, with_trace=True)
        trace = outcome.trace
        if trace is None or outcome.world.fallen or len(cycles) > MOST_CYCLES:
            raise RuntimeError(f"{circle}: the robot fell, or the box did not turn around in {MOST_CYCLES} cycles")
        moved = box.inverse() @ planar_pose(outcome.world.box)
        box = planar_pose(outcome.world.box)
        heading_rad += moved.yaw_rad
        cycles.append((outcome.world.tick * CONTROL_PERIOD_S, box.x_m, box.y_m, heading_rad))
        ticks, places = np.array(trace.tick), np.array(trace.qpos)[:, 19:21]
        samples.append(np.column_stack([ticks * CONTROL_PERIOD_S, places])[ticks % SAMPLE_TICKS == 0])
        tilt_deg = np.maximum(tilt_deg, np.degrees(np.abs(trace.roll_pitch_rad).max(axis=0)))
        margin_m = min(margin_m, *trace.support_margin_m)
    return Course(
        cycles=np.array(cycles),
        samples=np.concatenate(samples),
        max_abs_roll_deg=float(tilt_deg[0]),
        max_abs_pitch_deg=float(tilt_deg[1]),
        min_support_margin_m=float(margin_m),
    )


def _scenario(friction: float) -> Scenario:
    """Return a wide floor with the box in its middle, offset by the seed."""
    box = Box(pose=PoseDeg(x_m=SIDE_M / 2, y_m=SIDE_M / 2, yaw_deg=0.0), friction=friction)
    return Scenario(
        name="circle",
        room=Room(size_m=(SIDE_M, SIDE_M)),
        start=PoseDeg(x_m=SIDE_M / 2 - box.size_m[0] / 2 - STATION_M, y_m=SIDE_M / 2, yaw_deg=0.0),
        box=box,
        goal=Goal(pose=PoseDeg(x_m=SIDE_M / 2 + 1.0, y_m=SIDE_M / 2, yaw_deg=0.0)),
        randomization=Randomization(box_xy_m=0.05, box_yaw_deg=5.0),
    )


def row(circle: Circle, course: Course) -> dict[str, Any]:
    """Return the fitted circle and sine of the steady part, and how far from its first place the box is after a
    turn."""
    steady = course.cycles[STEADY_FROM_CYCLE:]
    time_s, heading_rad = steady[:, 0], steady[:, 3]
    samples = course.samples[course.samples[:, 0] >= time_s[0]]
    rate_rad_s = float(np.polyfit(time_s, heading_rad, 1)[0])
    centre_m, radius_m, radial_rms_m = fit_circle(steady[:, 1:3])
    fits = {name: fit_sine(samples[:, 0], samples[:, column], abs(rate_rad_s)) for column, name in ((1, "x"), (2, "y"))}
    axis, worse = min(fits.items(), key=lambda item: item[1]["r2"])
    return {
        "direction": circle.direction,
        "depth_m": circle.depth_m,
        "friction": circle.friction,
        "seed": circle.seed,
        "cycles": len(course.cycles) - 1,
        "radius_m": round(radius_m, 4),
        "radial_rms_m": round(radial_rms_m, 5),
        "turn_deg_per_cycle": round(float(np.degrees(np.abs(np.diff(heading_rad)).mean())), 3),
        "turn_sd_deg": round(float(np.degrees(np.abs(np.diff(heading_rad)).std(ddof=1))), 3),
        "omega_deg_s": round(degrees(abs(rate_rad_s)), 4),
        "closing_m": round(closing_m(steady), 4),
        "axis": axis,
        **{key: round(value, 6) for key, value in worse.items()},
        "max_abs_roll_deg": round(course.max_abs_roll_deg, 2),
        "max_abs_pitch_deg": round(course.max_abs_pitch_deg, 2),
        "min_support_margin_m": round(course.min_support_margin_m, 4),
        "centre_x_m": round(centre_m[0], 4),
        "centre_y_m": round(centre_m[1], 4),
    }


def fit_circle(points_m: Floats) -> tuple[tuple[float, float], float, float]:
    """Return centre, radius and RMS radial distance of the circle that fits the points, (n, 2), best."""

    def radial(parameters: Floats) -> Floats:
        distance: Floats = np.hypot(*(points_m - parameters[:2]).T) - parameters[2]
        return distance

    centre = points_m.mean(axis=0)
    found = least_squares(radial, [*centre, np.hypot(*(points_m - centre).T).mean()])
    x_m, y_m, radius_m = found.x.tolist()
    return (x_m, y_m), radius_m, float(np.sqrt(np.mean(radial(found.x) ** 2)))


def fit_sine(time_s: Floats, value_m: Floats, omega_rad_s: float) -> dict[str, float]:
    """Fit q(t) = A sin(omega t + phi) + c by least squares, starting at this omega; returns parameters, R2 and RMSE."""
    basis = np.column_stack([np.sin(omega_rad_s * time_s), np.cos(omega_rad_s * time_s), np.ones_like(time_s)])
    a, b, c = np.linalg.lstsq(basis, value_m, rcond=None)[0]
    begin = (np.hypot(a, b), omega_rad_s, np.arctan2(b, a), c)
    best, _ = curve_fit(sine, time_s, value_m, p0=begin)
    residual = value_m - sine(time_s, *best)
    return {
        "amplitude_m": float(best[0]),
        "omega_rad_s": float(best[1]),
        "phi_rad": float(best[2]),
        "offset_m": float(best[3]),
        "r2": 1.0 - float(residual @ residual) / float(((value_m - value_m.mean()) ** 2).sum()),
        "rmse_m": float(np.sqrt(np.mean(residual**2))),
    }


def sine(time_s: Floats, amplitude_m: float, omega_rad_s: float, phi_rad: float, offset_m: float) -> Floats:
    """Return q(t) = A sin(omega t + phi) + c."""
    value: Floats = amplitude_m * np.sin(omega_rad_s * time_s + phi_rad) + offset_m
    return value


def closing_m(steady: Floats) -> float:
    """Return the distance of the box from its first place after one turn, interpolated between cycles."""
    turned = np.abs(steady[:, 3] - steady[0, 3])
    end = np.array([np.interp(2 * pi, turned, steady[:, axis]) for axis in (1, 2)])
    return float(np.hypot(*(end - steady[0, 1:3])))


def _series(planned: list[Circle], courses: list[Course]) -> Iterator[dict[str, Any]]:
    """Yield a row for the box after each cycle of each circle."""
    for circle, course in zip(planned, courses, strict=True):
        for time_s, x_m, y_m, heading_rad in course.cycles.tolist():
            yield {
                "direction": circle.direction,
                "depth_m": circle.depth_m,
                "friction": circle.friction,
                "seed": circle.seed,
                "time_s": round(time_s, 2),
                "x_m": round(x_m, 4),
                "y_m": round(y_m, 4),
                "heading_deg": round(degrees(heading_rad), 2),
            }


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Config)))
