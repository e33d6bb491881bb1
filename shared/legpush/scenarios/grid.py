"""Makes rooms from a map in a file beside the scenario file, with walls as few rectangles."""

from importlib.resources.abc import Traversable
from typing import Annotated, Any, Final, Literal

import numpy as np
from msgspec import Meta, Struct, to_builtins
from msgspec.structs import fields

from legpush.arrays import Flags, Indices
from legpush.bounds import MAX_OBSTACLES, Resolution
from legpush.errors import MessageError, ScenarioError
from legpush.messages.codec import convert
from legpush.scenarios.maps.map_files import OccupancyMap, file_inside, read_cells
from legpush.scenarios.maps.map_formats import CELL_SUFFIXES, IMAGE_SUFFIXES, MAP_SERVER_SUFFIXES, FirstRow, suffix_of
from legpush.scene.scenario import Rectangle, Scenario
from legpush.schema_errors import explain


class CellSource(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The fields of `[room]` that replace its size and walls, for a map file that has only cells."""

    grid_file: Annotated[str, Meta(min_length=1)]
    """CSV file beside the scenario file, with one line per row and one number per cell, 0 free, 1 wall; or NumPy file
    of a two-dimensional array of the same numbers."""
    cell_m: Resolution
    """Side of a cell."""
    first_row: FirstRow
    """Place of the first row of the file: at the highest y, as MATLAB reads a map, or at y = 0."""


class MapSource(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The same fields for the YAML file of a ROS map, which has the size of a cell; its first row is the top one."""

    grid_file: Annotated[str, Meta(min_length=1)]
    frame: Literal["room", "map"] = "room"
    """Frame of poses and obstacles in the scenario file. `room`: from the lower left corner of the map, as everywhere
    in legpush. `map`: the map's own frame."""


GridSource = CellSource | MapSource
GRID_FIELDS: Final = tuple(dict.fromkeys(field.name for kind in (CellSource, MapSource) for field in fields(kind)))


def take_grid(plain: dict[str, Any], where: str) -> GridSource | None:
    """Take the fields of a `GridSource` out of the `room` table of a file; None if it has none of them.

    Raises:
        ScenarioError: A field is missing, wrong, or does not belong to this type of map file.
    """
    room = plain.get("room")
    if not isinstance(room, dict) or not room.keys() & set(GRID_FIELDS):
        return None
    taken = {key: room.pop(key) for key in GRID_FIELDS if key in room}
    if "grid_file" not in taken:
        raise ScenarioError(f"{where}: at `room.grid_file`: expected a value, got nothing, beside {', '.join(taken)}")
    name = str(taken["grid_file"])
    suffix = suffix_of(name)
    if suffix not in (*CELL_SUFFIXES, *MAP_SERVER_SUFFIXES):
        valid = ", ".join((*CELL_SUFFIXES, *MAP_SERVER_SUFFIXES))
        hint = " (for an image, name its YAML file)" if suffix in IMAGE_SUFFIXES else ""
        raise ScenarioError(f"{where}: at `room.grid_file`: expected a file that ends in {valid}, got '{name}'{hint}")
    kind: type[GridSource] = MapSource if suffix in MAP_SERVER_SUFFIXES else CellSource
    why = "which has it already" if kind is MapSource else "which has no frame of its own"
    for field in taken:
        if field not in {valid.name for valid in fields(kind)}:
            raise ScenarioError(f"{where}: at `room.{field}`: expected nothing beside `{name}`, {why}")
    if "size_m" in room:
        raise ScenarioError(f"{where}: at `room.size_m`: expected nothing, since `room.grid_file` has the size")
    try:
        return convert(taken, kind)
    except MessageError as error:
        raise ScenarioError(f"{where}: {explain(str(error), taken, kind, at='room')}") from error


def read_grid(grid: GridSource, folder: Traversable, where: str) -> OccupancyMap:
    """Return the map in the file, which lies in `folder` or below it.

    Raises:
        ScenarioError: The file cannot be used; names the file and the error.
    """
    file = file_inside(folder, grid.grid_file, f"{where}: at `room.grid_file`")
    if isinstance(grid, CellSource):
        return read_cells(file, grid.cell_m, grid.first_row)
    from legpush.scenarios.maps.map_server import read_map_server

    return read_map_server(folder, grid.grid_file)


def furnished(scenario: Scenario, grid: GridSource, occupancy: OccupancyMap, where: str) -> Scenario:
    """Return the scenario with the map's walls after its own obstacles, and everything in the frame of the room.

    Raises:
        ScenarioError: There are too many obstacles, or something is out of its bounds in the frame of the room.
    """
    listed, cells = scenario.room.obstacles, merged_cells(occupancy.occupied)
    if len(listed) + len(cells) > MAX_OBSTACLES:
        raise ScenarioError(
            f"{where}: at `room.grid_file`: expected at most {MAX_OBSTACLES} obstacles, got the cells of "
            f"`{grid.grid_file}` in {len(cells)} rectangles and {len(listed)} in `room.obstacles`: single cells that "
            "differ from those around them need a rectangle each"
        )
    plain = to_builtins(scenario)
    if isinstance(grid, MapSource) and grid.frame == "map":
        _move(plain, -occupancy.origin_m[0], -occupancy.origin_m[1])
    plain["room"]["obstacles"] += to_builtins(_rectangles(cells, occupancy.cell_m))
    try:
        return convert(plain, Scenario)
    except MessageError as error:
        raise ScenarioError(
            f"{where}: {explain(str(error), plain, Scenario)}, with the cells of `{grid.grid_file}` in "
            f"`room.obstacles[{len(listed)}]` and later ones"
        ) from error


def frame_note(grid: GridSource | None, occupancy: OccupancyMap | None) -> str:
    """Return what to add to an error about places in the room; empty unless the map has an origin of its own."""
    if not isinstance(grid, MapSource) or occupancy is None or occupancy.origin_m == (0.0, 0.0):
        return ""
    corner = f"the lower left corner of `{grid.grid_file}`, ({occupancy.origin_m[0]:g}, {occupancy.origin_m[1]:g})"
    if grid.frame == "map":
        return f" (places are counted from {corner} in the map's frame)"
    return f' (places are counted from {corner} in the map\'s frame, which `room.frame = "map"` counts in)'


def merged_rectangles(occupied: Flags, cell_m: float) -> tuple[Rectangle, ...]:
    """Return rectangles that cover exactly the occupied cells, (rows, columns), row 0 at y = 0, without overlapping."""
    return _rectangles(merged_cells(occupied), cell_m)


def merged_cells(occupied: Flags) -> Indices:
    """Return the same rectangles in cells, (n, 4): first row, row after the last, first column, column after the last.

    Cells side by side in a row make a run. Equal runs in adjacent rows make a rectangle.
    """
    n_rows, n_columns = occupied.shape
    padded = np.zeros((n_rows, n_columns + 2), dtype=np.int8)
    padded[:, 1:-1] = occupied
    steps = np.diff(padded, axis=1)
    rows, first = np.nonzero(steps == 1)
    last = np.nonzero(steps == -1)[1]
    order = np.lexsort((rows, last, first))
    rows, first, last = rows[order], first[order], last[order]
    goes_on = (np.diff(rows) == 1) & (np.diff(first) == 0) & (np.diff(last) == 0)
    begins = np.concatenate([[True], ~goes_on])[: len(rows)]
    ends = np.concatenate([~goes_on, [True]])[: len(rows)]
    merged = np.stack([rows[begins], rows[ends] + 1, first[begins], last[begins]], axis=-1)
    return merged[np.lexsort((merged[:, 2], merged[:, 0], merged[:, 1]))]


def _rectangles(cells: Indices, cell_m: float) -> tuple[Rectangle, ...]:
    return tuple(
        Rectangle(x_min_m=first * cell_m, x_max_m=last * cell_m, y_min_m=first_row * cell_m, y_max_m=after_row * cell_m)
        for first_row, after_row, first, last in cells.tolist()
    )


def _move(plain: dict[str, Any], x_m: float, y_m: float) -> None:
    """Move start, box, goal and obstacles of a scenario, as plain values, along x and y."""
    for pose in (plain["start"], plain["box"]["pose"], plain["goal"]["pose"]):
        pose["x_m"] += x_m
        pose["y_m"] += y_m
    for obstacle in plain["room"]["obstacles"]:
        for end in ("min", "max"):
            obstacle[f"x_{end}_m"] += x_m
            obstacle[f"y_{end}_m"] += y_m
