"""The default box, and what is known of pushes at its faces before the first one."""

from agent_proc.push_model.estimate import PushEstimate
from legpush.scene.faces import FACES, pushed_box
from legpush.scene.names import Face
from legpush.scene.scenario import Box, PoseDeg

BOX = Box(pose=PoseDeg(x_m=0.0, y_m=0.0, yaw_deg=0.0))


def estimates() -> dict[Face, PushEstimate]:
    """What pushes do at each face."""
    return {face: PushEstimate(pushed_box(BOX, face)) for face in FACES}
