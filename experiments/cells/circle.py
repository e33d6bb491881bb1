"""The kind of cell that repeats one action, which pushes the box along a circle (Figs. 18 to 20).

A circle is two turns, to the left or right. As in the paper, q(t) = A sin(omega t + phi) + c is fitted to the steady
part of a coordinate; of x and y, the one that fits worse is reported.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees, pi
from typing import Annotated, Any, Final, Literal

import numpy as np
from msgspec import Meta, Struct
from scipy.optimize import curve_fit, least_squares

from legpush.arrays import Floats
from legpush.bounds import MAX_DEPTH_M
from legpush.fields import Seed
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, Reset
from legpush.realism.settings import Randomization
from legpush.scene.conventions import CONTROL_PERIOD_S, FrontLeg
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, Goal, PoseDeg, Room, Scenario
from legpush.study.cells import CellKind, Column, as_it_is
from sim_proc.simulator import Simulator

Direction = Literal["left", "right"]
PUSHED_BY: Final[dict[Direction, FrontLeg]] = {"left": "FR", "right": "FL"}
"""The leg for each direction: a foot right of the middle turns the box to the left."""
N_TURNS: Final = 2.0
STEADY_FROM_CYCLE: Final = 5
W: Final = 0.5
"""Both inner control points of the curve lie at the top of their locus."""
MOST_CYCLES: Final = 600
SAMPLE_TICKS: Final = 10
"""Ticks between two points of the fitted series."""
SIDE_M: Final = 8.0

COLUMNS: Final = (
    Column(name="cycles", unit="", about="pushes in two turns"),
    Column(name="radius_m", unit="m", about="radius of the circle that fits the steady part best"),
    Column(name="radial_rms_m", unit="m", about="distance from that circle, root mean square"),
    Column(name="turn_deg_per_cycle", unit="deg", about="mean turn by a push"),
    Column(name="turn_sd_deg", unit="deg", about="standard deviation of the turns"),
    Column(name="omega_deg_s", unit="deg/s", about="rate of turn"),
    Column(name="closing_m", unit="m", about="distance of the box from its first place after a turn"),
    Column(name="axis", unit="", about="the coordinate that the sine fits worse"),
    Column(name="amplitude_m", unit="m", about="of the sine"),
    Column(name="omega_rad_s", unit="rad/s", about="of the sine"),
    Column(name="phi_rad", unit="rad", about="of the sine"),
    Column(name="offset_m", unit="m", about="of the sine"),
    Column(name="r2", unit="", about="coefficient of determination of the sine"),
    Column(name="rmse_m", unit="m", about="error of the sine, root mean square"),
    Column(name="max_abs_roll_deg", unit="deg", about="largest roll of the trunk"),
    Column(name="max_abs_pitch_deg", unit="deg", about="largest pitch of the trunk"),
    Column(name="min_support_margin_m", unit="m", about="least distance of the CoM from the border of its support"),
    Column(name="centre_x_m", unit="m", about="of the circle"),
    Column(name="centre_y_m", unit="m", about="of the circle"),
    Column(name="cycle_time_s", unit="s", about="simulated time after each push, and before the first"),
    Column(name="cycle_x_m", unit="m", about="of the box at these times"),
    Column(name="cycle_y_m", unit="m", about="of the box at these times"),
    Column(name="state_crc", unit="", about="CRC-32 of the simulator's last state"),
)


class Circle(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One circle to measure."""

    direction: Direction
    depth_m: Annotated[float, Meta(gt=0.0, le=MAX_DEPTH_M)]
    friction: Annotated[float, Meta(gt=0.0)]
    seed: Seed


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
    state_crc: int


def circle(cell: Circle) -> Mapping[str, Any]:
    """Push the box around and measure its circle."""
    return measures_of(push_around(cell))


