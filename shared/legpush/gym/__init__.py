"""Registers the environments with Gymnasium: `gymnasium.make("legpush.gym:legpush/Push-v1")`.

A change to what an episode of a given task, seed and actions shows or pays raises the version of its id.
"""

from typing import Final

import gymnasium

PUSH_ID: Final = "legpush/Push-v1"
"""One step is one push cycle, one episode is a box and its goal; `agent_proc.learning.make_env` has the arguments."""

gymnasium.register(PUSH_ID, entry_point="agent_proc.learning.make_env:make_push_env", nondeterministic=False)
