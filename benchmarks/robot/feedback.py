"""`python -m benchmarks.robot.feedback`: what the robot takes with and without feedback.

Without it there are no capture steps, no second steps and no higher steps on a rough floor, and the slope is the one of
the room. The numbers go to `results/feedback.json`. With `--profile real` the rest of the world is that of the profile,
always with feedback, and they go to `results/feedback_real.json`.

They take about 25 and 15 min of CPU, and can be interrupted at any time: the same command goes on, from results in
`runs/benchmarks`.
"""

from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any, Final
from unittest.mock import patch

import tyro
from msgspec.structs import replace

from benchmarks.report import write_report
from benchmarks.robot.edges import floor_with_edge
from benchmarks.robot.kept import Kept
from benchmarks.robot.motions import Done, curved_walk, pushes, straight_walk
from legpush.realism.settings import FloorTiles, Gusts, PoseSensor, Profile, Realism
from legpush.scene.conventions import CONTROL_PERIOD_S
from legpush.scene.robot import RobotSpec
from sim_proc.estimation.plumb_line import PlumbLine

MASS_KG: Final = 1.0
"""Of the box that is pushed."""
AROUND: Final = (0.0, 360.0)
"""Any direction."""
PHASES: Final = 12
"""Phases of the gait in which a gust comes."""
FIRST_S: Final = 6.06
"""When the first of them does."""
DIRECTIONS_DEG: Final = (30.0, 120.0, 210.0, 300.0)
EDGES_M: Final = tuple(1.015 + 0.04 * index for index in range(10))
"""Where the edge of a step lies, from the start: all over one stride."""
NEVER_M: Final = 1.0
"""A deviation that no robot has which stands."""


@dataclass(frozen=True, kw_only=True)
class Config:
    """How often to walk and push."""

    seeds: int = 20
    """Number of walks, and of boxes that are pushed four times, with each disturbance that a seed draws."""
    tile_seeds: int = 10
    """Number of walks over tiles."""
    first_seed: int = 1200
    profile: Profile = "ideal"
    """The world but for the disturbance."""
    only: str = ""
    """Only disturbances with this in their names; nothing is written then."""


Runs = Iterator[Callable[[], Done]]
"""Walks and pushes that have not been made."""
Case = Callable[[RobotSpec, Profile], Runs]


def without_feedback() -> RobotSpec:
    """A robot that notices nothing."""
    robot = RobotSpec()
    capture = replace(robot.capture, from_m=NEVER_M, most_m=NEVER_M)
    rough = replace(robot.rough, from_m=NEVER_M, missed_m=NEVER_M)
    return replace(robot, capture=capture, rough=rough)


def gust(force_n: float, at_s: float, direction_deg: float) -> Realism:
    """One gust of 0.2 s."""
    return Realism(gusts=Gusts(force_n=force_n, duration_s=0.2, at_s=at_s, direction_deg=direction_deg))


def gusts_while_walking(force_n: float, robot: RobotSpec, profile: Profile) -> Runs:
    """A walk of 3 m for each phase and direction."""
    gait = robot.gait
    cycle_s = 4 * (gait.shift_ticks + gait.swing_ticks) * CONTROL_PERIOD_S
    for direction_deg, phase in product(DIRECTIONS_DEG, range(PHASES)):
        at_s = FIRST_S + phase * cycle_s / PHASES
        realism = replace(gust(force_n, at_s, direction_deg), profile=profile)
        yield partial(straight_walk, 3.0, robot=robot, realism=realism)


def slopes(slope_deg: float, robot: RobotSpec, profile: Profile) -> Runs:
    """A walk of 3 m in each of twelve directions on a slope that the robot is not told."""
    for index in range(12):
        realism = Realism(profile=profile, slope_deg=slope_deg, uphill_deg=15.0 + 30.0 * index)
        yield partial(straight_walk, 3.0, robot=robot, realism=realism)


def edges(height_m: float, robot: RobotSpec, profile: Profile) -> Runs:
    """A walk of 2.5 m up a step, for each place of its edge."""
    return (partial(_up_a_step, edge_m, height_m, robot, profile) for edge_m in EDGES_M)


def _up_a_step(edge_m: float, height_m: float, robot: RobotSpec, profile: Profile) -> Done:
    with floor_with_edge(edge_m, height_m):
        return straight_walk(2.5, robot=robot, realism=Realism(profile=profile))


def walks(seeds: range, realism: Realism, robot: RobotSpec, profile: Profile) -> Runs:
    """Walks along curves."""
    return (partial(curved_walk, seed, robot=robot, realism=replace(realism, profile=profile)) for seed in seeds)


