"""One push: approach if need be, push, count it, publish its reward, and learn from it."""

from collections.abc import Callable, Mapping
from typing import Final

from agent_proc.frames.push_view import PushView, push_view
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.push_model.map import PushMap
from agent_proc.pushing.budget import PushBudget
from agent_proc.task.episode import earned
from agent_proc.task.file import DEFAULT_TASK, load_task
from agent_proc.task.term import PushStep
from agent_proc.walking.actor import Actor
from agent_proc.walking.walker import Walker
from legpush.errors import MotionError
from legpush.messages.stepping import Push
from legpush.scene.faces import pushed_box, pushed_pose
from legpush.scene.names import Face

LOOKS: Final = 3
"""How often a push is tried, each time from where the robot comes to stand when it looks at the box again."""

PublishReward = Callable[[Mapping[str, float]], None]
"""Gets what a push earned, term by term."""


class Pushes:
    """The pushes of a mission, and what they do at each face of the box."""

    def __init__(
        self, actor: Actor, walker: Walker, publish_reward: PublishReward, push_map: PushMap | None = None
    ) -> None:
        """`push_map` is the measured effect of pushes; without it, that on the nearest known box is assumed."""
        self._actor = actor
        self._walker = walker
        self._publish_reward = publish_reward
        self.estimates: Mapping[Face, PushEstimate] = {
            face: PushEstimate(pushed_box(actor.scenario.box, face), None if push_map is None else push_map.model(face))
            for face in actor.faces()
        }
        """What pushes do, by the face that is pushed."""
        self.budget = PushBudget(actor.scenario, self.estimates)
        """How many pushes there may be."""
        self.n_cycles = 0
        """Number of pushes."""
        self._task = load_task(DEFAULT_TASK)
        self._first: PushView | None = None
        """Before the first push."""

    def push(self, push: Push, *, learn: bool) -> None:
        """Push once, from the station of the face; with `learn`, its estimate learns from the push.

        Raises:
            MissionEndedError: The station cannot be reached, or what a motion raises.
        """
        face = push.face
        if not self._actor.at_station(face):
            self._walker.approach(face)
        self.n_cycles += 1
        before, view = pushed_pose(self._actor.box(), face), push_view(self._actor.true_state, self._actor.scenario)
        self._first = self._first or view
        self._step(push)
        after = push_view(self._actor.true_state, self._actor.scenario)
        # What the same push earns in a training of the default task; policies do not see it here.
        self._publish_reward(earned(self._task, PushStep(first=self._first, before=view, after=after, ending=None)))
        if learn:
            self.estimates[face].learn(before, push, pushed_pose(self._actor.box(), face))

    def _step(self, push: Push) -> None:
        """Push; step to the station, and look again, if the push is refused because of where the box is seen.

        A box that is perceived exactly would be seen in the same place again.

        Raises:
            MissionEndedError: What a motion raises.
            MotionError: The push is refused.
        """
        for n_left in reversed(range(LOOKS)):
            try:
                return self._actor.step(push)
            except MotionError:
                if self._actor.true_state.perceived is None or not n_left:
                    raise
            self._walker.step_to_station(push.face)
        return None
