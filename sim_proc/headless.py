"""Loads MuJoCo without OpenGL: a simulation draws nothing, so no wrong OpenGL setting can stop it.

Films load MuJoCo with OpenGL (`sim_proc.render.camera`), in processes of their own. A process that has MuJoCo already
keeps it as it is.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

MUJOCO_GL: Final = "MUJOCO_GL"
"""The variable by which MuJoCo chooses its OpenGL backend when it is imported."""


@contextmanager
def _without_opengl() -> Iterator[None]:
    """Switch OpenGL off; afterwards the user's wish stands in the environment again, for child processes that film."""
    wish = os.environ.get(MUJOCO_GL)
    os.environ[MUJOCO_GL] = "disabled"
    try:
        yield
    finally:
        if wish is None:
            del os.environ[MUJOCO_GL]
        else:
            os.environ[MUJOCO_GL] = wish


with _without_opengl():
    import mujoco
    import mujoco.rollout

# A warning of MuJoCo belongs into the log of its process, not into a file in the folder from which the user started it.
_log = mujoco.MjLogConfig.get()
_log.logto_file = False
_log.set()

__all__ = ["mujoco"]
