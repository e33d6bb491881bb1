"""Options of `legpush scenarios` and `legpush examples`, and how every command takes a scenario."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from legpush.arguments import USUAL_OUTPUT, Flag, OutputOptions, Positional, Repeated, arg
from legpush.errors import ConfigError
from legpush.fields import Seed, require
from legpush.options.checks import require_writable_file
from legpush.scenarios.random_room import RandomRoom

if TYPE_CHECKING:
    from legpush.scene.scenario import Scenario

ScenarioName = Annotated[str, arg("NAME|FILE")]
"""A built-in scenario, or the path of a scenario file."""
Changes = Annotated[Repeated[str], arg("FIELD=VALUE", name="set")]
"""Other values of fields of the scenario."""


def changed_scenario(name: str, changes: tuple[str, ...]) -> "Scenario":
    """Load a scenario, and change what `--set` says.

    Raises:
        ConfigError: A change has another form than `FIELD=VALUE`.
        ScenarioError: The scenario, a field or a value cannot be used.
    """
    from legpush.scenarios.file import load_scenario

    return with_changes(load_scenario(name), changes)


def with_changes(scenario: "Scenario", changes: tuple[str, ...]) -> "Scenario":
    """Change what `--set` says of a scenario.

    Raises:
        ConfigError: A change has another form than `FIELD=VALUE`.
        ScenarioError: A field or a value cannot be used.
    """
    from legpush.scenarios.changes import override, parse_changes

    given = parse_changes(changes)
    return override(scenario, given, "--set") if given else scenario


@dataclass(frozen=True, kw_only=True)
class ListScenarios:
    """List the built-in scenarios."""

    output: OutputOptions = USUAL_OUTPUT


@dataclass(frozen=True, kw_only=True)
class ShowScenario:
    """Check a scenario and print it; comments of its file are not kept."""

    scenario: Positional[ScenarioName]
    """A built-in scenario or the path of a scenario file."""
    changes: Changes = ()
    """Change a field, such as box.mass_kg=0.9; may be given several times."""
    defaults: Flag = False
    """Print fields with their default values, too."""

    output: OutputOptions = USUAL_OUTPUT


@dataclass(frozen=True, kw_only=True)
class CopyScenario:
    """Copy a built-in scenario, with its comments, to a new file for you to edit."""

    name: Positional[Annotated[str, arg("NAME")]]
    """A built-in scenario."""
    file: Positional[Annotated[Path, arg("FILE")]]
    """The new file."""

    output: OutputOptions = USUAL_OUTPUT


@dataclass(frozen=True, kw_only=True)
class RandomScenario(RandomRoom):
    """Draw a room with obstacles, start, box and goal from a seed, and write it to a new file.

    A planner checks that the robot can walk and push there. If not, another room is drawn.
    """

    file: Positional[Annotated[Path, arg("FILE")]]
    """The new file."""
    seed: Annotated[int, arg("N")] = 0
    """Seed of the room. Equal seeds give equal rooms."""

    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        super().__post_init__()
        require(Seed, self.seed, "--seed")
        if self.file.exists() or not self.file.parent.is_dir():
            raise ConfigError(f"{self.file}: expected a new file in an existing folder")
        require_writable_file(self.file, "FILE")


@dataclass(frozen=True, kw_only=True)
class ListExamples:
    """List the examples: planners, rooms, terms of a task, and programs that run missions in Python."""

    output: OutputOptions = USUAL_OUTPUT


@dataclass(frozen=True, kw_only=True)
class CopyExamples:
    """Copy the examples to a new folder for you to run and edit."""

    folder: Positional[Annotated[Path, arg("DIR")]] = Path("examples")
    """The new folder."""
    output: OutputOptions = USUAL_OUTPUT
