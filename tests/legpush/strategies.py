"""Hypothesis strategies for any record, made from its type annotations: every field, every bound, every variant."""

from functools import partial
from math import pi, radians
from typing import Any, TypeVar

from hypothesis import strategies as st
from msgspec import inspect
from msgspec.structs import replace

from legpush.bounds import LEAST_LENGTH_M, MAX_LENGTH_M
from legpush.realism.settings import (
    FloorTiles,
    FootForceSensors,
    Gusts,
    ImuSensor,
    JointEncoders,
    PoseSensor,
    Realism,
)
from legpush.scene.reference import Arcs, Sine, Straight
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, Rectangle
from legpush.scene.solid import steps_to_surface
from tests.robots import scaled_robot

T = TypeVar("T")
REALISM = Realism, Gusts, FloorTiles, PoseSensor, ImuSensor, JointEncoders, FootForceSensors
"""Records with intervals."""


def records(kind: type[T]) -> st.SearchStrategy[T]:
    """Records of this type."""
    return _of(inspect.type_info(kind))


def _of(info: inspect.Type) -> st.SearchStrategy[Any]:
    """Values of one annotated type."""
    match info:
        case inspect.BoolType():
            return st.booleans()
        case inspect.NoneType():
            return st.none()
        case inspect.LiteralType(values=values):
            return st.sampled_from(values)
        case inspect.IntType():
            return _integers(info)
        case inspect.FloatType():
            return _floats(info)
        case inspect.StrType(pattern=None):
            return st.text(max_size=20)
        case inspect.StrType():
            return st.text("abcXYZ019_-", min_size=1, max_size=64)
        case inspect.BytesType():
            return st.binary(min_size=info.min_length or 0, max_size=20)
        case inspect.TupleType():
            return st.tuples(*(_of(item) for item in info.item_types))
        case inspect.VarTupleType():
            shortest = info.min_length or 0
            longest = min(info.max_length or 4, shortest + 4)
            return st.lists(_of(info.item_type), min_size=shortest, max_size=longest).map(tuple)
        case inspect.UnionType():
            return st.one_of(*(_of(variant) for variant in info.types))
        case inspect.StructType(cls=cls) if cls is Rectangle:
            return st.builds(_rectangle, *(4 * [_COORDINATE]), st.floats(0.0, 1e6))
        case inspect.StructType(cls=cls, fields=fields) if cls is Box:
            return st.fixed_dictionaries({field.name: _of(field.type) for field in fields}).map(_box)
        case inspect.StructType(cls=cls) if cls is RobotSpec:
            return st.builds(_robot, st.floats(0.2, 3.0), st.floats(1.0, 100.0))
        case inspect.StructType(cls=cls, fields=fields) if cls is Sine:
            return st.fixed_dictionaries({field.name: _of(field.type) for field in fields}).map(_sine)
        case inspect.StructType(cls=cls, fields=fields) if cls is Arcs:
            return st.fixed_dictionaries({field.name: _of(field.type) for field in fields}).map(_arcs)
        case inspect.StructType(cls=cls, fields=fields) if cls in REALISM:
            return st.fixed_dictionaries({field.name: _of(field.type) for field in fields}).map(partial(_stated, cls))
        case inspect.StructType():
            return st.builds(info.cls, **{field.name: _of(field.type) for field in info.fields})
        case inspect.Metadata():
            return _of(info.type)
        case _:
            raise NotImplementedError(f"no strategy for {type(info).__name__}")


_COORDINATE = st.floats(-1e6, 1e6)


def _box(fields: dict[str, Any]) -> Box:
    """One that is round if it is a cylinder."""
    length_m, width_m, height_m = fields["size_m"]
    if fields["shape"] == "cylinder":
        width_m = length_m
    even = Box(**{**fields, "size_m": (length_m, width_m, height_m), "com_offset_m": (0.0, 0.0, 0.0)})
    offset = fields["com_offset_m"]
    share = 0.8 * steps_to_surface(even.shape, even.size_m, offset)
    return replace(even, com_offset_m=tuple(part * min(share, 1.0) for part in offset))


def _robot(scale: float, max_torque_n_m: float) -> RobotSpec:
    """One whose legs reach its stance."""
    robot = scaled_robot(scale)
    knee = replace(robot.joints.knee, max_torque_n_m=max_torque_n_m)
    return replace(robot, joints=replace(robot.joints, knee=knee))


def _stated(cls: type[Any], fields: dict[str, Any]) -> Any:
    """A record of `[realism]` whose intervals rise, without fields that need another one."""
    rising = {name: tuple(sorted(value)) if isinstance(value, tuple) else value for name, value in fields.items()}
    needed = {"payload_x_m", "payload_y_m", "payload_z_m", "uphill_deg", "size_m", "every_s"}
    if rising.get("force_n") is None or rising.get("duration_s") is None:
        needed |= {"force_n", "duration_s", "at_s", "direction_deg"}
    return cls(**{name: None if name in needed else value for name, value in rising.items()})


def _sine(fields: dict[str, Any]) -> Sine:
    """One of as many periods as its length allows."""
    amplitude_m, wavelength_m, n_periods = fields["amplitude_m"], fields["wavelength_m"], fields["n_periods"]
    most = 0.99 * MAX_LENGTH_M / (wavelength_m + 2 * pi * amplitude_m)
    return Sine(amplitude_m=amplitude_m, wavelength_m=wavelength_m, n_periods=min(n_periods, most))


def _arcs(fields: dict[str, Any]) -> Arcs:
    """One that is made smaller if it is too long."""
    radius_m, segments = fields["radius_m"], fields["segments"]
    length_m = sum(
        each.length_m if isinstance(each, Straight) else radius_m * radians(each.angle_deg) for each in segments
    )
    scale = min(1.0, 0.99 * MAX_LENGTH_M / length_m)
    return Arcs(
        radius_m=max(radius_m * scale, LEAST_LENGTH_M),
        segments=tuple(
            Straight(length_m=max(each.length_m * scale, LEAST_LENGTH_M)) if isinstance(each, Straight) else each
            for each in segments
        ),
    )


def _rectangle(x_m: float, y_m: float, length_m: float, width_m: float, appears_at_s: float) -> Rectangle:
    """One with an area, which no choice of its fields one by one ensures."""
    x_max_m, y_max_m = x_m + abs(length_m) + 1.0, y_m + abs(width_m) + 1.0
    return Rectangle(x_min_m=x_m, x_max_m=x_max_m, y_min_m=y_m, y_max_m=y_max_m, appears_at_s=appears_at_s)


def _integers(info: inspect.IntType) -> st.SearchStrategy[int]:
    least = info.ge if info.ge is not None else -(2**63)
    most = info.le if info.le is not None else (info.lt - 1 if info.lt is not None else 2**63 - 1)
    return st.integers(least, most)


def _floats(info: inspect.FloatType) -> st.SearchStrategy[float]:
    return st.floats(
        min_value=info.gt if info.gt is not None else info.ge,
        max_value=info.lt if info.lt is not None else info.le,
        exclude_min=info.gt is not None,
        exclude_max=info.lt is not None,
        allow_nan=False,
        allow_infinity=False,
    )
