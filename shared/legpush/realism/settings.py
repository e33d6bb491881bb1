"""`[realism]` of a scenario: a profile, and the items that differ from it."""

from collections.abc import Iterable
from typing import Any, Literal

from msgspec import Struct

from legpush.bounds import Distance, Turn
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
    GustDuration,
    GustEvery,
    GustForce,
    GustStart,
    GyroBias,
    GyroNoise,
    HiddenSlope,
    Item,
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

Profile = Literal["ideal", "real"]


def interval(item: float | tuple[float, ...]) -> tuple[float, float]:
    """Return the least and the largest number of an item."""
    least, largest = item if isinstance(item, tuple) else (item, item)
    return least, largest


def _require_rising(record: Struct) -> None:
    """Check that each interval of a record begins with its least number (`ValueError`)."""
    for name in record.__struct_fields__:
        value: Any = getattr(record, name)
        if isinstance(value, tuple) and not value[0] <= value[1]:
            raise ValueError(f"Expected {name} as [least, largest], got [{value[0]:g}, {value[1]:g}]")


def _require_with(record: Struct, needed: str, names: Iterable[str]) -> None:
    """Check that `needed` is stated if one of `names` is (`ValueError`)."""
    stated = [name for name in names if getattr(record, name) is not None]
    if stated and getattr(record, needed) is None:
        raise ValueError(f"Expected {needed} with {stated[0]}, got none")