def pushing(seeds: range, realism: Realism, robot: RobotSpec, profile: Profile) -> Runs:
    """Boxes that are pushed four times."""
    return (partial(pushes, seed, MASS_KG, robot=robot, realism=replace(realism, profile=profile)) for seed in seeds)


def cases(config: Config) -> dict[str, Case]:
    """The disturbances, with their sizes."""
    seeds = range(config.first_seed, config.first_seed + config.seeds)
    tile_seeds = range(config.first_seed, config.first_seed + config.tile_seeds)
    often = Gusts(force_n=100.0, duration_s=0.2, at_s=(0.0, 3.0), every_s=3.0, direction_deg=AROUND)
    slope = Realism(slope_deg=5.0, uphill_deg=AROUND)
    together = Realism(command_latency_s=0.06, motor_strength=0.8, foot_friction=0.5)
    loaded = replace(slope, payload_kg=10.0, box_pose=PoseSensor(noise_m=0.01, noise_deg=1.0))
    late = Realism(command_latency_s=0.1)
    found: dict[str, Case] = {"walking: nothing": partial(walks, seeds, Realism())}
    found |= {
        f"walking: a gust of {force_n:g} N": partial(gusts_while_walking, force_n) for force_n in (100.0, 150.0, 200.0)
    }
    for height_m in (0.05, 0.08):
        tiles = Realism(floor=FloorTiles(height_m=height_m, size_m=0.25))
        found[f"walking: tiles of {100 * height_m:g} cm"] = partial(walks, tile_seeds, tiles)
    found["walking: a step of 8 cm"] = partial(edges, 0.08)
    for slope_deg in (10.0, 15.0):
        found[f"walking: an unknown slope of {slope_deg:g}°"] = partial(slopes, slope_deg)
    for name, realism in (
        ("latency 100 ms", late),
        ("latency 60 ms, strength 0.8, friction 0.5", together),
        ("payload 10 kg, slope 5°, noise of the box", loaded),
    ):
        found[f"walking: {name}"] = partial(walks, seeds, realism)
        found[f"pushing: {name}"] = partial(pushing, seeds, realism)
    found["walking: payload 10 kg"] = partial(walks, seeds, Realism(payload_kg=10.0))
    if config.profile == "real":
        found["walking: sensors 60 ms late"] = partial(walks, seeds, Realism(sensor_latency_s=0.06))
    found["walking: gusts of 100 N"] = partial(walks, seeds, Realism(gusts=often))
    found["pushing: gusts of 100 N"] = partial(pushing, seeds, Realism(gusts=often))
    found["pushing: an unknown slope of 5°"] = partial(pushing, seeds, slope)
    found["pushing: both"] = partial(pushing, seeds, replace(slope, gusts=often))
    return found


def counted(runs: Runs, key: str, kept: Kept) -> dict[str, Any]:
    """How many did not fall and came to the end of their path. `key` says what they are."""
    done = [kept.result(f"{key}, {index}", dict[str, Any], partial(_ended, run)) for index, run in enumerate(runs)]
    way_m, duration_s = sum(run["way_m"] for run in done), sum(run["duration_s"] for run in done)
    return {
        "n": len(done),
        "n_falls": sum(run["fell"] for run in done),
        "n_stopped": sum(run["stopped"] for run in done),
        "speed_m_s": round(way_m / duration_s, 3),
    }


def _ended(run: Callable[[], Done]) -> dict[str, Any]:
    """Carry out a run, and tell how it ended."""
    done = run()
    return {"fell": done.fell, "stopped": done.stopped, "way_m": done.way_m, "duration_s": done.duration_s}


def main(config: Config) -> None:
    """Walk and push with each disturbance, with and without feedback."""
    found: dict[str, dict[str, Any]] = {}
    kept = Kept("feedback", Path(__file__).parent)
    for name, case in cases(config).items():
        if config.only not in name:
            continue
        found[name] = {}
        for variant in ("with", "without") if config.profile == "ideal" else ("with",):
            robot = RobotSpec() if variant == "with" else without_feedback()
            key = f"{name}, {variant}, {config.profile}, from {config.first_seed}"
            # Without feedback the IMU tells nothing about the slope.
            with nullcontext() if variant == "with" else patch.object(PlumbLine, "feel"):
                found[name][variant] = counted(case(robot, config.profile), key, kept)
        print(name, found[name], flush=True)
    if config.only:
        return
    name = "feedback" if config.profile == "ideal" else "feedback_real"
    write_report(name, {"first_seed": config.first_seed, "disturbances": found})


if __name__ == "__main__":
    main(tyro.cli(Config))
