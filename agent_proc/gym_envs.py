"""Importing this module registers the environments with Gymnasium, as its `module:id` names expect.

`gymnasium.make("agent_proc.gym_envs:legpush/Push-v1", task=TaskConfig(), world=...)` makes a `PushEnv`. A change to
what an episode of a given task, seed and actions shows or pays raises the version.
"""

from typing import Final

import gymnasium

PUSH_ID: Final = "legpush/Push-v1"

gymnasium.register(PUSH_ID, entry_point="agent_proc.learning.env:PushEnv", nondeterministic=False)
