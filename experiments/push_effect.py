"""`python experiments/push_effect.py`: measures what a push cycle does to the box.

The pushes vary in depth and curve, the boxes in size, mass and friction. One simulator in this process pushes on an
open floor. Each row of `results/push_effect.csv` is over the same series of left and right pushes from three random
starts; right pushes are mirrored. `PushModel` contains the rows at 0.1 kg, friction 0.5 and w1 = w2 = 0.5: those of the
default box, 0.4 m long and 0.5 m wide, pushed at its rear or front face, and pushed at its left or right face.
"""

import csv
from collections.abc import Iterator
from math import degrees
from pathlib import Path
from typing import Any, Final

import numpy as np
from msgspec.structs import replace
from rich.progress import track

from agent_proc.push_model.calibration import Cell, cells, open_floor, push_series
from agent_proc.push_model.model import MIRROR, NOMINAL
from legpush.lockstep.local import LocalWorld
from legpush.scene.robot import CONTROL_PERIOD_S
from legpush.scene.scenario import Box
from sim_proc.simulator import Simulator

TABLE: Final = Path(__file__).parent / "results" / "push_effect.csv"
DEPTHS_M: Final = (0.005, 0.01, 0.02, 0.03, 0.05, 0.08, 0.10, 0.12)
CURVES: Final = ((0.5, 0.5), (0.2, 0.2), (0.8, 0.8))
BOXES: Final = (
    (0.4, 0.5, 0.1, 0.5),
    (0.4, 0.5, 0.1, 0.3),
    (0.4, 0.5, 0.1, 0.8),
    (0.4, 0.5, 0.9, 0.5),
    (0.5, 0.4, 0.1, 0.5),
    (0.5, 0.4, 0.1, 0.3),
    (0.5, 0.4, 0.1, 0.8),
)
"""Length and width in m, mass in kg, and friction coefficient."""
SEEDS: Final = (1000, 1001, 1002)


def main() -> None:
    """Measure all combinations."""
    cases = [(box, (0.5, 0.5), depth) for box in BOXES for depth in DEPTHS_M]
    cases += [(BOXES[0], curve, depth) for curve in CURVES[1:] for depth in DEPTHS_M]
    rows = [measure(*case) for case in track(cases, description="push effect")]
    with TABLE.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    print(TABLE.read_text(), end="")


def measure(of: tuple[float, float, float, float], curve: tuple[float, float], depth_m: float) -> dict[str, Any]:
    """Return one row: means and standard deviations over the series."""
    length_m, width_m, mass_kg, friction = of
    box = replace(NOMINAL, size_m=(length_m, width_m, NOMINAL.size_m[2]), mass_kg=mass_kg, friction=friction)
    planned = cells(("rear",), (curve,), (depth_m,), SEEDS)
    samples = np.array([sample for cell in planned for sample in push_samples(box, cell)])
    mean, spread = samples.mean(axis=0), samples.std(axis=0, ddof=1)
    return {
        "length_m": length_m,
        "width_m": width_m,
        "mass_kg": mass_kg,
        "friction": friction,
        "w1": curve[0],
        "w2": curve[1],
        "depth_m": depth_m,
        "n": len(samples),
        "forward_m": round(mean[0], 4),
        "forward_sd_m": round(spread[0], 4),
        "left_m": round(mean[1], 4),
        "left_sd_m": round(spread[1], 4),
        "turn_deg": round(mean[2], 2),
        "turn_sd_deg": round(spread[2], 2),
        "largest_tilt_deg": round(samples[:, 3].max(), 2),
        "least_margin_m": round(samples[:, 4].min(), 4),
        "longest_s": round(samples[:, 5].max(), 2),
    }


def push_samples(box: Box, cell: Cell) -> Iterator[tuple[float, float, float, float, float, float]]:
    """Yield for each push: forward and left [m] and turn [deg], as of FL; tilt [deg], support margin [m], duration
    [s]."""
    for push, moved, outcome in push_series(LocalWorld(Simulator()), open_floor(box, cell.face), cell):
        if outcome.trace is None:
            raise RuntimeError("Expected a trace of each push")
        mirror = MIRROR[push.leg]
        tilt_deg = degrees(np.abs(outcome.trace.roll_pitch_rad).max())
        duration_s = len(outcome.trace.tick) * CONTROL_PERIOD_S
        margin_m = min(outcome.trace.support_margin_m)
        yield moved.x_m, mirror * moved.y_m, mirror * degrees(moved.yaw_rad), tilt_deg, margin_m, duration_s


if __name__ == "__main__":
    main()
