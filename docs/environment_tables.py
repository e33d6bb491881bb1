"""The tables of `environment.md`: the environments by their ids, and what each task sees, does, earns and ends by."""

from collections.abc import Mapping

from msgspec import UNSET, Struct
from msgspec.structs import asdict

import legpush.gym
from agent_proc.task.config import TaskConfig
from agent_proc.task.domain import OFFSETS, Domain
from agent_proc.task.elements import Element, action_elements, observation_elements
from agent_proc.task.file import load_task
from agent_proc.task.rooms import RoomFields
from agent_proc.task.terms import ENDING, REWARD, TERM, Table

INFO = {
    "reward_terms": "the terms of the reward by their names, after each step; their sum is the reward",
    "is_success": "whether the episode ended with `success`, after each step",
    "ending": "why the episode ended, after its last step",
    "reason": "why the mission ended, after the last step of an episode that is a mission",
    "fell": "whether the robot fell",
    "position_error_m": "distance of the box from its goal, in m",
    "angle_error_deg": "angle between the headings of box and goal, in degrees, without sign",
    "scenario_seed": "the seed of the offsets of start and box, and of a random room, after a reset",
}


ALWAYS = "In every task; `ending` is `fell`, `astray` or `refused`."


def environment_parts() -> dict[str, str]:
    """The generated parts of `environment.md`."""
    return {"environments": _ids(), "environment_tasks": _tasks(), "environment_info": _info()}


def _ids() -> str:
    lines = ["| id | task | observation | action | `max_episode_steps` |", "| --- | --- | --- | --- | --- |"]
    for name, row in legpush.gym.ENVIRONMENTS.items():
        task = load_task(row.task)
        seen, done = len(observation_elements(task)), len(action_elements(task))
        action = f"{done} numbers in [-1, 1]" if task.action_form == "continuous" else f"{done} integers, a grid"
        lines.append(f"| `{name}` | `{row.task}` | {seen} numbers | {action} | {row.max_episode_steps} |")
    return "\n".join([*lines, ""])


def _tasks() -> str:
    return "\n".join(
        part for name, row in legpush.gym.ENVIRONMENTS.items() for part in _task(name, load_task(row.task))
    )


def _task(name: str, task: TaskConfig) -> list[str]:
    """The section about one environment."""
    if task.random_room is not UNSET:
        return _mission(name, task, task.random_room)
    offsets = task.scenario.randomization
    start, box = task.domain.start_xy_m, task.domain.box_xy_m
    start_m = offsets.start_xy_m if start is None else start
    box_m = offsets.box_xy_m if box is None else box
    start_deg = offsets.start_yaw_deg if task.domain.start_yaw_deg is None else task.domain.start_yaw_deg
    box_deg = offsets.box_yaw_deg if task.domain.box_yaw_deg is None else task.domain.box_yaw_deg
    goal = task.scenario.goal
    return [
        *_head(name, task),
        "| an episode ends by | settings | meaning |",
        "| --- | --- | --- |",
        *(
            f"| `{name}` | {_settings(table)} | {_meaning(ENDING, name, table)} |"
            for name, table in task.ending.items()
        ),
        f"| a fall, a box out of reach, or a push that is refused | - | {ALWAYS} |",
        "",
        f"Success: the box is within {100 * goal.position_tolerance_m:g} cm and {goal.angle_tolerance_deg:g}° of its "
        f"goal. Starts: the robot is off its place behind the box by at most {100 * start_m:g} cm and {start_deg:g}°, "
        f"the box off its own by at most {100 * box_m:g} cm and {box_deg:g}°.{_drawn(task.domain)}",
        "",
    ]


def _mission(name: str, task: TaskConfig, room: RoomFields) -> list[str]:
    """The section about an environment whose episodes are missions."""
    x_m, y_m = room.size_m
    return [
        *_head(name, task),
        "| nothing is left to push by | settings | meaning |",
        "| --- | --- | --- |",
        *(
            f"| `{name}` | {_settings(table)} | {_meaning(ENDING, name, table)} The mission goes on to its next push. |"
            for name, table in task.ending.items()
        ),
        "",
        f"Success: the box is within {100 * room.position_tolerance_m:g} cm and {room.angle_tolerance_deg:g}° of the "
        f"goal of the mission. Starts: anywhere in a random room of {x_m:g} x {y_m:g} m with {room.obstacles} "
        f"obstacles, the box off its place by at most {100 * room.box_xy_m:g} cm and {room.box_yaw_deg:g}°."
        f"{_drawn(task.domain)}",
        "",
    ]


def _head(name: str, task: TaskConfig) -> list[str]:
    """What a task sees, does and earns."""
    return [
        f"### {name}",
        "",
        task.description or f"The task `{name}`.",
        "",
        *_elements("observation", observation_elements(task)),
        *_elements("action", action_elements(task)),
        "| reward | weight | meaning |",
        "| --- | --- | --- |",
        *(
            f"| `{name}` | {table['weight']:g} | {_meaning(REWARD, name, table)} |"
            for name, table in task.reward.items()
        ),
        "",
    ]


def _drawn(domain: Domain) -> str:
    """What each episode draws besides, as a sentence that begins with a space."""
    parts = []
    for name, value in asdict(domain).items():
        if value is None or name in OFFSETS:
            continue
        numbers = all(isinstance(each, int | float) for each in value)
        parts.append(f"`{name}` " + (f"{value[0]:g} to {value[1]:g}" if numbers else ", ".join(value)))
    return f" Each episode draws {'; '.join(parts)}." if parts else ""


def _elements(what: str, elements: tuple[Element, ...]) -> list[str]:
    rows = (
        f"| {index} | `{each.name}` | {_unit(each, elements)} | {each.frame or '-'} | {each.low:g} to {each.high:g} | "
        f"{each.meaning.replace('|', chr(92) + '|')} |"
        for index, each in enumerate(elements)
    )
    return [f"| {what} | name | unit | frame | range | meaning |", "| --- | --- | --- | --- | --- | --- |", *rows, ""]


def _unit(element: Element, elements: tuple[Element, ...]) -> str:
    """The unit of an element, from those of its term, which has one for all elements or one for each."""
    term = element.name.partition(".")[0]
    units = element.unit.split(", ")
    axes = [each.name for each in elements if each.name.startswith(f"{term}.")]
    return units[axes.index(element.name)] if len(units) > 1 else element.unit


def _meaning(terms: Mapping[str, type[Struct]], name: str, table: Table) -> str:
    """What a term is, in one sentence."""
    kind = terms[str(table.get(TERM) or name)]
    return " ".join((kind.__doc__ or "").split("\n\n")[0].split()).replace("|", "\\|")


def _settings(table: Table) -> str:
    return ", ".join(f"{key} {value:g}" for key, value in table.items() if key != TERM and value) or "-"


def _info() -> str:
    return "\n".join(
        ["| key | meaning |", "| --- | --- |", *(f"| `{key}` | {text} |" for key, text in INFO.items()), ""]
    )
