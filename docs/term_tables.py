"""The tables of `learn.md`: the built-in tasks, and the terms that a task may name."""

import ast
import inspect
import json
from collections.abc import Iterator, Mapping
from textwrap import dedent
from typing import Any

import msgspec
from msgspec import Struct

from agent_proc.task.action_config import ActionConfig
from agent_proc.task.config import TaskConfig
from agent_proc.task.domain import Domain
from agent_proc.task.file import load_task, task_names
from agent_proc.task.term import ObservationTerm
from agent_proc.task.terms import ENDING, OBSERVATION, PARTS, REWARD, TERM, Table

COMMON = ("scale", "weight")
"""Settings of all terms of a kind, which the page tells of."""


def learn_parts() -> dict[str, str]:
    """The generated parts of `learn.md`."""
    return {
        "tasks": _tasks(),
        "task_keys": "\n".join(["| key | default | meaning |", "| --- | --- | --- |", *_keys()]) + "\n",
        "observation_terms": _terms(OBSERVATION),
        "reward_terms": _terms(REWARD),
        "ending_terms": _terms(ENDING),
    }


def _tasks() -> str:
    """A row for each task, with what it consists of."""
    lines = [
        "| task | action | observation | reward | ends by | starts of a training |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for task_name in task_names():
        task = load_task(task_name)
        cells = (
            f"`{task_name}`",
            f"{task.action_form}, {task.entry} entry{', mirrored' if task.mirrored else ''}",
            ", ".join(f"`{name}`" for name in task.observation),
            ", ".join(f"{table['weight']:g} `{name}`" for name, table in task.reward.items()),
            ", ".join(_named(name, table) for name, table in task.ending.items()),
            _starts(task),
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*lines, ""])


def _named(name: str, table: Table) -> str:
    settings = ", ".join(f"{key} {value:g}" for key, value in table.items() if key != TERM and value)
    return f"`{name}`{f' ({settings})' if settings else ''}"


def _starts(task: TaskConfig) -> str:
    if task.random_room is not msgspec.UNSET:
        return "none: missions in random rooms"
    return "one" if task.domain.box_xy_m == 0.0 else "those of the scenario"


def _keys() -> Iterator[str]:
    """Rows of the keys of a task file, but for the tables of terms."""
    texts = {**_texts(ActionConfig), **_texts(TaskConfig)}
    for name, default in _defaults(TaskConfig).items():
        if name in PARTS or name in ("domain", "scenario"):
            continue
        yield f"| `{name}` | {default} | {texts[name]} |"
    yield "| `scenario` | `push` | Name or path of the scenario, seen from the folder of the task file. |"
    yield "| `tolerance.position_m`, `.angle_deg` | those of the scenario | Tolerances of the goal. |"
    domain = _texts(Domain)
    for name, default in _defaults(Domain).items():
        yield f"| `domain.{name}` | {default} | {domain[name]} |"


def _terms(terms: Mapping[str, type[Struct]]) -> str:
    """A row for each term, with its settings."""
    observed = all(issubclass(kind, ObservationTerm) for kind in terms.values())
    lines = ["| term | elements, unit, frame | what | settings |", "| --- | --- | --- | --- |"]
    if not observed:
        lines = ["| term | what | settings |", "| --- | --- | --- |"]
    for name, kind in terms.items():
        texts = {key: text for base in kind.__mro__ if base is not object for key, text in _texts(base).items()}
        settings = " ".join(
            f"`{key}`{'' if default == 'required' else f' = {default}'}: {texts[key]}"
            for key, default in _defaults(kind).items()
            if key not in COMMON
        )
        cells = [f"`{name}`", _flat((kind.__doc__ or "").split("\n\n")[0]), settings or "-"]
        if issubclass(kind, ObservationTerm):
            cells.insert(1, f"{', '.join(kind.AXES)}; {kind.UNIT}; {kind.FRAME or '-'}")
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*lines, ""])


def _defaults(kind: type[Struct]) -> dict[str, str]:
    """The default of each field as it is written in a file."""
    return {field.encode_name: _default(field) for field in msgspec.structs.fields(kind)}


def _default(field: msgspec.structs.FieldInfo) -> str:
    if field.required:
        return "required"
    value: Any = field.default
    if value is None or value is msgspec.UNSET or value == "":
        return "-"
    return f"`{json.dumps(msgspec.to_builtins(value))}`"


def _texts(kind: type) -> dict[str, str]:
    """The text below each field in the source of a class."""
    if not kind.__module__.startswith("agent_proc."):
        return {}
    (definition,) = ast.parse(dedent(inspect.getsource(kind))).body
    found: dict[str, str] = {}
    name: str | None = None
    for node in definition.body if isinstance(definition, ast.ClassDef) else []:
        text = node.value.value if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) else None
        if isinstance(text, str) and name is not None:
            found[name] = _flat(text)
        name = node.target.id if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) else None
    return found


def _flat(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
