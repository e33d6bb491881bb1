"""Policies that weigh pushes, with the stop rule of a task, and at every face where an action may choose the face.

A walk to another face costs its time.
"""

from collections.abc import Callable
from functools import cache
from math import degrees
from typing import Final

from msgspec.structs import replace

from agent_proc.frames.push_view import PushView
from agent_proc.map_world.response_map import load_response_map
from agent_proc.policies.scripted import CYCLE_COST, ScriptedPolicy
from agent_proc.push_model.model import PushModel, nearest_model
from agent_proc.pushing.docking.moves import PUSH_S, walk_s
from agent_proc.rivals.blind import require_variable_depth
from agent_proc.rivals.steering import views_of_faces
from agent_proc.task.config import TaskConfig
from agent_proc.task.episode import has_arrived
from legpush.messages.stepping import Push
from legpush.scene.faces import pushed_box
from legpush.scene.names import Face

S_COST: Final = CYCLE_COST / PUSH_S
"""Cost of a second, in tolerances of the final error: as much as in push cycles."""
Weigh = Callable[[PushView], tuple[Push, float, float]]
"""The best push at the face of a view, its cost, and the present error, both in tolerances."""


class BestFace:
    """Chooses the face at which the best push costs least."""

    def __init__(self, task: TaskConfig, rival: str, weigh: Weigh, least_gain: float) -> None:
        """`least_gain` is the smallest gain for which the policy pushes.

        Raises:
            ConfigError: All pushes of the task have one depth.
        """
        require_variable_depth(task, rival)
        self._task = task
        self._weigh = weigh
        self._least_gain = least_gain

    def decide(self, view: PushView) -> Push | None:
        """The next push, or None if nothing is left to do or no push is worth its cost."""
        if has_arrived(self._task, view):
            return None
        views = views_of_faces(view) if self._task.changes_face else {view.face: view}
        found = []
        for face, there in views.items():
            push, cost, error = self._weigh(there)
            found.append((cost + S_COST * walk_s(view.face, face), error, replace(push, face=face)))
        cost, error, push = min(found, key=lambda each: each[0])
        return None if cost > error - self._least_gain else push


def scripted_by_size(view: PushView) -> tuple[Push, float, float]:
    """As the scripted policy predicts over the model that all missions begin with."""
    return _script_of(nearest_model(view.box)).best(view)


def scripted_by_map(view: PushView) -> tuple[Push, float, float]:
    """As the scripted policy predicts over the measured response of the default box."""
    return _script_of(measured_model(view.face)).best(view)


@cache
def _script_of(model: PushModel) -> ScriptedPolicy:
    return ScriptedPolicy(model)


@cache
def measured_model(face: Face) -> PushModel:
    """The measured response of the default box at a face, for pushes with w1 and w2 in their middle."""
    response_map = load_response_map()
    surface = response_map.surface(face)
    return PushModel(
        box=pushed_box(response_map.box, face),
        depth_m=surface.depth_m,
        forward_m=surface.forward_m,
        left_m=surface.left_m,
        turn_deg=tuple(degrees(turn_rad) for turn_rad in surface.turn_rad),
    )
