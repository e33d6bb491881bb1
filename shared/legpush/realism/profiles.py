"""The profiles of `[realism]`: what holds where a scenario states nothing else."""

from typing import Any, Final

import msgspec
from msgspec import Struct

from legpush.realism.settings import (
    FloorTiles,
    FootForceSensors,
    Gusts,
    ImuSensor,
    JointEncoders,
    PoseSensor,
    Profile,
    Realism,
)

IDEAL: Final = Realism(
    motor_strength=1.0,
    joint_friction_n_m=0.0,
    payload_kg=0.0,
    payload_x_m=0.0,
    payload_y_m=0.0,
    payload_z_m=0.0,
    com_x_m=0.0,
    com_y_m=0.0,
    com_z_m=0.0,
    slope_deg=0.0,
    uphill_deg=0.0,
    command_latency_s=0.0,
    gusts=Gusts(force_n=0.0, duration_s=0.2, at_s=0.0, direction_deg=0.0),
    floor=FloorTiles(height_m=0.0, size_m=0.25),
    box_pose=PoseSensor(noise_m=0.0, noise_deg=0.0, rate_hz=50.0, latency_s=0.0, dropouts=0.0),
    localization=PoseSensor(noise_m=0.0, noise_deg=0.0, rate_hz=50.0, latency_s=0.0, dropouts=0.0),
    imu=ImuSensor(gyro_noise_rad_s=0.0, gyro_bias_rad_s=0.0, accelerometer_noise_m_s2=0.0, accelerometer_bias_m_s2=0.0),
    encoders=JointEncoders(noise_rad=0.0),
    foot_forces=FootForceSensors(noise_n=0.0, bias_n=0.0),
    sensor_latency_s=0.0,
)
"""Everything is as assumed. `foot_friction` is that of the robot, and there is one gust."""
REAL: Final = Realism(
    profile="real",
    motor_strength=(0.9, 1.1),
    com_x_m=(-0.02, 0.02),
    com_y_m=(-0.02, 0.02),
    com_z_m=(-0.02, 0.02),
    foot_friction=(0.6, 1.0),
    box_pose=PoseSensor(noise_m=0.01, noise_deg=1.0, rate_hz=10.0, latency_s=0.05, dropouts=0.02),
    localization=PoseSensor(noise_m=0.02, noise_deg=1.0, rate_hz=2.0),
    imu=ImuSensor(
        gyro_noise_rad_s=0.0035, gyro_bias_rad_s=0.002, accelerometer_noise_m_s2=0.06, accelerometer_bias_m_s2=0.05
    ),
    encoders=JointEncoders(noise_rad=0.0005),
    foot_forces=FootForceSensors(noise_n=4.0, bias_n=5.0),
    sensor_latency_s=0.02,
)
"""What differs in the profile `real`. Its sources are in `docs/realism.md`."""
PROFILES: Final[dict[Profile, Realism]] = {"ideal": IDEAL, "real": REAL}


def stated(realism: Realism) -> Realism:
    """Return every item with its number or interval: the stated ones, then those of the profile, then the ideal ones.

    The friction of feet, and the time between gusts, may be None.
    """
    merged: Realism = _merged(_merged(realism, PROFILES[realism.profile]), IDEAL)
    return merged


def _merged(first: Any, second: Any) -> Any:
    """Return a record whose fields that are None come from a second record."""
    changes: dict[str, Any] = {}
    for name in first.__struct_fields__:
        mine, other = getattr(first, name), getattr(second, name)
        if isinstance(mine, Struct):
            changes[name] = _merged(mine, other)
        elif mine is None:
            changes[name] = other
    return msgspec.structs.replace(first, **changes)
