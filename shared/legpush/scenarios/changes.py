"""Changes of a scenario: other values of its fields, from a mapping or from texts such as `box.mass_kg=0.9`."""

import json
import tomllib
from collections.abc import Iterable, Mapping
from functools import reduce
from operator import getitem
from typing import Any

import msgspec

from legpush.errors import ConfigError, MessageError, ScenarioError
from legpush.messages.codec import convert
from legpush.scenarios.checks import check_scenario
from legpush.scene.scenario import PoseDeg, Scenario
from legpush.scene.station import at_station, station
from legpush.schema_errors import explain

COMMAND_LINE = "command line"


def parse_changes(texts: Iterable[str], flag: str = "--set") -> dict[str, Any]:
    """Return the changes of texts `FIELD=VALUE`, by the paths of their fields.

    Raises:
        ConfigError: A text has another form, or a field is given twice.
    """
    changes: dict[str, Any] = {}
    for text in texts:
        field, equals, value = (part.strip() for part in text.partition("="))
        if not (field and equals and value):
            raise ConfigError(f"Expected FIELD=VALUE for {flag}, such as box.mass_kg=0.9, got {text!r}")
        if field in changes:
            raise ConfigError(f"Expected each field once for {flag}, got {field} twice")
        changes[field] = parse_value(value)
    return changes


def change_texts(changes: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the texts of which `parse_changes` makes these changes."""
    return tuple(f"{path}={_as_toml(value)}" for path, value in changes.items())


def _as_toml(value: Any) -> str:
    """Return a value as TOML on one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_as_toml(name)} = {_as_toml(each)}" for name, each in value.items()) + "}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_as_toml, value))}]"
    return json.dumps(value, ensure_ascii=False)


def parse_value(text: str) -> Any:
    """Return the value of a text: as in a TOML file, several numbers joined by `x`, or a word without quotes."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        pass
    try:
        numbers = [float(part) for part in text.split("x")]
    except ValueError:
        return text
    return numbers if len(numbers) > 1 else numbers[0]


def override(scenario: Scenario, changes: Mapping[str, Any], where: str = COMMAND_LINE) -> Scenario:
    """Return the scenario with other values at paths such as `box.mass_kg`.

    A robot that starts at its station behind the box stands at the new one if box or robot have another size.

    Raises:
        ScenarioError: A path or value cannot be used; `where` says where it comes from.
    """
    changed = change_fields(scenario, changes, where)
    if _station_m(changed) != _station_m(scenario) and _ready(scenario):
        place = station(changed.robot, changed.box, changed.box.pose.pose())
        start = PoseDeg(x_m=place.x_m, y_m=place.y_m, yaw_deg=changed.box.pose.yaw_deg)
        changed = msgspec.structs.replace(changed, start=start)
    check_scenario(changed, where)
    return changed


def change_fields(scenario: Scenario, changes: Mapping[str, Any], where: str = COMMAND_LINE) -> Scenario:
    """Return the scenario with other values, without the check that it can be carried out.

    Raises:
        ScenarioError: A path or value cannot be used.
    """
    plain = msgspec.to_builtins(scenario)
    for path, value in changes.items():
        *tables, field = path.split(".")
        try:
            reduce(getitem, tables, plain)[field] = value
        except (KeyError, TypeError) as error:
            raise ScenarioError(f"{where}: expected the path of a field, such as box.mass_kg, got {path}") from error
    try:
        return convert(plain, Scenario)
    except MessageError as error:
        raise ScenarioError(f"{where}: {explain(str(error), plain, Scenario)}") from error


def _station_m(scenario: Scenario) -> tuple[tuple[float, ...], float]:
    """What the station follows from, besides the pose of the box."""
    return scenario.box.size_m, scenario.robot.station_m


def _ready(scenario: Scenario) -> bool:
    """Whether the robot starts at its station behind the box."""
    return at_station(scenario.robot, scenario.start.pose(), scenario.box, scenario.box.pose.pose())
