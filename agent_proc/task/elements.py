"""What each number means that a policy of a task sees and gives, for the card of the policy."""

from msgspec import Struct

from agent_proc.task.action import CHOICES
from agent_proc.task.config import TaskConfig
from agent_proc.task.observed import observation_bounds
from agent_proc.task.term import ObservationTerm


class Element(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An element of an observation or of an action."""

    name: str
    unit: str
    frame: str = ""
    """Frame of a place or direction; empty for other quantities."""
    low: float
    """Lowest value."""
    high: float
    """Highest value."""
    meaning: str


def observation_elements(task: TaskConfig) -> tuple[Element, ...]:
    """The elements of the observation, in order, before a training normalizes it."""
    entries = [(name, term, axis) for name, term in task.observation_terms.items() for axis in term.AXES]
    low, high = observation_bounds(task)
    return tuple(
        Element(
            name=f"{name}.{axis}",
            unit=term.UNIT,
            frame=term.FRAME,
            low=round(float(least), 6),
            high=round(float(most), 6),
            meaning=_meaning(task, term),
        )
        for (name, term, axis), least, most in zip(entries, low, high, strict=True)
    )


def _meaning(task: TaskConfig, term: ObservationTerm) -> str:
    """What a term is, with what is done to its values."""
    scaled = f", times {term.scale:g}" if term.scale != 1.0 else ""
    mapped = ", mapped from its bounds to [-1, 1]" if task.scaling == "bounds" else ""
    return f"{term.meaning()}{scaled}{mapped}"


def action_elements(task: TaskConfig) -> tuple[Element, ...]:
    """The elements of the action, in order."""
    mirrored = "; of the mirror image if the observation is mirrored" if task.mirrored else ""
    if task.action_form == "discrete":
        low, highs, weight, leg = 0.0, [float(n - 1) for n in CHOICES], "(k + 1) / 10", "0 is FL, 1 is FR"
    else:
        low, highs, weight, leg = -1.0, [1.0] * 3, "(a + 1) / 2", "FL below 0, FR from 0 on"
    names = ("w1", "w2", "leg")
    meanings = (
        f"w1 of the push is {weight}",
        f"w2 of the push is {weight}",
        f"the foot that pushes: {leg}{mirrored}",
    )
    elements = [
        Element(name=name, unit="1", low=low, high=high, meaning=meaning)
        for name, high, meaning in zip(names, highs, meanings, strict=True)
    ]
    if task.entry == "variable":
        deepest = f"{task.max_depth_m:g} m"
        if task.limit_depth:
            deepest = f"the depth that brings the box up to its goal, at most {deepest}"
        meaning = f"depth of the push: from {task.least_depth_m:g} m at -1 to {deepest}, at 1"
        elements.append(Element(name="depth", unit="1", low=low, high=1.0, meaning=meaning))
    if task.changes_face:
        meaning = f"quarters to the left, around the box, to the face to push: 2 a, rounded{mirrored}"
        elements.append(Element(name="face", unit="1", low=low, high=1.0, meaning=meaning))
    return tuple(elements)
