"""When an episode of a task ends, and how."""

from typing import Final, Literal

from agent_proc.frames.push_view import PushView
from agent_proc.task.action import no_push_helps
from agent_proc.task.config import TaskConfig
from agent_proc.task.reward_tuned import errors_in_tolerances
from legpush.messages.poses import planar_pose
from legpush.scene.station import at_station

ASTRAY: Final = 5.0
"""With the reward `tuned`, an episode ends when the errors of position and angle, each in tolerances, add up to this
much more than at its start."""

EpisodeEnding = Literal["success", "fell", "missed", "astray", "max_steps"]
"""`missed`: no push brings the box nearer to its goal, and it is outside the tolerances. `astray`: the box has slid
away from the robot, or its errors have grown by `ASTRAY`."""


def is_done(task: TaskConfig, view: PushView) -> bool:
    """Whether a policy of this task has nothing left to do, successful or not."""
    if task.reward == "paper":
        return view.error.within(view.goal)
    return no_push_helps(task, view)


def episode_ending(task: TaskConfig, first: PushView, now: PushView, n_steps: int) -> EpisodeEnding | None:
    """How an episode that began at `first` ends after `n_steps` push cycles; None if it goes on."""
    if now.fallen:
        return "fell"
    if not at_station(now.scenario.robot, planar_pose(now.world.trunk), now.box, now.box_w):
        return "astray"
    if is_done(task, now):
        return "success" if now.error.within(now.goal) else "missed"
    if task.reward == "tuned" and sum(errors_in_tolerances(now)) > sum(errors_in_tolerances(first)) + ASTRAY:
        return "astray"
    return "max_steps" if n_steps >= task.max_steps else None
