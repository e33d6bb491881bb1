"""What `legpush calibrate` prints of the maps that it measured."""

from collections.abc import Iterable
from math import degrees

from rich.console import Console
from rich.table import Table
from rich.text import Text

from agent_proc.map_world.response_map import ResponseMap
from agent_proc.map_world.surface import Triple
from agent_proc.push_model.map import PushMap


def show_push_map(push_map: PushMap, console: Console) -> None:
    """Print mean and standard deviation of each effect, and the circles."""
    table = Table(box=None, padding=(0, 2, 0, 0))
    for title in ("face", "leg", "w1 = w2", "depth [cm]", "forward [cm]", "left [cm]", "turn [deg]", "n"):
        table.add_column(Text(title), justify="left" if title in ("face", "leg") else "right", no_wrap=True)
    for e in push_map.effects:
        table.add_row(
            e.face,
            e.leg,
            f"{e.w1:g}",
            f"{100 * e.depth_m:g}",
            f"{100 * e.forward_m:.2f} ± {100 * e.forward_sd_m:.2f}",
            f"{100 * e.left_m:+.2f} ± {100 * e.left_sd_m:.2f}",
            f"{e.turn_deg:+.2f} ± {e.turn_sd_deg:.2f}",
            str(e.n),
        )
    console.print(table)
    for circle in push_map.circles:
        console.print(
            Text(
                f"{circle.face} face, one foot: turns on a radius of {circle.radius_m.text('.3f')} m about a point "
                f"beside one {circle.axle_m.text('.3f')} m behind the centre"
            ),
            soft_wrap=True,
        )


def show_response_map(response_map: ResponseMap, console: Console) -> None:
    """Print the mean displacement and the scatter of each face by depth, and how well the surface fits."""
    table = Table(box=None, padding=(0, 2, 0, 0))
    for title in ("face", "depth [cm]", "forward [mm]", "left [mm]", "turn [deg]", "n"):
        table.add_column(Text(title), justify="left" if title == "face" else "right", no_wrap=True)
    for surface in response_map.surfaces:
        rows = zip(surface.depth_m, surface.forward_m, surface.left_m, surface.turn_rad, strict=True)
        means = {depth_m: triple for depth_m, *triple in rows}
        for part in surface.residuals:
            forward, left, turn = _shown(means[part.to_depth_m])
            sd = _shown(part.covariance.diagonal() ** 0.5)
            table.add_row(
                surface.face,
                f"{100 * part.to_depth_m:g}",
                *(f"{mean:+.2f} ± {scatter:.2f}" for mean, scatter in zip((forward, left, turn), sd, strict=True)),
                str(part.n),
            )
    console.print(table)
    for surface in response_map.surfaces:
        quality = surface.quality
        names = ("forward", "left", "turn")
        errors = zip(names, quality.r_squared, _shown(quality.cross_validated_rmse), (" mm", " mm", "°"), strict=True)
        words = "; ".join(f"{name}: R² {r2:.4f}, error {error:.2f}{unit}" for name, r2, error, unit in errors)
        console.print(Text(f"{surface.face} face, {quality.n} pushes, cross-validated: {words}"), soft_wrap=True)


def _shown(values: Iterable[float]) -> Triple:
    """Millimetres and degrees of metres and radians."""
    forward_m, left_m, turn_rad = values
    return 1000 * forward_m, 1000 * left_m, degrees(turn_rad)
