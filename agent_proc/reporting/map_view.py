"""Reads what `legpush map` shows: the cells of a map file, or the grid that the planner gets for a scenario."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from legpush.arrays import Flags
from legpush.bounds import MAX_OBSTACLES
from legpush.options.maps import MapOptions
from legpush.options.scenarios import with_changes
from legpush.scenarios.file import load_with_map
from legpush.scenarios.grid import merged_cells
from legpush.scenarios.maps.map_files import OccupancyMap, read_cells
from legpush.scenarios.maps.map_formats import CELL_SUFFIXES, MAP_SERVER_SUFFIXES, suffix_of
from legpush.scene.occupancy import occupancy_grid
from legpush.scene.scenario import Scenario


@dataclass(frozen=True, kw_only=True, eq=False)
class MapView:
    """A map in the frame of its room."""

    name: str
    occupied: Flags
    """(rows, columns), row 0 at y = 0."""
    resolution_m: float
    """Side of a cell."""
    size_m: tuple[float, float]
    n_walls: int
    """Number of rectangles that the occupied cells are merged into."""
    source: OccupancyMap | None
    """The map file; None for a scenario without one."""
    scenario: Scenario | None = None

    @property
    def origin_m(self) -> tuple[float, float]:
        """Lower left corner of the map in the file's own frame."""
        return (0.0, 0.0) if self.source is None else self.source.origin_m

    def lines(self) -> list[str]:
        """Describe the map in lines of text."""
        n_rows, n_columns = self.occupied.shape
        too_many = f": more than the {MAX_OBSTACLES} of a room" if self.n_walls > MAX_OBSTACLES else ""
        walls = "rectangle" if self.n_walls == 1 else "rectangles"
        x_m, y_m = self.origin_m
        lines = [
            f"size        {self.size_m[0]:g} x {self.size_m[1]:g} m",
            f"cells       {n_columns} x {n_rows} of {self.resolution_m:g} m",
            "origin      (0, 0) is the lower left corner, x to the right, y up",
            f"occupied    {self.occupied.mean():.1%} of the cells, in {self.n_walls} {walls}{too_many}",
        ]
        if self.origin_m != (0.0, 0.0):
            lines.insert(3, f"map frame   the room's plus ({x_m:g}, {y_m:g}): there the corner is ({x_m:g}, {y_m:g})")
        if self.source is not None and self.source.unknown.any():
            lines.append(f"unknown     {self.source.unknown.mean():.1%} of the file's cells, which count as occupied")
        return lines


def read_view(options: MapOptions) -> MapView:
    """Read the map that the options name.

    Raises:
        LegpushError: The map cannot be used; the message names the file and the reason.
    """
    path, suffix = Path(options.file), suffix_of(options.file)
    if suffix in CELL_SUFFIXES and options.cell_m is not None and options.first_row is not None:
        return _view_of_file(path.name, read_cells(path, options.cell_m, options.first_row))
    if suffix in MAP_SERVER_SUFFIXES:
        from legpush.scenarios.maps.map_server import read_map_server

        return _view_of_file(path.name, read_map_server(path.parent, path.name))
    scenario, source = load_with_map(options.file)
    scenario = with_changes(scenario, options.changes)
    grid = occupancy_grid(scenario.room)
    cells = np.frombuffer(grid.cells, dtype=np.bool_).reshape(grid.n_rows, grid.n_columns)
    return MapView(
        name=scenario.name,
        occupied=cells,
        resolution_m=grid.resolution_m,
        size_m=scenario.room.size_m,
        n_walls=len(scenario.room.obstacles),
        source=source,
        scenario=scenario,
    )


def _view_of_file(name: str, source: OccupancyMap) -> MapView:
    return MapView(
        name=name,
        occupied=source.occupied,
        resolution_m=source.cell_m,
        size_m=source.size_m,
        n_walls=len(merged_cells(source.occupied)),
        source=source,
    )
