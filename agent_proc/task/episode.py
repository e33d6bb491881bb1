"""An episode of a task: what a step earns, when the episode ends, and how."""

from agent_proc.frames.push_view import PushView
from agent_proc.task.config import TaskConfig
from agent_proc.task.term import EpisodeEnding, PushStep
from legpush.messages.poses import planar_pose
from legpush.scene.station import at_station


def has_arrived(task: TaskConfig, view: PushView) -> bool:
    """Whether a policy of this task has nothing left to do, successful or not."""
    return any(term.arrived(view, task) for term in task.arrival_terms)


def episode_ending(task: TaskConfig, first: PushView, now: PushView, n_steps: int) -> EpisodeEnding | None:
    """How an episode that began at `first` ends after `n_steps` push cycles; None if it goes on."""
    if now.fallen:
        return "fell"
    if not at_station(now.scenario.robot, planar_pose(now.world.trunk), now.box, now.box_w):
        return "astray"
    if has_arrived(task, now):
        return "success" if now.error.within(now.goal) else "missed"
    if any(term.aborts(first, now) for term in task.abort_terms):
        return "astray"
    return "max_steps" if n_steps >= task.max_steps else None


def earned(task: TaskConfig, step: PushStep) -> dict[str, float]:
    """The terms of the reward of a step, weighted, by their names; no zero has a sign."""
    return {name: term.weight * term.value(step) + 0.0 for name, term in task.reward_terms.items()}
