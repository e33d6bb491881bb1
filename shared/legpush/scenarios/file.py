"""Reads scenario files, from TOML to a checked `Scenario`, and writes them."""

import re
import tomllib
from collections.abc import Mapping
from difflib import get_close_matches
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, Final

import msgspec
import tomli_w

from legpush.errors import ScenarioError
from legpush.files import new_file
from legpush.messages.codec import convert
from legpush.realism.settings import Realism
from legpush.scenarios.changes import override
from legpush.scenarios.checks import scenario_faults
from legpush.scenarios.grid import GRID_FIELDS, GridSource, frame_note, furnished, read_grid, take_grid
from legpush.scenarios.lines import Lines, lines_of, located_faults
from legpush.scenarios.maps.map_files import OccupancyMap, file_inside
from legpush.scenarios.schema_faults import schema_faults
from legpush.scene.names import PlannerName, Steering
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Scenario

SUFFIX: Final = ".toml"
_DEFAULT_ROBOT: Final[dict[str, Any]] = msgspec.to_builtins(RobotSpec())


def load_scenario(name_or_path: str | Path) -> Scenario:
    """Return a built-in scenario by its name, or the one in a file: a `Path`, or a text with `/` or `.toml` in it.

    A grid file that it names is read as well, so the record needs no other file.

    Raises:
        ScenarioError: The scenario cannot be used; names the file, the field, and what was expected there.
    """
    return load_with_map(name_or_path)[0]


def load_with_map(name_or_path: str | Path) -> tuple[Scenario, OccupancyMap | None]:
    """Return a scenario like `load_scenario`, and the map in its grid file; None if it names no grid file."""
    source = scenario_source(name_or_path)
    where = str(source)
    plain, lines = _read_toml(source)
    try:
        scenario, grid, occupancy = _read_tables(plain, source)
    except ScenarioError as error:
        faults = [text.removeprefix(f"{where}: ") for text in error.lines()]
        raise ScenarioError(*located_faults(faults, where, lines)) from error
    if faults := scenario_faults(scenario):
        note = frame_note(grid, occupancy)
        raise ScenarioError(*located_faults([f"{text}{note}" for text in faults], where, lines))
    return scenario, occupancy


def _read_tables(plain: dict[str, Any], source: Traversable) -> tuple[Scenario, GridSource | None, OccupancyMap | None]:
    """Return the record of the tables of a scenario file, and its map.

    Raises:
        ScenarioError: They are not those of a scenario.
    """
    where = str(source)
    grid = take_grid(plain, where)
    occupancy = None if grid is None else read_grid(grid, _folder(source), where)
    if occupancy is not None:
        plain["room"]["size_m"] = list(occupancy.size_m)
    if faults := schema_faults(plain, Scenario, convert, also={"room": GRID_FIELDS}):
        raise ScenarioError(*(f"{where}: {text}{_of_map(text, grid)}" for text in faults))
    scenario = convert(plain, Scenario)
    if grid is not None and occupancy is not None:
        scenario = furnished(scenario, grid, occupancy, where)
    return scenario, grid, occupancy


def _of_map(fault: str, grid: GridSource | None) -> str:
    """Return what to add to a fault of a field that comes from a map."""
    return f", from `{grid.grid_file}`" if grid is not None and fault.startswith("at `room.size_m") else ""


def dump_scenario(scenario: Scenario, *, whole_robot: bool = False) -> str:
    """Return the scenario as TOML; loading it gives an equal record.

    It has every field with a value, but of realism only what is stated, and of the robot only the numbers that differ
    from the defaults, unless `whole_robot`.
    """
    table = scenario_table(scenario)
    if whole_robot:
        table["robot"] = msgspec.to_builtins(scenario.robot)
    return tomli_w.dumps(_without_nothing(table))


def scenario_table(scenario: Scenario) -> dict[str, Any]:
    """Return the scenario as a table for a file: every field, but of robot and realism only what is not the default."""
    plain: dict[str, Any] = msgspec.to_builtins(scenario)
    del plain["robot"], plain["realism"]
    robot, realism = robot_table(scenario.robot), realism_table(scenario.realism)
    return plain | ({"realism": realism} if realism else {}) | ({"robot": robot} if robot else {})


def robot_table(robot: RobotSpec) -> dict[str, Any]:
    """Return what differs from the defaults of a robot, as a table for a file."""
    return _differing(msgspec.to_builtins(robot), _DEFAULT_ROBOT)


def realism_table(realism: Realism) -> dict[str, Any]:
    """Return what is stated of a realism, as a table for a file."""
    return _differing(msgspec.to_builtins(realism), msgspec.to_builtins(Realism()))


