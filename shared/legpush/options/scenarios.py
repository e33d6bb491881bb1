"""Options of `legpush scenarios`."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated

import tyro

from legpush.errors import ConfigError
from legpush.fields import Seed, require
from legpush.options.checks import require_writable_file
from legpush.scenarios.random_room import RandomRoom


@dataclass(frozen=True)
class ListScenarios:
    """List the built-in scenarios."""


@dataclass(frozen=True)
class ShowScenario:
    """Check a scenario and print it; comments of its file are not kept."""

    scenario: Annotated[str, tyro.conf.arg(metavar="NAME|FILE")]
    """A built-in scenario or the path of a scenario file."""
    defaults: Annotated[bool, tyro.conf.arg(name="defaults")] = False
    """Print fields with their default values, too."""


@dataclass(frozen=True)
class CopyScenario:
    """Copy a built-in scenario, with its comments, to a new file for you to edit."""

    name: Annotated[str, tyro.conf.arg(metavar="NAME")]
    """A built-in scenario."""
    file: Annotated[Path, tyro.conf.arg(metavar="FILE")]
    """The new file."""


@dataclass(frozen=True, kw_only=True)
class RandomScenario(RandomRoom):
    """Draw a room with obstacles, start, box and goal from a seed, and write it to a new file.

    A planner checks that the robot can walk and push there. If not, another room is drawn.
    """

    file: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="FILE")]
    """The new file."""
    seed: Annotated[int, tyro.conf.arg(metavar="N")] = 0
    """Equal seeds give equal rooms."""

    def __post_init__(self) -> None:
        super().__post_init__()
        require(Seed, self.seed, "--seed")
        if self.file.exists() or not self.file.parent.is_dir():
            raise ConfigError(f"{self.file}: expected a new file in an existing folder")
        require_writable_file(self.file, "FILE")

    def flags(self) -> list[str]:
        """Return these options as a command line."""
        words = []
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name != "file":
                values = value if isinstance(value, tuple) else (value,)
                words += [f"--{field.name.replace('_', '-')}", *map(str, values)]
        return [*words, str(self.file)]


@dataclass(frozen=True)
class Scenarios:
    """List, show, copy or draw scenarios."""

    action: (
        Annotated[ListScenarios, tyro.conf.subcommand("list")]
        | Annotated[ShowScenario, tyro.conf.subcommand("show")]
        | Annotated[CopyScenario, tyro.conf.subcommand("copy")]
        | Annotated[RandomScenario, tyro.conf.subcommand("random")]
    )
