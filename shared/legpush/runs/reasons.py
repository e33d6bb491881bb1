"""The reasons why missions end: what each means, and what would change it."""

from dataclasses import dataclass
from typing import Final, Literal

Reason = Literal[
    "success",
    "fell",
    "box_tipped",
    "too_heavy",
    "no_path",
    "stuck",
    "missed_station",
    "left_reference",
    "max_push_cycles",
    "tolerance_missed",
    "bad_answer",
    "motion_refused",
    "episode_broken",
    "policy_failed",
]
"""Why a mission ended."""


ENDED_BY_ERROR: Final[tuple[Reason, ...]] = ("bad_answer", "motion_refused", "episode_broken", "policy_failed")
"""Reasons of missions that an error ended, with exit code 2."""


@dataclass(frozen=True, kw_only=True)
class Note:
    """What people should know about a reason."""

    meaning: str
    keys: tuple[str, ...]
    """Fields of the scenario and options of `legpush run` that would change it."""
    remedy: str
    """What to change; it names each key in backquotes. Empty for a success."""


REASONS: Final[dict[Reason, Note]] = {
    "success": Note(
        meaning="The box is within the tolerances of its goal, and the robot stands.",
        keys=(),
        remedy="",
    ),
    "fell": Note(
        meaning="The robot fell.",
        keys=("room.slope_deg", "box.mass_kg", "--planner-command"),
        remedy="lower `room.slope_deg` or `box.mass_kg`, or replace the planner (`--planner-command`) whose path made "
        "the robot fall",
    ),
    "box_tipped": Note(
        meaning="The box leans by more than 15°.",
        keys=("box.size_m", "box.com_offset_m", "box.friction", "pushing.faces"),
        remedy="lower the height in `box.size_m` or the centre of mass (`box.com_offset_m`), lower `box.friction`, or "
        "leave the narrow faces out of `pushing.faces`",
    ),
    "too_heavy": Note(
        meaning="The box takes more force than the robot can push with, which is told before the robot walks.",
        keys=("box.mass_kg", "box.friction", "robot.legs.foot_friction", "robot.joints.hip_y.max_torque_n_m"),
        remedy="lower `box.mass_kg` or `box.friction`, or let a robot push that can do more: "
        "`robot.legs.foot_friction`, `robot.joints.hip_y.max_torque_n_m`",
    ),
    "no_path": Note(
        meaning="The planner found no path of the robot or of the box.",
        keys=(
            "planning.margin_m",
            "planning.body_margin_m",
            "planning.max_iterations",
            "pushing.margin_m",
            "pushing.max_iterations",
            "pushing.turning_reserve",
            "reference",
        ),
        remedy="lower `planning.margin_m`, `planning.body_margin_m`, `pushing.margin_m` or `pushing.turning_reserve`, "
        "raise `planning.max_iterations` or `pushing.max_iterations`, or widen the curves of `reference`",
    ),
    "stuck": Note(
        meaning="The robot or the box moved too little, several cycles in a row.",
        keys=("box.mass_kg", "box.friction", "planning.margin_m"),
        remedy="lower `box.mass_kg` or `box.friction` if it was the box, raise `planning.margin_m` if it was the robot",
    ),
    "missed_station": Note(
        meaning="The robot walked to the box, but ended too far from the place to push from.",
        keys=("planning.margin_m", "mission.handover_distance_m", "box.friction"),
        remedy="raise `planning.margin_m`, or measure the box from nearer by with `mission.handover_distance_m`; raise "
        "`box.friction` if the box slid away",
    ),
    "left_reference": Note(
        meaning="The box deviates from the reference by more than 10 cm or 25°.",
        keys=("reference", "pushing.calibration_pushes"),
        remedy="widen the curves of `reference`, or measure the box first with `pushing.calibration_pushes`",
    ),
    "max_push_cycles": Note(
        meaning="The push cycles of the mission are used up, or cannot do, which is told before the robot walks.",
        keys=("mission.max_push_cycles",),
        remedy="raise `mission.max_push_cycles`, or leave it out: it then follows from the path of the box",
    ),
    "tolerance_missed": Note(
        meaning="Pushing ended, but the box is outside the tolerances of its goal.",
        keys=("goal.position_tolerance_m", "goal.angle_tolerance_deg", "pushing.composition"),
        remedy="raise `goal.position_tolerance_m` or `goal.angle_tolerance_deg`; an open loop "
        "(`pushing.composition`) corrects no errors",
    ),
    "bad_answer": Note(
        meaning="Planner or simulator gave an answer that the protocol forbids.",
        keys=("--planner-command",),
        remedy="mend or replace that process: `legpush plan-check` tests the planner of `--planner-command`",
    ),
    "motion_refused": Note(
        meaning="The simulator refused a motion in the state that it was in.",
        keys=("--planner-command", "box.size_m"),
        remedy="the motion came from a path of the planner (`--planner-command`), or `box.size_m` puts the contact "
        "point or the curve of a push out of reach",
    ),
    "episode_broken": Note(
        meaning="The simulator failed in a motion, such as at numbers that physics cannot carry.",
        keys=("box.mass_kg", "box.size_m", "box.friction"),
        remedy="choose usual numbers for `box.mass_kg`, `box.size_m` and `box.friction`",
    ),
    "policy_failed": Note(
        meaning="The policy raised an exception, or decided something that is no push.",
        keys=("--policy",),
        remedy="mend the policy or choose another one with `--policy`",
    ),
}