def resolve_scenario(
    scenario: str | Path | Scenario,
    *,
    planner: PlannerName | None = None,
    steering: Steering | None = None,
    turning_radius_m: float | None = None,
    changes: Mapping[str, Any] | None = None,
) -> Scenario:
    """Load a scenario and replace fields of it.

    Raises:
        ScenarioError: The scenario, or a new value, cannot be used.
    """
    replaced = {
        "planning.planner": planner,
        "planning.steering": steering,
        "planning.min_turning_radius_m": turning_radius_m,
        **(changes or {}),
    }
    loaded = scenario if isinstance(scenario, Scenario) else load_scenario(scenario)
    return override(loaded, {field: value for field, value in replaced.items() if value is not None})


def scenario_names() -> tuple[str, ...]:
    """Return the names of the built-in scenarios, sorted."""
    return tuple(sorted(Path(e.name).stem for e in _builtin_folder().iterdir() if e.name.endswith(SUFFIX)))


def scenario_source(name_or_path: str | Path) -> Traversable:
    """Return the file behind a name or path.

    Raises:
        ScenarioError: The name is unknown; lists the valid ones.
    """
    text = str(name_or_path)
    if isinstance(name_or_path, Path) or "/" in text or text.endswith(SUFFIX):
        return Path(name_or_path)
    names = scenario_names()
    if text not in names:
        nearest = get_close_matches(text, names, n=1)
        hint = f" (did you mean `{nearest[0]}`?)" if nearest else ""
        raise ScenarioError(
            f"Expected the name of a scenario ({', '.join(names)}) or the path of a {SUFFIX} file, got `{text}`{hint}"
        )
    return _builtin_folder() / f"{text}{SUFFIX}"


def copy_scenario(name: str, target: Path) -> tuple[Path, ...]:
    """Write a built-in scenario with its comments to `target`, and its grid file beside it; return the new files.

    Raises:
        ScenarioError: One of the files exists or cannot be written.
    """
    source = scenario_source(name)
    copies = {target: source.read_bytes()}
    grid_file = _read_toml(source)[0].get("room", {}).get("grid_file")
    if grid_file is not None:
        grid = file_inside(_folder(source), grid_file, f"{source}: at `room.grid_file`")
        copies[target.parent / grid_file] = grid.read_bytes()
    for path, content in copies.items():
        _write_new(path, content)
    return tuple(copies)


def write_scenario(scenario: Scenario, target: Path) -> Path:
    """Write every field to a new file, and return its path.

    Raises:
        ScenarioError: The file exists or cannot be written.
    """
    _write_new(target, dump_scenario(scenario).encode())
    return target


def _without_nothing(table: dict[str, Any]) -> dict[str, Any]:
    """Return a table without fields that are None, which TOML cannot express; None is their default."""
    return {
        name: _without_nothing(value) if isinstance(value, dict) else value
        for name, value in table.items()
        if value is not None
    }


def _differing(table: dict[str, Any], default: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of a table, and of the tables in it, whose values are not the default ones."""
    differing = {}
    for name, value in table.items():
        kept = _differing(value, default[name]) if isinstance(value, dict) else value
        if value != default[name]:
            differing[name] = kept
    return differing


def _write_new(path: Path, content: bytes) -> None:
    try:
        with new_file(path) as scratch:
            scratch.write_bytes(content)
    except OSError as error:
        raise ScenarioError(f"{path}: expected a new file in an existing folder ({error.strerror})") from error


def _read_toml(source: Traversable) -> tuple[dict[str, Any], Lines]:
    """Return the tables of a TOML file, and the lines of its keys."""
    try:
        text = source.read_text(encoding="utf-8")
        return tomllib.loads(text), lines_of(text)
    except OSError as error:
        raise ScenarioError(f"{source}: expected a readable scenario file ({error.strerror})") from error
    except UnicodeDecodeError as error:
        raise ScenarioError(f"{source}: expected UTF-8 text, got byte {error.start} that is not ({error})") from error
    except tomllib.TOMLDecodeError as error:
        line = re.search(r"\(at line (\d+)", str(error))
        raise ScenarioError(f"{source}{f':{line[1]}' if line else ''}: expected TOML ({error})") from error


def _folder(source: Traversable) -> Traversable:
    """Return the folder from which relative paths in a scenario file start."""
    return source.parent if isinstance(source, Path) else _builtin_folder()


def _builtin_folder() -> Traversable:
    """Return the folder of the packaged scenario files."""
    return files("legpush") / "scenarios"
