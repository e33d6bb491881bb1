"""A search over the push model for the quickest sequence of pushes and walks to the goal, begun again at every push."""

from math import radians
from typing import Final

from agent_proc.frames.push_view import PushView
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.docking.moves import DockWalk, dock_pushes
from agent_proc.pushing.docking.search import DockSearch
from agent_proc.rivals.blind import require_variable_depth
from agent_proc.rivals.steering import views_of_faces
from agent_proc.task.config import TaskConfig
from agent_proc.task.episode import has_arrived
from legpush.errors import ConfigError
from legpush.geometry import Pose2
from legpush.messages.stepping import Push
from legpush.scene.faces import TURN_RAD

AIM_SHARE: Final = 0.5
"""Share of the tolerances that a sequence has to end within: pushes scatter."""
REACH: Final = 1.5
"""The box stays within this many times its distance from the goal, and `LEAST_REACH_M`."""
LEAST_REACH_M: Final = 0.5
MAX_NODES: Final = 100_000
"""Poses that are looked at before it gives up."""


class SearchPolicy:
    """Takes the first push of the quickest sequence that is predicted to end within the tolerances."""

    def __init__(self, task: TaskConfig) -> None:
        """Make the policy.

        Raises:
            ConfigError: The task has no choice of the face, so most goals are on no sequence, or none of the depth.
        """
        if not task.changes_face:
            raise ConfigError("Expected a task with `changes_face` for the rival search, got one with a single face")
        require_variable_depth(task, "search")
        self._task = task

    def decide(self, view: PushView) -> Push | None:
        """The next push, or None if nothing is left to do or no sequence was found."""
        if has_arrived(self._task, view):
            return None
        views, goal = views_of_faces(view), view.goal
        box = _unturned(view)
        estimates = {face: PushEstimate(there.box) for face, there in views.items()}
        search = DockSearch(
            dock_pushes(estimates),
            AIM_SHARE * goal.position_tolerance_m,
            AIM_SHARE * radians(goal.angle_tolerance_deg),
            area_m=max(LEAST_REACH_M, REACH * view.error.position_m),
            max_nodes=MAX_NODES,
        )
        moves = search.find(box, view.face, lambda _pose, _face: True) or ()
        push = next((move for move in moves if not isinstance(move, DockWalk)), None)
        if push is None:
            return None
        w1, w2 = estimates[push.face].curve
        return Push(
            w1=w1,
            w2=w2,
            leg=push.leg,
            depth_m=min(push.depth_m + view.lost_depth_m, self._task.max_depth_m),
            face=push.face,
        )


def _unturned(view: PushView) -> Pose2:
    """Pose of the box itself, not of its pushed frame, in the frame of its goal."""
    back = Pose2(x_m=0.0, y_m=0.0, yaw_rad=-TURN_RAD[view.face])
    return back.inverse() @ view.box_g @ back
