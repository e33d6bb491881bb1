"""Bang-bang steering: the sign of the steering error decides about the leg, and every push is as deep as it may be."""

from math import radians
from typing import Final

from agent_proc.frames.push_view import PushView, seen_from
from agent_proc.rivals.blind import middle_push
from agent_proc.task.config import TaskConfig
from agent_proc.task.episode import has_arrived
from legpush.messages.stepping import Push
from legpush.scene.faces import PUSHABLE
from legpush.scene.names import Face

MOST_STEERING_RAD: Final = radians(60.0)
"""With a larger steering error, or past its goal, the box is pushed at another face, if an action may choose one."""


class BangBangPolicy:
    """Pushes with the left leg if the box has to turn to the right, else with the right one."""

    def __init__(self, task: TaskConfig) -> None:
        self._task = task

    def decide(self, view: PushView) -> Push | None:
        """The next push, or None if nothing is left to do."""
        if has_arrived(self._task, view):
            return None
        there = self._from_best_face(view) if self._task.changes_face else view
        return middle_push(self._task, view, "FL" if there.steering_error_rad > 0.0 else "FR", there.face)

    def _from_best_face(self, view: PushView) -> PushView:
        """The view from the present face; if that one does not lead on, from the one with the least steering error."""
        if view.box_g.x_m < 0.0 and abs(view.steering_error_rad) <= MOST_STEERING_RAD:
            return view
        return min(views_of_faces(view).values(), key=lambda each: abs(each.steering_error_rad))


def views_of_faces(view: PushView) -> dict[Face, PushView]:
    """The same world, seen from every face that may be pushed."""
    scenario = view.scenario
    faces = [face for face in PUSHABLE[scenario.box.shape] if face in scenario.pushing.faces]
    return {face: seen_from(view, face) for face in faces}
