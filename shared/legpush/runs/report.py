"""`report.json`: what came out of a mission."""

import json
from pathlib import Path
from typing import Any

from msgspec import Struct, to_builtins

from legpush.errors import LegpushError
from legpush.files import write_whole
from legpush.messages.measures import UnexpectedContact
from legpush.runs.folder import REPORT_FILE
from legpush.runs.reasons import Reason


class Appeared(Struct, frozen=True, kw_only=True):
    """An obstacle that appeared."""

    obstacle: int
    """Its place in `room.obstacles`, from 0."""
    time_s: float
    """Simulated time since the reset."""


class OfJoints(Struct, frozen=True, kw_only=True):
    """A number for each kind of joint: the largest one of the four legs."""

    hip_x: float
    hip_y: float
    knee: float


class PhaseReport(Struct, frozen=True, kw_only=True):
    """What was measured at every physics step of 2 ms while the robot walked, or while it pushed. A foot is loaded from
    4.8 % of the robot's weight on until it has less than 1.6 %."""

    n_steps: int
    """Number of physics steps."""
    n_footsteps: int
    max_torque_n_m: OfJoints
    usual_torque_n_m: OfJoints
    """Torques that 99.9 % of all are below, rounded up to a hundredth of the largest torque of the joint."""
    max_speed_rad_s: OfJoints
    max_power_w: OfJoints
    share_at_torque_limit: float
    """Share of steps and joints with all the torque that the servo had at its angle and speed."""
    least_to_joint_limit_deg: float
    """Least distance of a joint from the end of its range; negative beyond it."""
    energy_j: float
    """Mechanical work of the servos while their power was positive."""
    travel_m: float
    """Way of the trunk."""
    cost_of_transport: float | None
    """Energy over weight and way; None if the robot did not move."""
    min_support_margin_m: float
    """Least distance of the CoM's ground projection from the border of the support polygon; negative outside."""
    n_outside_support: int
    """Number of physics steps in which that was negative."""
    min_zmp_margin_m: float
    """The same of the zero-moment point."""
    min_capture_margin_m: float
    """The same of the capture point."""
    max_push_moment_n_m: float | None
    """Largest horizontal moment of all forces on the feet about the CoM (Eq. 9) while the box pressed on a foot; None
    if it never did."""
    touchdowns_per_footstep: float | None
    """How often the force on a foot rose above 1 N; None without a footstep."""
    loadings_per_footstep: float | None
    """How often a foot became loaded; None without a footstep."""
    usual_landing_speed_m_s: float | None
    """Downward speed that 99 % of the landings are below; None without a landing."""
    max_landing_speed_m_s: float | None
    max_penetration_m: float
    """How deep a foot was in the floor at most."""
    n_unexpected_steps: int
    """Number of physics steps with a contact that no plan asked for."""
    unexpected: tuple[UnexpectedContact, ...]


class Report(Struct, frozen=True, kw_only=True):
    """The fields of `report.json`; a number that could not be measured is None."""

    success: bool
    reason: Reason
    """Why the mission ended."""
    detail: str
    """One sentence for people."""
    remedy: str
    """What would change the reason, with the keys of the scenario or the options; empty for a success."""
    box_position_error_m: float
    """Of the true pose of the box, by which success is judged."""
    box_angle_error_deg: float
    walk_tracking_rms_m: float | None
    """Of the distance from the trunk, on the floor, to the path that it followed, over all ticks of gait cycles."""
    box_path_rms_m: float | None
    """Of the distance from the box's centre to the path that it was pushed along, planned or reference, after each
    push cycle."""
    handover_distance_m: float | None
    """From trunk to box where walking handed over to pushing."""
    trunk_max_abs_pitch_deg: float | None
    trunk_max_abs_roll_deg: float | None
    min_support_margin_m: float | None
    """Least distance of the CoM's ground projection from the border of the support polygon in all physics steps;
    negative outside."""
    walking: PhaseReport | None
    """None if the robot did not walk."""
    pushing: PhaseReport | None
    """None if it did not push. A push cycle includes the steps to the box after the push."""
    n_better_paths: int
    """How often the robot took a better path while it walked."""
    n_replans: int
    """How often an obstacle appeared in the way of robot or box, or the robot was thrown off its way."""
    appeared: tuple[Appeared, ...]
    n_push_cycles: int
    n_footsteps: int
    sim_time_s: float
    wall_time_s: float
    """From the beginning of the journal to its last entry."""
    real_time_factor: float
    """Simulated time by wall time."""
    state_crc: str
    """Of the last state, eight hexadecimal digits: equal missions have equal ones."""
    seed: int
    scenario: str
    """Name of the scenario."""
    scenario_sha256: str
    """Of the scenario with every field, as `scenario.toml` in the folder of the run has it."""
    policy: str
    """What chose the pushes: a name, a path or `module:function`; of an object in Python, its type."""
    planner: str
    """What planned: the search of the scenario, or the command of another planner process."""
    command: str
    """The command that began the mission; empty if a Python program did."""
    numerics: str | None
    """Name of the numerics that it was computed with, such as `x86-64-v3/1a2b3c4d`; None if it was not noted."""
    versions: dict[str, str | None]
    """Of the host that wrote the report; None for what is not installed there."""
    notes: tuple[str, ...] = ()
    """Contacts that no plan asked for, and why there is no picture or no film."""
    perceived_box_position_error_m: float | None = None
    """Of the box as it was perceived at the end; None if it was perceived exactly."""
    perceived_box_angle_error_deg: float | None = None


class ReportError(LegpushError):
    """A mission that ended without a report that can be read; names the file."""


def read_report(folder: Path) -> dict[str, Any]:
    """Read the report that an agent left in the folder of a run.

    Raises:
        ReportError: There is none that can be read.
    """
    path = folder / REPORT_FILE
    try:
        report = json.loads(path.read_bytes())
    except (OSError, ValueError) as error:
        raise ReportError(f"{path}: expected the report of the mission ({error})") from error
    if not isinstance(report, dict):
        raise ReportError(f"{path}: expected a JSON object, got {type(report).__name__}")
    return report


def add_note(folder: Path, note: str) -> None:
    """Add a note to the report in the folder of a run, if there is one.

    Raises:
        ReportError: The report cannot be read.
        DiskError: It cannot be written; the previous one is unchanged.
    """
    if (folder / REPORT_FILE).exists():
        report = read_report(folder)
        write_report({**report, "notes": [*report.get("notes", ()), note]}, folder)


def write_report(report: Report | dict[str, Any], folder: Path) -> None:
    """Write `report.json` into the folder of a run.

    Raises:
        DiskError: It cannot be written; the previous one is unchanged.
    """
    write_whole(folder / REPORT_FILE, (json.dumps(to_builtins(report), indent=2) + "\n").encode(), private=True)
