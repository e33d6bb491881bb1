"""The bounds of the items of `[realism]`, each with its reason, and the types that have them.

Each item is a number, or an interval from which the seed of an episode draws.
"""

from typing import Annotated, Final, TypeAlias, TypeVar

from msgspec import Meta

LEAST_STRENGTH: Final = 0.1
MAX_STRENGTH: Final = 2.0
"""Share of its gains and torques that a servo has: with the least one the robot cannot stand."""
MAX_JOINT_FRICTION_N_M: Final = 50.0
"""Dry friction of a joint, more than the torque of a hip."""
MAX_PAYLOAD_KG: Final = 50.0
"""Mass on the trunk, one and a half times that of the robot."""
MAX_PLACE_M: Final = 1.0
"""Farthest place of a mass from the middle of the trunk, along an axis: just beyond the trunk."""
MAX_COM_OFFSET_M: Final = 0.3
"""Farthest that the centre of mass of the trunk may be from where it is taken to be: within its width."""
LEAST_FOOT_FRICTION: Final = 0.01
MAX_FOOT_FRICTION: Final = 5.0
"""Friction of feet and floor, from wet ice to more than rubber has."""
MAX_SLOPE_DEG: Final = 20.0
"""Steepest slope that the robot is not told of, twice the steepest known one."""
MAX_DIRECTION_DEG: Final = 360.0
"""A direction, a full turn either way."""
MAX_COMMAND_LATENCY_S: Final = 0.2
"""Longest time from a command to its servo: a quarter of a gait cycle."""
MAX_GUST_N: Final = 2000.0
"""Largest force of a gust, six times the weight of the robot."""
LEAST_GUST_S: Final = 0.02
MAX_GUST_S: Final = 100.0
"""Duration of a gust: a tick at least."""
MAX_START_S: Final = 1e5
"""Latest begin of the first gust, and longest time from one to the next: a day."""
MAX_TILE_HEIGHT_M: Final = 0.5
"""Highest tile. A scenario allows no more than the step height of its robot."""
LEAST_TILE_M: Final = 0.05
MAX_TILE_M: Final = 10.0
"""Side of a tile: a little more than a foot is wide, up to a room."""
MAX_NOISE_M: Final = 1.0
MAX_NOISE_DEG: Final = 90.0
"""Standard deviation of a perceived pose: beyond, nothing is perceived."""
LEAST_RATE_HZ: Final = 0.01
MAX_RATE_HZ: Final = 50.0
"""How often a pose is measured. The highest rate is that of the ticks."""
MAX_LATENCY_S: Final = 10.0
"""Oldest measurement that is still given: some gait cycles."""
MAX_DROPOUTS: Final = 0.95
"""Largest share of measurements that are lost: one of twenty still comes."""
MAX_GYRO_NOISE_RAD_S: Final = 1.0
MAX_GYRO_BIAS_RAD_S: Final = 0.5
"""Angular velocity that a gyroscope reads too much, in each sample and always: beyond, the robot knows no heading."""
MAX_ACCELEROMETER_NOISE_M_S2: Final = 10.0
MAX_ACCELEROMETER_BIAS_M_S2: Final = 2.0
"""Acceleration that an accelerometer reads too much: as much as gravity in a sample, a fifth of it always."""
MAX_ENCODER_NOISE_RAD: Final = 0.05
"""Noise of a joint angle, 3 degrees: beyond, the foot is anywhere within the length of a foot."""
MAX_FORCE_ERROR_N: Final = 100.0
"""Force that a foot feels too much, more than it carries while the robot stands."""
MAX_SENSOR_LATENCY_S: Final = 0.2
"""Oldest reading of the robot's own sensors: a quarter of a gait cycle."""

MotorStrength = Annotated[float, Meta(ge=LEAST_STRENGTH, le=MAX_STRENGTH)]
JointFriction = Annotated[float, Meta(ge=0.0, le=MAX_JOINT_FRICTION_N_M)]
Payload = Annotated[float, Meta(ge=0.0, le=MAX_PAYLOAD_KG)]
Place = Annotated[float, Meta(ge=-MAX_PLACE_M, le=MAX_PLACE_M)]
ComOffset = Annotated[float, Meta(ge=-MAX_COM_OFFSET_M, le=MAX_COM_OFFSET_M)]
FootFriction = Annotated[float, Meta(ge=LEAST_FOOT_FRICTION, le=MAX_FOOT_FRICTION)]
HiddenSlope = Annotated[float, Meta(ge=0.0, le=MAX_SLOPE_DEG)]
Direction = Annotated[float, Meta(ge=-MAX_DIRECTION_DEG, le=MAX_DIRECTION_DEG)]
CommandLatency = Annotated[float, Meta(ge=0.0, le=MAX_COMMAND_LATENCY_S)]
GustForce = Annotated[float, Meta(ge=0.0, le=MAX_GUST_N)]
GustDuration = Annotated[float, Meta(ge=LEAST_GUST_S, le=MAX_GUST_S)]
GustStart = Annotated[float, Meta(ge=0.0, le=MAX_START_S)]
GustEvery = Annotated[float, Meta(ge=LEAST_GUST_S, le=MAX_START_S)]
TileHeight = Annotated[float, Meta(ge=0.0, le=MAX_TILE_HEIGHT_M)]
TileSide = Annotated[float, Meta(ge=LEAST_TILE_M, le=MAX_TILE_M)]
Noise = Annotated[float, Meta(ge=0.0, le=MAX_NOISE_M)]
NoiseDeg = Annotated[float, Meta(ge=0.0, le=MAX_NOISE_DEG)]
Rate = Annotated[float, Meta(ge=LEAST_RATE_HZ, le=MAX_RATE_HZ)]
Latency = Annotated[float, Meta(ge=0.0, le=MAX_LATENCY_S)]
Dropouts = Annotated[float, Meta(ge=0.0, le=MAX_DROPOUTS)]
GyroNoise = Annotated[float, Meta(ge=0.0, le=MAX_GYRO_NOISE_RAD_S)]
GyroBias = Annotated[float, Meta(ge=0.0, le=MAX_GYRO_BIAS_RAD_S)]
AccelerometerNoise = Annotated[float, Meta(ge=0.0, le=MAX_ACCELEROMETER_NOISE_M_S2)]
AccelerometerBias = Annotated[float, Meta(ge=0.0, le=MAX_ACCELEROMETER_BIAS_M_S2)]
EncoderNoise = Annotated[float, Meta(ge=0.0, le=MAX_ENCODER_NOISE_RAD)]
ForceError = Annotated[float, Meta(ge=0.0, le=MAX_FORCE_ERROR_N)]
SensorLatency = Annotated[float, Meta(ge=0.0, le=MAX_SENSOR_LATENCY_S)]

T = TypeVar("T")
Item: TypeAlias = T | Annotated[tuple[T, ...], Meta(min_length=2, max_length=2)] | None
"""A number, or the least and the largest one of an interval; nil is that of the profile.

Not `tuple[T, T]`: msgspec 0.22 reads beyond its memory where that stands beside a number with bounds.
"""
