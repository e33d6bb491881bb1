"""Numbers of a mission that its report lacks: paths and faces of the box, how far it went, and tracks."""

from itertools import pairwise
from typing import Any, Final

from agent_proc.reporting.mission_record import MissionRecord
from agent_proc.reporting.phases import travel_m
from legpush.messages.planning import BoxPathQuery
from legpush.messages.stepping import Push
from legpush.study.cells import Column

TRACK_STEPS: Final = 4
"""A track has every n-th step of its mission, and the last one."""
N_DIGITS: Final = 3
"""Ways and tracks are rounded to millimetres."""

NUMBERS: Final = (
    Column(name="box_mass_kg", unit="kg", about="mass of the box"),
    Column(name="box_friction", unit="", about="friction of the box"),
    Column(name="n_box_paths", unit="", about="how often a path of the box was planned"),
    Column(name="first_box_path_m", unit="m", about="length of the first path of the box"),
    Column(name="n_faces", unit="", about="number of faces that were pushed"),
    Column(name="n_face_changes", unit="", about="how often the robot went to another face"),
    Column(name="box_travel_m", unit="m", about="way of the box"),
    Column(name="robot_travel_m", unit="m", about="way of the trunk"),
)
TRACKS: Final = tuple(
    Column(name=f"track_{body}_{axis}_m", unit="m", about=f"{axis} of the {body} in every {TRACK_STEPS}th step")
    for body in ("trunk", "box")
    for axis in ("x", "y")
)


def numbers(record: MissionRecord) -> dict[str, Any]:
    """Return the columns of `NUMBERS`."""
    ticks = record.ticks()
    paths = [each for each in record.plans if isinstance(each.query, BoxPathQuery)]
    faces = [step.motion.face for step in record.steps if isinstance(step.motion, Push)]
    return {
        "box_mass_kg": record.scenario.box.mass_kg,
        "box_friction": record.scenario.box.friction,
        "n_box_paths": len(paths),
        "first_box_path_m": round(paths[0].plan.length_m, N_DIGITS) if paths else None,
        "n_faces": len(set(faces)),
        "n_face_changes": sum(a != b for a, b in pairwise(faces)),
        "box_travel_m": round(travel_m(ticks.box[:, :2]), N_DIGITS),
        "robot_travel_m": round(travel_m(ticks.trunk_m), N_DIGITS),
    }


def tracks(record: MissionRecord) -> dict[str, list[float]]:
    """Return the columns of `TRACKS`."""
    steps = [*record.steps[::TRACK_STEPS], record.steps[-1]]
    return {
        f"track_{body}_{axis}_m": [round(getattr(step.world, body).position_m[index], N_DIGITS) for step in steps]
        for body in ("trunk", "box")
        for index, axis in enumerate("xy")
    }
