"""Registers the environments with Gymnasium: `gymnasium.make("legpush.gym:legpush/Push-v1")`.

A change to what an episode of a given task, seed and actions shows or pays raises the version of its id.
"""

from typing import Any, Final, NamedTuple

import gymnasium
from gymnasium.envs.registration import WrapperSpec

LIMIT: Final = "legpush.gym.episode_limit:EpisodeLimit"
"""Makes `max_episode_steps` the length of an episode."""
MAKE: Final = "agent_proc.learning.make_env:make_push_env"
"""Makes environments whose episodes are a box and its goal."""
MAKE_MISSIONS: Final = "agent_proc.mission_env.make_env:make_mission_env"
"""Makes environments whose episodes are whole missions."""


class Registered(NamedTuple):
    """A row of the table of environments."""

    task: str
    """The built-in task."""
    max_episode_steps: int
    """Push cycles after which Gymnasium truncates an episode, as the task does."""
    settings: dict[str, Any] = {}  # noqa: RUF012 - never changed
    """Further arguments of what makes it."""
    make: str = MAKE


PUSH_ID: Final = "legpush/Push-v1"
"""One step is one push cycle, one episode is a box and its goal; `agent_proc.learning.make_env` has the arguments."""
ENVIRONMENTS: Final = {
    PUSH_ID: Registered("tuned", 200),
    "legpush/PushL0-v2": Registered("tuned", 200),
    "legpush/PushL1-v2": Registered("push-l1", 100),
    "legpush/PushL2-v2": Registered("push-l2", 100),
    "legpush/PushL3-v2": Registered("push-l3", 100),
    "legpush/PushL4-v2": Registered("push-l4", 400, make=MAKE_MISSIONS),
    "legpush/PushWide-v2": Registered("wide", 100),
    "legpush/PushPaperText-v1": Registered("paper-text", 200),
    "legpush/PushPaperObservation-v1": Registered("paper-observation", 200),
    "legpush/PushRelease-v1": Registered("release", 200),
    "legpush/PushPaperLearns-v1": Registered("paper-learns", 200),
}
"""All environments by their ids."""

for _id, _row in ENVIRONMENTS.items():
    gymnasium.register(
        _id,
        entry_point=_row.make,
        nondeterministic=False,
        max_episode_steps=_row.max_episode_steps,
        kwargs={"task": _row.task, **_row.settings},
        additional_wrappers=(WrapperSpec("EpisodeLimit", LIMIT, {"usual": _row.max_episode_steps}),),
    )
