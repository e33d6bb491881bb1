"""Search spaces as TOML: which fields of a training profile are searched, and among which values."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, Final

import msgspec
from msgspec import Struct

from agent_proc.profiles.profile import AnyProfile, read_profile
from legpush.errors import ConfigError
from legpush.schema_errors import explain

SUFFIX: Final = ".toml"
Value = bool | int | float | str | list[Any]


class Parameter(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The values of one field: an interval, or a list of choices."""

    low: int | float | None = None
    """Whole numbers are searched if both ends are whole."""
    high: int | float | None = None
    log: bool = False
    """Whether the logarithm is searched evenly."""
    choices: tuple[Value, ...] | None = None

    def fault(self) -> str | None:
        """What is wrong with it; None if nothing is."""
        if self.choices is not None:
            if self.low is not None or self.high is not None or self.log:
                return "expected either low and high or choices, got both"
            return None if len(self.choices) > 1 else "expected at least two choices"
        if self.low is None or self.high is None:
            return "expected low and high, or choices"
        if not self.low < self.high:
            return f"expected low < high, got {self.low} and {self.high}"
        return "expected low above 0 with log" if self.log and self.low <= 0 else None

    def examples(self) -> tuple[Value, ...]:
        """The ends of the interval, or all choices."""
        if self.choices is not None:
            return self.choices
        assert self.low is not None  # noqa: S101 - `fault` has looked
        assert self.high is not None  # noqa: S101
        return (self.low, self.high)

    def holds(self, value: object) -> bool:
        """Whether this value is in the space."""
        if self.choices is not None:
            return value in self.choices
        return (
            isinstance(value, int | float)
            and self.low is not None
            and self.high is not None
            and (self.low <= value <= self.high)
        )


class SpaceFile(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The content of the file of a search space."""

    description: str = ""
    search: dict[str, Parameter]
    """By the path of the field in a training profile, such as `settings.learning_rate`."""


@dataclass(frozen=True, kw_only=True)
class Space:
    """A search space and the profile that its values replace fields of."""

    parameters: Mapping[str, Parameter]
    profile: AnyProfile

    def profile_with(self, values: Mapping[str, Value], **fields: Any) -> AnyProfile:
        """The profile with these values of searched fields, and other top-level fields.

        Raises:
            ConfigError: The profile cannot have such a value.
        """
        plain = msgspec.to_builtins(self.profile)
        for path, value in values.items():
            *above, name = path.split(".")
            table = plain
            for each in above:
                table = table[each]
            table[name] = value
        return read_profile({**plain, **fields}, "the profile with values of the search space")

    def values_of_profile(self) -> dict[str, Value] | None:
        """The values that the profile has itself; None if one of them is not in the space."""
        plain = msgspec.to_builtins(self.profile)
        found = {path: _at(plain, path) for path in self.parameters}
        found = {path: list(value) if isinstance(value, tuple) else value for path, value in found.items()}
        return found if all(self.parameters[path].holds(value) for path, value in found.items()) else None


def space_names() -> tuple[str, ...]:
    """Names of the built-in spaces, sorted."""
    return tuple(sorted(Path(each.name).stem for each in _folder().iterdir() if each.name.endswith(SUFFIX)))


def load_space(name_or_path: str | None, profile: AnyProfile) -> Space:
    """Load a built-in space by its name, or a file; None is that of the algorithm of the profile.

    Raises:
        ConfigError: There is no such space, or a field or a value of it does not fit the profile.
    """
    name = name_or_path or profile.algorithm
    source: Traversable
    if "/" in name or name.endswith(SUFFIX):
        source = Path(name)
    elif name in space_names():
        source = _folder() / f"{name}{SUFFIX}"
    else:
        raise ConfigError(
            f"Expected the name of a search space ({', '.join(space_names())}) or the path of a {SUFFIX} file for "
            f"--space, got {name!r}"
        )
    try:
        plain = tomllib.loads(source.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ConfigError(f"{source}: expected a search space in TOML ({error})") from error
    try:
        file = msgspec.convert(plain, SpaceFile)
    except msgspec.ValidationError as error:
        raise ConfigError(f"{source}: {explain(str(error), plain, SpaceFile)}") from error
    space = Space(parameters=file.search, profile=profile)
    _check(space, str(source))
    return space


def _check(space: Space, where: str) -> None:
    """Check every field and the ends or choices of each.

    Raises:
        ConfigError: The profile has no such field, or not such a value.
    """
    if not space.parameters:
        raise ConfigError(f"{where}: at `search`: expected fields of a training profile, got none")
    plain = msgspec.to_builtins(space.profile)
    for path, parameter in space.parameters.items():
        here = f"{where}: at `search.{path}`"
        if fault := parameter.fault():
            raise ConfigError(f"{here}: {fault}")
        try:
            _at(plain, path)
        except (KeyError, TypeError) as error:
            raise ConfigError(f"{here}: expected a field of the profile among {', '.join(_paths(plain))}") from error
        for value in parameter.examples():
            try:
                space.profile_with({path: value})
            except ConfigError as error:
                raise ConfigError(f"{here}: {error}") from error


def _folder() -> Traversable:
    return files("agent_proc.studies.tuning") / "spaces"


def _at(plain: Mapping[str, Any], path: str) -> Any:
    found: Any = plain
    for name in path.split("."):
        found = found[name]
    return found


def _paths(plain: Mapping[str, Any], above: str = "") -> list[str]:
    """Paths of all fields that are no tables."""
    found: list[str] = []
    for name, value in plain.items():
        found += _paths(value, f"{above}{name}.") if isinstance(value, Mapping) else [f"{above}{name}"]
    return found
