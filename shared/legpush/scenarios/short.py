"""A scenario as a short TOML file: the fields that have no default, and those with another value than it."""

from typing import Any, Final

import msgspec
import tomli_w

from legpush.scene.scenario import Scenario

NOTE: Final = "# Fields with their default values are left out, and so are comments.\n"


def short_scenario(scenario: Scenario) -> str:
    """Return the scenario as TOML without default values; loading it gives an equal record."""
    return NOTE + tomli_w.dumps(_short(scenario))


def _short(record: msgspec.Struct) -> dict[str, Any]:
    """The fields of a record that have to be written, as plain data."""
    kept: dict[str, Any] = {}
    if (tag := type(record).__struct_config__.tag) is not None:
        kept[str(type(record).__struct_config__.tag_field)] = tag
    for field in msgspec.structs.fields(record):
        value = getattr(record, field.name)
        if field.required or value != field.default:
            kept[field.name] = _plain(value)
    return kept


def _plain(value: Any) -> Any:
    if isinstance(value, msgspec.Struct):
        return _short(value)
    if isinstance(value, tuple):
        return [_plain(each) for each in value]
    return value
