"""`python -m experiments.unknown_boxes`: compares measured and guessed turning circles of boxes without a push map.

For each box and face, 24 pushes measure the circle that one foot pushes the box along (`legpush calibrate`). It is
compared with the guess of a robot that has never pushed the box, and with the estimate after the four pushes of
`pushing.calibration_pushes`, from five places of the box. One simulator in this process is used. A row per box and face
goes to `results/unknown_boxes.csv`, the picture to `results/unknown_boxes.png`.
"""

import sys
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure
from msgspec.structs import replace
from rich.progress import track

from agent_proc.push_model.calibration import calibrate, cells, open_floor
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.push_model.map import make_push_map, measured_faces
from agent_proc.push_model.model import NOMINAL
from agent_proc.pushing.calibrating import CALIBRATION_LEGS
from experiments.evaluations import RESULTS, errors_of, kinds_of, write_table
from legpush.lockstep.local import LocalWorld
from legpush.messages.common import USUAL_DEPTH_M
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, Reset
from legpush.scene.faces import pushed_box, pushed_pose
from legpush.scene.names import Face
from legpush.scene.robot import FRONT_LEGS
from legpush.scene.scenario import Box
from sim_proc.simulator import Simulator

BOXES: Final[dict[str, Box]] = {
    "default": NOMINAL,
    "0.9 kg, friction 0.3": replace(NOMINAL, mass_kg=0.9, friction=0.3),
    "0.9 kg, friction 0.8": replace(NOMINAL, mass_kg=0.9, friction=0.8),
    "5 kg": replace(NOMINAL, mass_kg=5.0),
    "0.6 x 0.35 m": replace(NOMINAL, size_m=(0.6, 0.35, 0.4)),
    "0.3 x 0.4 m": replace(NOMINAL, size_m=(0.3, 0.4, 0.3)),
    "0.5 x 0.5 m": replace(NOMINAL, size_m=(0.5, 0.5, 0.4)),
    "cylinder, 0.5 m": replace(NOMINAL, size_m=(0.5, 0.5, 0.4), shape="cylinder"),
}
MEASURED_SEEDS: Final = (50_000, 50_001, 50_002)
OWN_SEEDS: Final = (50_100, 50_101, 50_102, 50_103, 50_104)
COLORS: Final = {"measured": "black", "guessed": "#c8553d", "after four pushes": "#3a6ea5"}


def main() -> int:
    """Measure all boxes, write the table and draw."""
    cases = [(name, box, face) for name, box in BOXES.items() for face in measured_faces(box)]
    rows = [row(*case) for case in track(cases, description="boxes")]
    write_table(rows, RESULTS / "unknown_boxes.csv")
    draw(rows)
    for one in rows:
        print(
            f"{one['box']}, {one['face']} face: radius {one['radius_m']:.3f} m [{one['radius_m_low']:.3f}, "
            f"{one['radius_m_high']:.3f}], guessed {one['guessed_m']:.3f}, after four pushes {one['own_m']:.3f} "
            f"± {one['own_sd_m']:.3f}"
        )
    return 0


def row(name: str, box: Box, face: Face) -> dict[str, Any]:
    """Measure one face of a box; return its row."""
    world = LocalWorld(Simulator())
    planned = cells((face,), ((0.5, 0.5),), (USUAL_DEPTH_M,), MEASURED_SEEDS)
    (circle,) = make_push_map(box, calibrate([world], box, planned), "").circles
    own_m = [own_radius_m(world, box, face, seed) for seed in OWN_SEEDS]
    return {
        "box": name,
        "face": face,
        **circle.radius_m.columns("radius_m", 4),
        "axle_m": circle.axle_m.value,
        "guessed_m": round(PushEstimate(pushed_box(box, face)).turning_radius_m, 4),
        "own_m": round(float(np.mean(own_m)), 4),
        "own_sd_m": round(float(np.std(own_m, ddof=1)), 4),
    }


def own_radius_m(world: LocalWorld, box: Box, face: Face, seed: int) -> float:
    """Return the turning radius that a robot assumes after the pushes of its own calibration."""
    estimate = PushEstimate(pushed_box(box, face))
    outcome = world.step(Reset(scenario=open_floor(box, face), seed=seed))
    before = pushed_pose(planar_pose(outcome.world.box), face)
    for index in CALIBRATION_LEGS:
        push = Push(w1=0.5, w2=0.5, leg=FRONT_LEGS[index], depth_m=USUAL_DEPTH_M, face=face)
        after = pushed_pose(planar_pose(world.step(push).world.box), face)
        estimate.learn(before, push, after)
        before = after
    return estimate.turning_radius_m


def draw(rows: list[dict[str, Any]]) -> None:
    """Draw a line for each box and face."""
    figure = Figure(figsize=(8.6, 0.36 * len(rows) + 1.2), layout="constrained")
    axis = figure.subplots()
    at = np.arange(len(rows))[::-1]
    radius, reach = errors_of(rows, "radius_m")
    axis.errorbar(
        radius,
        at,
        xerr=reach,
        fmt="s",
        ms=5,
        capsize=3,
        color=COLORS["measured"],
        label=f"measured by 24 pushes, {kinds_of(rows, 'radius_m')}",
    )
    axis.plot([one["guessed_m"] for one in rows], at, "x", ms=7, color=COLORS["guessed"], label="guessed")
    own, sd = np.array([one["own_m"] for one in rows]), np.array([one["own_sd_m"] for one in rows])
    axis.errorbar(
        own,
        at - 0.22,
        xerr=sd,
        fmt="o",
        ms=4,
        capsize=2,
        color=COLORS["after four pushes"],
        label="after four pushes, ± sd",
    )
    axis.set_yticks(at, [f"{one['box']}, {one['face']} face" for one in rows])
    axis.set(xlabel="turning radius of the point that does not slip sideways [m]", xlim=(0.0, None))
    axis.grid(axis="x", color="#e6e8eb")
    axis.legend(frameon=False, fontsize=8)
    figure.savefig(RESULTS / "unknown_boxes.png", dpi=120)


if __name__ == "__main__":
    sys.exit(main())