def push_around(cell: Circle) -> Course:
    """Push until the box has turned `N_TURNS` times.

    Raises:
        RuntimeError: The robot fell, or the box does not turn around.
    """
    simulator = Simulator()
    outcome = simulator.perform(Reset(scenario=_scenario(cell.friction), seed=cell.seed), with_trace=False)
    push = Push(w1=W, w2=W, leg=PUSHED_BY[cell.direction], depth_m=cell.depth_m)
    box = planar_pose(outcome.world.box)
    start_rad = heading_rad = box.yaw_rad
    cycles = [(0.0, box.x_m, box.y_m, heading_rad)]
    samples: list[Floats] = []
    tilt_deg, margin_m = np.zeros(2), np.inf
    while abs(heading_rad - start_rad) < 2 * pi * N_TURNS:
        outcome = simulator.perform(push, with_trace=True)
        trace = outcome.trace
        if trace is None or outcome.world.fallen or len(cycles) > MOST_CYCLES:
            raise RuntimeError(f"{cell}: the robot fell, or the box did not turn around in {MOST_CYCLES} cycles")
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
        state_crc=outcome.state_crc,
    )


def _scenario(friction: float) -> Scenario:
    """Return a wide floor with the box in its middle, offset by the seed."""
    box = Box(pose=PoseDeg(x_m=SIDE_M / 2, y_m=SIDE_M / 2, yaw_deg=0.0), friction=friction)
    return Scenario(
        name="circle",
        room=Room(size_m=(SIDE_M, SIDE_M)),
        start=PoseDeg(x_m=SIDE_M / 2 - box.size_m[0] / 2 - RobotSpec().station_m, y_m=SIDE_M / 2, yaw_deg=0.0),
        box=box,
        goal=Goal(pose=PoseDeg(x_m=SIDE_M / 2 + 1.0, y_m=SIDE_M / 2, yaw_deg=0.0)),
        randomization=Randomization(box_xy_m=0.05, box_yaw_deg=5.0),
    )


def measures_of(course: Course) -> dict[str, Any]:
    """Return the fitted circle and sine of the steady part, and how far from its first place the box is after a
    turn."""
    steady = course.cycles[STEADY_FROM_CYCLE:]
    time_s, heading_rad = steady[:, 0], steady[:, 3]
    samples = course.samples[course.samples[:, 0] >= time_s[0]]
    rate_rad_s = float(np.polyfit(time_s, heading_rad, 1)[0])
    centre_m, radius_m, radial_rms_m = fit_circle(steady[:, 1:3])
    fits = {name: fit_sine(samples[:, 0], samples[:, column], abs(rate_rad_s)) for column, name in ((1, "x"), (2, "y"))}
    axis, worse = min(fits.items(), key=lambda item: item[1]["r2"])
    turns_deg = np.degrees(np.abs(np.diff(heading_rad)))
    return {
        "cycles": len(course.cycles) - 1,
        "radius_m": radius_m,
        "radial_rms_m": radial_rms_m,
        "turn_deg_per_cycle": float(turns_deg.mean()),
        "turn_sd_deg": float(turns_deg.std(ddof=1)),
        "omega_deg_s": degrees(abs(rate_rad_s)),
        "closing_m": closing_m(steady),
        "axis": axis,
        **worse,
        "max_abs_roll_deg": course.max_abs_roll_deg,
        "max_abs_pitch_deg": course.max_abs_pitch_deg,
        "min_support_margin_m": course.min_support_margin_m,
        "centre_x_m": centre_m[0],
        "centre_y_m": centre_m[1],
        "cycle_time_s": course.cycles[:, 0].round(2),
        "cycle_x_m": course.cycles[:, 1].round(4),
        "cycle_y_m": course.cycles[:, 2].round(4),
        "state_crc": f"{course.state_crc:08x}",
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


CIRCLE: Final = CellKind(specification=Circle, run=circle, resolved=Circle, resolve=as_it_is, columns=COLUMNS)
"""The kind of cell."""
