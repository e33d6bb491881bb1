"""What `legpush scenarios random` can be told."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated

import tyro

from legpush.errors import ConfigError
from legpush.scenarios.random_room import RandomRoom


@dataclass(frozen=True, kw_only=True)
class RandomScenario(RandomRoom):
    """Draw a room with obstacles, start, box and goal from a seed, and write it to a new file.

    A planner is started and asked whether there is a way to walk and to push; a room without is drawn anew.
    """

    file: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="FILE")]
    """The new file."""
    seed: Annotated[int, tyro.conf.arg(metavar="N")] = 0
    """Equal seeds give equal rooms."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 <= self.seed < 2**32:
            raise ConfigError(f"Expected a seed from 0 to {2**32 - 1} for --seed, got {self.seed}")
        if self.file.exists() or not self.file.parent.is_dir():
            raise ConfigError(f"{self.file}: expected a new file in an existing folder")

    def flags(self) -> list[str]:
        """The same as a command line."""
        words = []
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name != "file":
                values = value if isinstance(value, tuple) else (value,)
                words += [f"--{field.name.replace('_', '-')}", *map(str, values)]
        return [*words, str(self.file)]