class Randomization(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Half-widths of the uniform offsets that the seed of an episode draws."""

    start_xy_m: Distance = 0.0
    start_yaw_deg: Turn = 0.0
    box_xy_m: Distance = 0.0
    box_yaw_deg: Turn = 0.0


class Gusts(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Gusts: horizontal forces on the trunk, each with numbers of its own if they are intervals."""

    force_n: Item[GustForce] = None
    duration_s: Item[GustDuration] = None
    """In whole ticks, rounded up."""
    at_s: Item[GustStart] = None
    """When the first one begins, from the reset on."""
    every_s: Item[GustEvery] = None
    """From the begin of one to the begin of the next; without it, there is one gust."""
    direction_deg: Item[Direction] = None
    """Where it pushes the trunk, from the heading that this has when the gust begins: 0 forward, 90 to the left."""

    def __post_init__(self) -> None:
        """Check that a gust has force and duration, and ends before the next one begins.

        Raises:
            ValueError: It does not.
        """
        _require_rising(self)
        _require_with(self, "force_n", ("duration_s", "at_s", "every_s", "direction_deg"))
        _require_with(self, "duration_s", ("force_n",))
        if self.every_s is not None and self.duration_s is not None:
            every_s, duration_s = interval(self.every_s)[0], interval(self.duration_s)[1]
            if every_s < duration_s:
                raise ValueError(f"Expected every_s of at least duration_s, {duration_s:g} s, got {every_s:g} s")


class FloorTiles(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A floor of square tiles, each at a height of its own. Where robot and box begin, it is level."""

    height_m: Item[TileHeight] = None
    """Height of the highest tile; the seed draws that of each tile from 0 up to this. At most the step height of the
    robot, `robot.rough.step_height_m`."""
    size_m: Item[TileSide] = None
    """Side of a tile."""

    def __post_init__(self) -> None:
        """Check that a size has a height.

        Raises:
            ValueError: It does not.
        """
        _require_rising(self)
        _require_with(self, "height_m", ("size_m",))


class PoseSensor(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How a planar pose is measured. Between measurements the last one holds."""

    noise_m: Item[Noise] = None
    """Standard deviation along x and along y, normally distributed."""
    noise_deg: Item[NoiseDeg] = None
    """Standard deviation of the heading."""
    rate_hz: Item[Rate] = None
    """Measurements per second, in whole ticks; at most the rate of the ticks."""
    latency_s: Item[Latency] = None
    """From a measurement until it is given, in whole ticks, rounded up."""
    dropouts: Item[Dropouts] = None
    """Share of the measurements that are lost. The first one never is."""

    def __post_init__(self) -> None:
        """Check that intervals rise.

        Raises:
            ValueError: One does not.
        """
        _require_rising(self)


class ImuSensor(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Gyroscope and accelerometer in the middle of the trunk, which give a sample in each physics step of 2 ms."""

    gyro_noise_rad_s: Item[GyroNoise] = None
    """Standard deviation of each sample, for each axis."""
    gyro_bias_rad_s: Item[GyroBias] = None
    """Standard deviation of what each axis reads too much throughout an episode."""
    accelerometer_noise_m_s2: Item[AccelerometerNoise] = None
    """Standard deviation of each sample, for each axis."""
    accelerometer_bias_m_s2: Item[AccelerometerBias] = None
    """Standard deviation of what each axis reads too much throughout an episode."""

    def __post_init__(self) -> None:
        """Check that intervals rise.

        Raises:
            ValueError: One does not.
        """
        _require_rising(self)


class JointEncoders(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Angles of the joints, read in each physics step."""

    noise_rad: Item[EncoderNoise] = None
    """Standard deviation of each reading."""

    def __post_init__(self) -> None:
        """Check that intervals rise.

        Raises:
            ValueError: One does not.
        """
        _require_rising(self)


class FootForceSensors(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Vertical forces of the feet, read in each physics step."""

    noise_n: Item[ForceError] = None
    """Standard deviation of each reading."""
    bias_n: Item[ForceError] = None
    """Standard deviation of what each foot reads too much throughout an episode."""

    def __post_init__(self) -> None:
        """Check that intervals rise.

        Raises:
            ValueError: One does not.
        """
        _require_rising(self)


class Realism(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What the robot is not told. Planner, control and agent go on assuming what the rest of the scenario says.

    Each item is a number, or an interval `[least, largest]` from which the seed of an episode draws; without it, that
    of the profile. Success is always judged by the true pose of the box.
    """

    profile: Profile = "ideal"
    """`ideal`: everything is as assumed, and perceived exactly. `real`: see `docs/realism.md`."""
    motor_strength: Item[MotorStrength] = None
    """Gains and torques of all servos, as a multiple of those of the robot."""
    joint_friction_n_m: Item[JointFriction] = None
    """Dry friction of each joint, beyond the robot's viscous damping."""
    payload_kg: Item[Payload] = None
    """Mass that the trunk carries."""
    payload_x_m: Item[Place] = None
    """Where it is, from the middle of the trunk: forward,"""
    payload_y_m: Item[Place] = None
    """to the left,"""
    payload_z_m: Item[Place] = None
    """and up."""
    com_x_m: Item[ComOffset] = None
    """Where the trunk's own centre of mass is, from where it is taken to be: forward,"""
    com_y_m: Item[ComOffset] = None
    """to the left,"""
    com_z_m: Item[ComOffset] = None
    """and up."""
    foot_friction: Item[FootFriction] = None
    """Sliding friction coefficient of feet and floor, in the place of `robot.legs.foot_friction`."""
    slope_deg: Item[HiddenSlope] = None
    """Inclination of the floor beyond that of the room."""
    uphill_deg: Item[Direction] = None
    """The direction in which it rises, about z from the x axis of the world."""
    command_latency_s: Item[CommandLatency] = None
    """From a command to its servo, in whole physics steps of 2 ms."""
    gusts: Gusts = Gusts()
    floor: FloorTiles = FloorTiles()
    box_pose: PoseSensor = PoseSensor()
    """How the pose of the box in the world is perceived, by control and agent."""
    localization: PoseSensor = PoseSensor()
    """How the robot is located in the world. From one measurement to the next it measures its own motion."""
    imu: ImuSensor = ImuSensor()
    """With noise, bias or latency of any sensor of the robot itself, its motion is estimated from all of them."""
    encoders: JointEncoders = JointEncoders()
    foot_forces: FootForceSensors = FootForceSensors()
    sensor_latency_s: Item[SensorLatency] = None
    """From a reading of imu, encoders and foot forces until it is given, in whole physics steps of 2 ms."""

    def __post_init__(self) -> None:
        """Check that places have a mass, and a direction its slope.

        Raises:
            ValueError: They do not.
        """
        _require_rising(self)
        _require_with(self, "payload_kg", ("payload_x_m", "payload_y_m", "payload_z_m"))
        _require_with(self, "slope_deg", ("uphill_deg",))
