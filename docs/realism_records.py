"""The records of `[realism]` that `protocol.md` has tables of."""

from typing import Final

from legpush.messages import stepping
from legpush.realism import reality, settings

SCENARIO: Final = (
    settings.Randomization,
    settings.Realism,
    settings.Gusts,
    settings.FloorTiles,
    settings.PoseSensor,
    settings.ImuSensor,
    settings.JointEncoders,
    settings.FootForceSensors,
)
OUTCOME: Final = (stepping.Perceived, reality.Reality, reality.Sensed, reality.Senses)
