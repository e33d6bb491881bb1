"""`Reality`: the numbers that hold in one episode, drawn by its seed from `[realism]`."""

from math import radians
from typing import Any, Final

import msgspec
import numpy as np
from msgspec import Struct

from legpush.fields import Seed
from legpush.realism.bounds import (
    AccelerometerBias,
    AccelerometerNoise,
    CommandLatency,
    ComOffset,
    Direction,
    Dropouts,
    EncoderNoise,
    FootFriction,
    ForceError,
    GyroBias,
    GyroNoise,
    HiddenSlope,
    JointFriction,
    Latency,
    MotorStrength,
    Noise,
    NoiseDeg,
    Payload,
    Place,
    Rate,
    SensorLatency,
    TileHeight,
    TileSide,
)
from legpush.realism.profiles import IDEAL, stated
from legpush.realism.settings import Gusts, PoseSensor, Realism, interval

ITEMS_STREAM: Final = 1
GUSTS_STREAM: Final = 2
TILES_STREAM: Final = 3
BOX_STREAM: Final = 4
LOCALIZATION_STREAM: Final = 5
IMU_STREAM: Final = 6
ENCODER_STREAM: Final = 7
FORCE_STREAM: Final = 8
PUSH_STREAM: Final = 9
"""Streams of random numbers beside that of the start, so that one item changes nothing about the others."""
N_ITEMS: Final = 33
"""Random numbers of an episode's items, in the order in which they are drawn; new ones go to the end."""


