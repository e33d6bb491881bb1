"""Runs missions in random rooms, each in three processes."""

from functools import cache
from itertools import pairwise
from pathlib import Path
from threading import Lock
from typing import Any, Final

import numpy as np
from msgspec.structs import replace

from agent_proc.pushing.solvable import solvable_by
from agent_proc.reporting.mission_record import MissionRecord
from experiments.mission_runs import run_scenario
from legpush.messages.planning import BoxPathQuery
from legpush.messages.stepping import Push
from legpush.scenarios.random_room import RandomRoom
from legpush.scenarios.random_scenario import random_scenario
from legpush.scene.scenario import Scenario
from planner_proc.planning import make_plan

MASSES_KG: Final = (0.1, 0.5, 0.9)
FRICTION: Final = (0.3, 0.8)
POSITION_TOLERANCE_M: Final = 0.05
ANGLE_TOLERANCE_DEG: Final = 5.0
FROM_REPORT: Final = (
    "success",
    "reason",
    "detail",
    "box_position_error_m",
    "box_angle_error_deg",
    "walk_tracking_rms_m",
    "box_path_rms_m",
    "handover_distance_m",
    "trunk_max_abs_pitch_deg",
    "trunk_max_abs_roll_deg",
    "min_support_margin_m",
    "n_push_cycles",
    "n_footsteps",
    "sim_time_s",
    "state_crc",
)
DRAWING: Final = Lock()
TRACK_STEPS: Final = 4
"""A track has every n-th step of its mission."""


def drawn_room(seed: int) -> tuple[Scenario, int]:
    """Return the room of a seed, and how many rooms of the seed were rejected before because no way was found.

    Only one thread draws at a time, because OMPL has one seed for all planners of a process.
    """
    with DRAWING:
        return _drawn_room(seed)


@cache
def _drawn_room(seed: int) -> tuple[Scenario, int]:
    low, high = FRICTION
    room = RandomRoom(
        mass_kg=MASSES_KG[seed % len(MASSES_KG)],
        friction=round(low + (high - low) * float(np.random.default_rng(seed).random()), 2),
        position_tolerance_m=POSITION_TOLERANCE_M,
        angle_tolerance_deg=ANGLE_TOLERANCE_DEG,
    )
    answers: list[bool] = []
    is_solvable = solvable_by(make_plan, seed)

    def ask(scenario: Scenario) -> bool:
        answers.append(is_solvable(scenario))
        return answers[-1]

    return random_scenario(room, seed, ask), answers.count(False)


def run_mission(
    seed: int, handover_distance_m: float, failed: Path | None = None
) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Run one mission; return its row and its track. If it fails, copy its picture to the folder `failed`."""
    scenario, n_unsolvable = drawn_room(seed)
    scenario = replace(scenario, mission=replace(scenario.mission, handover_distance_m=handover_distance_m))
    report, record = run_scenario(scenario, seed, failed)
    row = {
        "seed": seed,
        "n_unsolvable": n_unsolvable,
        "mass_kg": scenario.box.mass_kg,
        "friction": scenario.box.friction,
    }
    row |= {name: report[name] for name in FROM_REPORT}
    return row | _of_record(record), _track(seed, record)


def _of_record(record: MissionRecord) -> dict[str, Any]:
    """Return what the report lacks: the paths of the box, its pushed faces, and how far box and robot went."""
    ticks = record.ticks()
    paths = [each for each in record.plans if isinstance(each.query, BoxPathQuery)]
    faces = [step.motion.face for step in record.steps if isinstance(step.motion, Push)]
    return {
        "n_box_paths": len(paths),
        "first_box_path_m": round(paths[0].plan.length_m, 3) if paths else None,
        "n_faces": len(set(faces)),
        "n_face_changes": sum(a != b for a, b in pairwise(faces)),
        "box_travel_m": round(_length_m(ticks.box[:, :2]), 3),
        "robot_travel_m": round(_length_m(ticks.trunk_m), 3),
    }


TRAVEL_TICKS: Final = 50
"""Ways are measured from second to second, so that the sway of each step does not count."""


def _length_m(points: Any) -> float:
    every = np.concatenate([points[::TRAVEL_TICKS], points[-1:]])
    return float(np.hypot(*np.diff(every, axis=0).T).sum())


def _track(seed: int, record: MissionRecord) -> list[dict[str, Any]]:
    steps = [*record.steps[::TRACK_STEPS], record.steps[-1]]
    return [
        {
            "seed": seed,
            "trunk_x_m": round(step.world.trunk.position_m[0], 2),
            "trunk_y_m": round(step.world.trunk.position_m[1], 2),
            "box_x_m": round(step.world.box.position_m[0], 2),
            "box_y_m": round(step.world.box.position_m[1], 2),
        }
        for step in steps
    ]
