"""Columns of a mission about its joints, feet and stability at every physics step, apart for walking and pushing."""

from collections.abc import Iterator
from typing import Any, Final

from legpush.runs.report import PhaseReport, Report
from legpush.scene.conventions import JOINTS
from legpush.study.cells import Column

PHASES: Final = {"walk": "walking", "push": "pushing"}
"""Prefix of the columns of a phase, and its field in the report."""
OF_JOINTS: Final = {
    "max_torque_n_m": ("N m", "largest torque"),
    "usual_torque_n_m": ("N m", "torque that 99.9 % are below"),
    "max_speed_rad_s": ("rad/s", "largest speed"),
    "max_power_w": ("W", "largest power"),
}
"""Fields with a number for each kind of joint, with their units."""
NUMBERS: Final = {
    "n_steps": ("", "number of physics steps of 2 ms"),
    "share_at_torque_limit": ("", "share of steps and joints at the limit of torque"),
    "least_to_joint_limit_deg": ("deg", "least distance of a joint from the end of its range"),
    "energy_j": ("J", "mechanical work of the servos while their power was positive"),
    "travel_m": ("m", "way of the trunk"),
    "cost_of_transport": ("", "energy over weight and way"),
    "min_support_margin_m": ("m", "least distance of the CoM from the border of its support"),
    "n_outside_support": ("", "number of physics steps in which that was negative"),
    "min_zmp_margin_m": ("m", "least distance of the zero-moment point from that border"),
    "min_capture_margin_m": ("m", "least distance of the capture point from that border"),
    "max_push_moment_n_m": ("N m", "largest horizontal moment of the feet about the CoM while the box was pushed"),
    "touchdowns_per_footstep": ("", "how often the force on a foot rose above 1 N"),
    "loadings_per_footstep": ("", "how often a foot became loaded"),
    "usual_landing_speed_m_s": ("m/s", "speed that 99 % of the landings are below"),
    "max_landing_speed_m_s": ("m/s", "fastest landing of a foot"),
    "max_penetration_m": ("m", "how deep a foot was in the floor at most"),
    "n_unexpected_steps": ("", "number of physics steps with a contact that no plan asked for"),
}
"""The other numbers."""
UNEXPECTED: Final = "unexpected"
"""The pairs of parts that touched unexpectedly, as texts."""


def _columns() -> Iterator[Column]:
    for prefix, phase in PHASES.items():
        for name, (unit, about) in OF_JOINTS.items():
            for joint in JOINTS:
                yield Column(name=f"{prefix}_{joint}_{name}", unit=unit, about=f"{about} of a {joint} joint, {phase}")
        for name, (unit, about) in NUMBERS.items():
            yield Column(name=f"{prefix}_{name}", unit=unit, about=f"{about}, {phase}")
        yield Column(name=f"{prefix}_{UNEXPECTED}", unit="", about=f"contacts that no plan asked for, {phase}")


PHASE_COLUMNS: Final = tuple(_columns())


def phase_numbers(report: Report) -> dict[str, Any]:
    """Return the columns of `PHASE_COLUMNS`; they are None for a phase that did not happen."""
    values: dict[str, Any] = {column.name: None for column in PHASE_COLUMNS}
    for prefix, phase in PHASES.items():
        if (found := getattr(report, phase)) is not None:
            values.update(_values(prefix, found))
    return values


def _values(prefix: str, report: PhaseReport) -> Iterator[tuple[str, Any]]:
    for name in OF_JOINTS:
        for joint in JOINTS:
            yield f"{prefix}_{joint}_{name}", getattr(getattr(report, name), joint)
    for name in NUMBERS:
        yield f"{prefix}_{name}", getattr(report, name)
    pairs = [f"{each.first}:{each.second} {each.n_steps} {each.max_force_n:.1f} N" for each in report.unexpected]
    yield f"{prefix}_{UNEXPECTED}", "; ".join(pairs)
