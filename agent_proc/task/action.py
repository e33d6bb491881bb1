"""The actions of a policy: which there are, and how they become pushes."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from agent_proc.frames.push_view import PushView, seen_from
from agent_proc.push_model.model import PushModel
from agent_proc.task.action_config import ActionConfig
from legpush.errors import ConfigError
from legpush.messages.stepping import Push
from legpush.scene.conventions import FrontLeg
from legpush.scene.faces import PUSHABLE, face_beside
from legpush.scene.names import Face

CHOICES: Final = (8, 8, 2)
"""Number of values of each element of a discrete action, the published grid: w1 and w2 are (k + 1) / 10."""
MODEL: Final = PushModel()


def action_names(task: ActionConfig) -> tuple[str, ...]:
    """Names of the elements of an action, in order."""
    depth = ("depth",) if task.entry == "variable" else ()
    return ("w1", "w2", "leg", *depth, *(("face",) if task.changes_face else ()))


def n_actions(task: ActionConfig) -> int:
    """Number of elements of an action."""
    return len(action_names(task))


def to_push(action: NDArray[Any], task: ActionConfig, view: PushView) -> Push:
    """The push that `action` means here.

    The leg is FL below the midpoint and FR above; with mirrored observations these are the legs of the mirror image.

    Raises:
        ConfigError: It is no action of the task.
    """
    chosen = _checked(action, task)
    if task.action_form == "discrete":
        w1, w2, right = (chosen[0] + 1) / 10, (chosen[1] + 1) / 10, chosen[2] == 1
    else:
        unit = (chosen.astype(np.float64) + 1.0) / 2.0
        w1, w2, right = unit[0], unit[1], unit[2] >= 0.5
    if task.mirrored and view.mirror_sign < 0.0:
        right = not right
    leg: FrontLeg = "FR" if right else "FL"
    face = view.face
    if task.changes_face:
        face = chosen_face(float(chosen[-1]), view, mirrored=task.mirrored and view.mirror_sign < 0.0)
    there = seen_from(view, face)
    depth_m = task.fixed_depth_m
    if task.entry == "variable":
        shallowest_m = shallowest_push_m(task, there)
        depth_m = shallowest_m + float(unit[3]) * (deepest_push_m(task, there) - shallowest_m)
    return Push(w1=float(w1), w2=float(w2), leg=leg, depth_m=depth_m, face=face)


def chosen_face(value: float, view: PushView, *, mirrored: bool) -> Face:
    """The face that an element in [-1, 1] chooses: as many quarters to the left as twice the value, rounded.

    In a mirror image, to the right. The present face stays where that one cannot be pushed.
    """
    n_quarters = round(2.0 * value)
    face = face_beside(view.face, -n_quarters if mirrored else n_quarters)
    can_push = face in PUSHABLE[view.scenario.box.shape] and face in view.scenario.pushing.faces
    return face if can_push else view.face


def _checked(action: NDArray[Any], task: ActionConfig) -> NDArray[Any]:
    """The action in the type of its space: integers of the grid, or float32 clipped to [-1, 1].

    Raises:
        ConfigError: It has another shape, is not made of numbers, is not finite, or is not on the grid.
    """
    n, got = n_actions(task), np.asarray(action)
    what = f"{got!r}, dtype {got.dtype}, shape {got.shape}"
    if task.action_form == "discrete":
        if got.shape != (n,) or got.dtype.kind not in "iu" or not ((got >= 0) & (got < CHOICES)).all():
            raise ConfigError(f"Expected an action of {n} integers below {CHOICES}, got {what}")
        return got
    if got.shape != (n,) or got.dtype.kind not in "fiu" or not np.isfinite(got).all():
        raise ConfigError(f"Expected an action of {n} finite numbers, which are clipped to [-1, 1], got {what}")
    clipped: NDArray[np.float32] = np.clip(got, -1.0, 1.0).astype(np.float32)
    return clipped


def shallowest_push_m(task: ActionConfig, view: PushView) -> float:
    """Depth of the lowest action with variable entry: the least depth, and what this box loses of it."""
    return min(task.least_depth_m + view.lost_depth_m, task.max_depth_m)


def deepest_push_m(task: ActionConfig, view: PushView) -> float:
    """Depth of the highest action; with `limit_depth` at most the depth that brings this box to its goal."""
    if not task.limit_depth:
        return task.max_depth_m
    remaining_m = max(0.0, -view.box_g.x_m)
    limit_m = float(MODEL.depth_for(np.array([remaining_m]))[0])
    return min(max(limit_m, task.least_depth_m) + view.lost_depth_m, task.max_depth_m)


def no_push_helps(task: ActionConfig, view: PushView) -> bool:
    """Whether the shallowest push would carry the box farther beyond its goal than it is short of it now."""
    shallowest_m = task.fixed_depth_m if task.entry == "fixed" else shallowest_push_m(task, view)
    travel_m = float(np.interp(shallowest_m - view.lost_depth_m, MODEL.depth_m, MODEL.forward_m))
    return -view.box_g.x_m <= travel_m / 2
