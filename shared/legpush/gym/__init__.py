"""Registers the environments with Gymnasium: `gymnasium.make("legpush.gym:legpush/Push-v1")`.

A change to what an episode of a given task, seed and actions shows or pays raises the version of its id.
"""

from typing import Final

import gymnasium

PUSH_ID: Final = "legpush/Push-v1"
"""One step is one push cycle, one episode is a box and its goal; `agent_proc.learning.make_env` has the arguments."""
IDS: Final = {
    PUSH_ID: "tuned",
    "legpush/PushPaperText-v1": "paper-text",
    "legpush/PushPaperObservation-v1": "paper-observation",
    "legpush/PushRelease-v1": "release",
    "legpush/PushPaperLearns-v1": "paper-learns",
}
"""The built-in task of each id."""
MAKE: Final = "agent_proc.learning.make_env:make_push_env"

for _id, _task in IDS.items():
    gymnasium.register(_id, entry_point=MAKE, nondeterministic=False, kwargs={"task": _task})
