"""Reads task files: TOML with the fields of a `TaskConfig`, its scenario by name, and the tolerances of the goal."""

import tomllib
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, Final

from msgspec import Struct
from msgspec.structs import replace

from agent_proc.task.config import ENDINGS, TaskConfig
from agent_proc.task.former import current_tables, is_former
from agent_proc.task.term import ObservationTerm, RewardTerm
from agent_proc.task.terms import complete
from legpush.bounds import AngleTolerance, Length
from legpush.errors import ConfigError, MessageError
from legpush.messages.codec import convert
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import Scenario
from legpush.schema_errors import explain

SUFFIX: Final = ".toml"
DEFAULT_TASK: Final = "tuned"
DEFAULT_SCENARIO: Final = "push"
SCENARIO: Final = "scenario"
TOLERANCE: Final = "tolerance"
"""Keys of a task file that its record has not, or has as something else."""


class Tolerances(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Tolerances of the goal; None keeps those of the scenario."""

    position_m: Length | None = None
    angle_deg: AngleTolerance | None = None


def task_names() -> tuple[str, ...]:
    """Names of the built-in tasks, sorted."""
    folder = files("agent_proc.task") / "builtin"
    return tuple(sorted(Path(e.name).stem for e in folder.iterdir() if e.name.endswith(SUFFIX)))


def is_path(name_or_path: str) -> bool:
    """Whether a text is the path of a file: one with `/`, or at its end `.toml`."""
    return "/" in name_or_path or name_or_path.endswith(SUFFIX)


def load_task(name_or_path: str = DEFAULT_TASK, scenario: Scenario | None = None, **changes: Any) -> TaskConfig:
    """Load a built-in task by its name, or a file; `scenario` replaces that of the file, `changes` other fields.

    The record has every setting of every term.

    Raises:
        ConfigError: There is no such task, or it cannot be used; the message names file and field.
        PluginError: A term of another package cannot be imported.
        ScenarioError: Its scenario cannot be used.
    """
    source = _source(name_or_path)
    plain = _read(source)
    tolerances = _converted(plain.pop(TOLERANCE, {}), Tolerances, str(source), TOLERANCE)
    named = plain.pop(SCENARIO, DEFAULT_SCENARIO)
    if scenario is None:
        scenario = load_scenario(_named(named, source))
    plain[SCENARIO] = _with_tolerances(scenario, tolerances)
    task: TaskConfig = _converted(plain, TaskConfig, str(source))
    drawn = changes.pop("domain", None)
    if changes or drawn:
        domain = {**plain.get("domain", {}), **(drawn or {})}
        task = _converted({**plain, **changes, "domain": domain}, TaskConfig, "settings of the task")
    return _completed(task)


def scenario_of_task(name_or_path: str = DEFAULT_TASK) -> str:
    """Return the name or the path of the scenario that a task names.

    Raises:
        ConfigError: There is no such task, or it cannot be read.
    """
    source = _source(name_or_path)
    return str(_named(_read(source).get(SCENARIO, DEFAULT_SCENARIO), source))


def read_task(plain: object, where: str) -> TaskConfig:
    """The task in the table of a card or of a training, called `where`; also one of an earlier version of legpush.

    Raises:
        ConfigError: A field is wrong; the message names it.
        PluginError: A term of another package cannot be imported.
    """
    if not isinstance(plain, dict):
        raise ConfigError(f"{where}: expected the table of a task, got {plain!r}")
    task: TaskConfig = _converted(current_tables(plain, where) if is_former(plain) else plain, TaskConfig, where)
    return _completed(task)


def _source(name_or_path: str) -> Traversable:
    if is_path(name_or_path):
        return Path(name_or_path)
    if name_or_path not in task_names():
        raise ConfigError(
            f"Expected the name of a task ({', '.join(task_names())}) or the path of a {SUFFIX} file, got "
            f"{name_or_path!r}"
        )
    return files("agent_proc.task") / "builtin" / f"{name_or_path}{SUFFIX}"


def _read(source: Traversable) -> dict[str, Any]:
    try:
        return tomllib.loads(source.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ConfigError(f"{source}: expected a task in TOML ({error})") from error


def _named(name: object, source: Traversable) -> str | Path:
    """The scenario that a task file names; a path is seen from the folder of the file."""
    if not isinstance(name, str):
        raise ConfigError(f"{source}: at `{SCENARIO}`: expected the name or the path of a scenario, got {name!r}")
    return Path(source.parent) / name if is_path(name) and isinstance(source, Path) else name


def _with_tolerances(scenario: Scenario, tolerances: Tolerances) -> Scenario:
    goal = scenario.goal
    if tolerances.position_m is not None:
        goal = replace(goal, position_tolerance_m=tolerances.position_m)
    if tolerances.angle_deg is not None:
        goal = replace(goal, angle_tolerance_deg=tolerances.angle_deg)
    return replace(scenario, goal=goal)


def _completed(task: TaskConfig) -> TaskConfig:
    """The same task with every setting of every term."""
    return replace(
        task,
        observation=complete(task.observation, (ObservationTerm,), "observation"),
        reward=complete(task.reward, (RewardTerm,), "reward"),
        ending=complete(task.ending, ENDINGS, "ending"),
    )


def _converted(plain: Any, kind: type[Struct], where: str, at: str = "") -> Any:
    try:
        return convert(plain, kind)
    except MessageError as error:
        also = {"": (TOLERANCE,)} if kind is TaskConfig else None
        raise ConfigError(f"{where}: {explain(str(error), plain, kind, at=at, also=also)}") from error
    except ConfigError as error:
        raise ConfigError(f"{where}: {error}") from error