class Sensed(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How a planar pose is measured in one episode, see `PoseSensor`."""

    noise_m: Noise
    noise_deg: NoiseDeg
    rate_hz: Rate
    latency_s: Latency
    dropouts: Dropouts

    @property
    def exact(self) -> bool:
        """Whether it is always known as it is."""
        return self == EXACT


EXACT: Final = Sensed(noise_m=0.0, noise_deg=0.0, rate_hz=50.0, latency_s=0.0, dropouts=0.0)


class Senses(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the robot feels its own motion in one episode, see `ImuSensor`, `JointEncoders` and `FootForceSensors`."""

    gyro_noise_rad_s: GyroNoise = 0.0
    gyro_bias_rad_s: GyroBias = 0.0
    accelerometer_noise_m_s2: AccelerometerNoise = 0.0
    accelerometer_bias_m_s2: AccelerometerBias = 0.0
    encoder_noise_rad: EncoderNoise = 0.0
    force_noise_n: ForceError = 0.0
    force_bias_n: ForceError = 0.0
    latency_s: SensorLatency = 0.0

    @property
    def exact(self) -> bool:
        """Whether the motion is always known as it is."""
        return self == FELT_EXACTLY


FELT_EXACTLY: Final = Senses()


class Gust(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One gust."""

    begins_s: float
    duration_s: float
    force_n: float
    direction_rad: float
    """From the heading of the trunk when it begins."""


class Reality(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The numbers of one episode, see `Realism`."""

    seed: Seed = 0
    """Of the episode; tiles, gusts and noise follow from it."""
    motor_strength: MotorStrength = 1.0
    joint_friction_n_m: JointFriction = 0.0
    payload_kg: Payload = 0.0
    payload_m: tuple[Place, Place, Place] = (0.0, 0.0, 0.0)
    com_offset_m: tuple[ComOffset, ComOffset, ComOffset] = (0.0, 0.0, 0.0)
    foot_friction: FootFriction | None = None
    """Nil: that of the robot."""
    slope_deg: HiddenSlope = 0.0
    uphill_deg: Direction = 0.0
    command_latency_s: CommandLatency = 0.0
    gusts: Gusts = IDEAL.gusts
    """Each gust draws its own numbers."""
    tile_height_m: TileHeight = 0.0
    tile_size_m: TileSide = 0.25
    box_pose: Sensed = EXACT
    localization: Sensed = EXACT
    senses: Senses = FELT_EXACTLY

    @property
    def as_assumed(self) -> bool:
        """Whether the physics is what control assumes, apart from gusts and from what is perceived."""
        perceived = {"box_pose": EXACT, "localization": EXACT, "senses": FELT_EXACTLY}
        alike = msgspec.structs.replace(self, seed=0, gusts=IDEAL.gusts, command_latency_s=0.0, **perceived)
        return alike == AS_ASSUMED

    @property
    def ideal(self) -> bool:
        """Whether everything is as assumed, and perceived exactly."""
        exact = self.box_pose.exact and self.localization.exact and self.senses.exact
        return self.as_assumed and exact and self.command_latency_s == 0.0 and not self.has_gusts

    @property
    def has_gusts(self) -> bool:
        """Whether a gust has a force."""
        return self.gusts.force_n is not None and interval(self.gusts.force_n)[1] > 0.0

    def gust(self, index: int, begins_s: float) -> Gust:
        """Return the gust with an index, which begins at a time."""
        of_gust = np.random.default_rng([self.seed, GUSTS_STREAM, index]).random(3).tolist()
        force_n, duration_s, direction_deg = (
            _at(item, share)
            for item, share in zip(
                (self.gusts.force_n, self.gusts.duration_s, self.gusts.direction_deg), of_gust, strict=True
            )
        )
        return Gust(begins_s=begins_s, duration_s=duration_s, force_n=force_n, direction_rad=radians(direction_deg))

    def gust_begins_s(self, index: int, before_s: float) -> float | None:
        """Return when the gust with an index begins, if the one before it begins at `before_s`; None: never."""
        item = self.gusts.at_s if index == 0 else self.gusts.every_s
        if item is None or not self.has_gusts:
            return None
        share = np.random.default_rng([self.seed, GUSTS_STREAM, index, 1]).random()
        return before_s + _at(item, share)


AS_ASSUMED: Final = Reality()
"""Everything is as planner, control and agent take it to be."""


def drawn_reality(realism: Realism, seed: int) -> Reality:
    """Draw the numbers of an episode. Each item has a random number of its own, whatever the others are."""
    whole = stated(realism)
    generator = np.random.default_rng([seed, ITEMS_STREAM])
    shares = iter(generator.random(N_ITEMS).tolist())

    def number(item: Any) -> float:
        return _at(item, next(shares))

    def sensed(sensor: PoseSensor) -> Sensed:
        return Sensed(**{name: number(getattr(sensor, name)) for name in Sensed.__struct_fields__})

    reality = Reality(
        seed=seed,
        motor_strength=number(whole.motor_strength),
        joint_friction_n_m=number(whole.joint_friction_n_m),
        payload_kg=number(whole.payload_kg),
        payload_m=(number(whole.payload_x_m), number(whole.payload_y_m), number(whole.payload_z_m)),
        com_offset_m=(number(whole.com_x_m), number(whole.com_y_m), number(whole.com_z_m)),
        slope_deg=number(whole.slope_deg),
        uphill_deg=number(whole.uphill_deg),
        command_latency_s=number(whole.command_latency_s),
        gusts=whole.gusts,
        tile_height_m=number(whole.floor.height_m),
        tile_size_m=number(whole.floor.size_m),
        box_pose=sensed(whole.box_pose),
        localization=sensed(whole.localization),
    )
    share = next(shares)
    if whole.foot_friction is not None:
        reality = msgspec.structs.replace(reality, foot_friction=_at(whole.foot_friction, share))
    senses = Senses(
        gyro_noise_rad_s=number(whole.imu.gyro_noise_rad_s),
        gyro_bias_rad_s=number(whole.imu.gyro_bias_rad_s),
        accelerometer_noise_m_s2=number(whole.imu.accelerometer_noise_m_s2),
        accelerometer_bias_m_s2=number(whole.imu.accelerometer_bias_m_s2),
        encoder_noise_rad=number(whole.encoders.noise_rad),
        force_noise_n=number(whole.foot_forces.noise_n),
        force_bias_n=number(whole.foot_forces.bias_n),
        latency_s=number(whole.sensor_latency_s),
    )
    reality = msgspec.structs.replace(reality, senses=senses)
    return msgspec.structs.replace(reality, **_without_what_does_not_matter(reality))


def _without_what_does_not_matter(reality: Reality) -> dict[str, Any]:
    """Return the ideal places of a payload, a slope and tiles that are not there, so that equal worlds are equal."""
    changes: dict[str, Any] = {}
    if reality.payload_kg == 0.0:
        changes["payload_m"] = (0.0, 0.0, 0.0)
    if reality.slope_deg == 0.0:
        changes["uphill_deg"] = 0.0
    if reality.tile_height_m == 0.0:
        changes["tile_size_m"] = AS_ASSUMED.tile_size_m
    return changes


def _at(item: Any, share: float) -> float:
    """Return the number of an item at a share of its interval."""
    least, largest = interval(item)
    return float(least + (largest - least) * share)
