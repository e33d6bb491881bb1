"""The table of what was measured at every physics step of a mission, apart for walking and pushing."""

from collections.abc import Callable
from typing import Any, Final

from rich.table import Table
from rich.text import Text

from legpush.errors import one_line
from legpush.scene.conventions import JOINTS

PHASES: Final = ("walking", "pushing")
"""Fields of the report, and columns of the table."""


def _joints(pattern: str) -> Callable[[Any], str]:
    return lambda of: " / ".join(format(of[joint], pattern) for joint in JOINTS)


def _unexpected(pairs: Any) -> str:
    return ", ".join(f"{each['first']} with {each['second']}" for each in pairs) or "none"


PHASE_ROWS: Final[dict[str, tuple[str, Callable[[Any], str]]]] = {
    "max_torque_n_m": ("torque of hip-x / hip-y / knee, largest [N m]", _joints(".0f")),
    "usual_torque_n_m": ("… 99.9 % below [N m]", _joints(".0f")),
    "max_speed_rad_s": ("speed, largest [rad/s]", _joints(".1f")),
    "max_power_w": ("power, largest [W]", _joints(".0f")),
    "share_at_torque_limit": ("at the limit of torque", lambda share: f"{100 * share:.2f} %"),
    "least_to_joint_limit_deg": ("joints from the end of their range, least", lambda deg: f"{deg:.1f}°"),
    "energy_j": ("mechanical work", lambda joule: f"{joule:.0f} J"),
    "cost_of_transport": ("cost of transport", lambda cost: f"{cost:.2f}"),
    "min_support_margin_m": ("margin of the CoM, least", lambda m: f"{100 * m:.1f} cm"),
    "n_outside_support": ("… physics steps with a negative one", str),
    "min_zmp_margin_m": ("margin of the ZMP, least", lambda m: f"{100 * m:.1f} cm"),
    "min_capture_margin_m": ("margin of the capture point, least", lambda m: f"{100 * m:.1f} cm"),
    "max_push_moment_n_m": ("moment about the CoM in a push, largest", lambda moment: f"{moment:.1f} N m"),
    "touchdowns_per_footstep": ("touchdowns per footstep", lambda n: f"{n:.2f}"),
    "usual_landing_speed_m_s": ("landing speed, 99 % below", lambda speed: f"{speed:.2f} m/s"),
    "max_penetration_m": ("foot in the floor, deepest", lambda m: f"{1000 * m:.1f} mm"),
    "unexpected": ("contacts that no plan asked for", _unexpected),
}
"""Fields of a phase in the order of the table, each with its title and its format."""


def phases_table(report: dict[str, Any]) -> Table | None:
    """Return a table with a column for each phase that was measured; None if there is none."""
    phases = [phase for phase in PHASES if report.get(phase)]
    if not phases:
        return None
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    table.add_column("at every 2 ms")
    for phase in phases:
        table.add_column(phase)
    for field, (title, read) in PHASE_ROWS.items():
        values = [report[phase].get(field) for phase in phases]
        if any(value is not None for value in values):
            cells = ["-" if value is None else one_line(read(value)) for value in values]
            table.add_row(Text(title, style="dim"), *map(Text, cells))
    return table


def odd_numbers(report: dict[str, Any]) -> list[str]:
    """Return sentences about numbers of the phases that look wrong but are not."""
    phases = [report[phase] for phase in PHASES if report.get(phase)]
    said = []
    if any(phase.get("n_outside_support") for phase in phases) and report.get("reason") != "fell":
        said.append(
            "A negative margin of the CoM is no fall: the CoM was above no foothold for these steps, and the next foot "
            "caught it."
        )
    if any((phase.get("min_capture_margin_m") or 0.0) < 0.0 for phase in phases) and report.get("reason") != "fell":
        said.append(
            "A negative margin of the capture point is no fall either: left to itself the robot would have had to "
            "step, and its control brought it back."
        )
    return said
