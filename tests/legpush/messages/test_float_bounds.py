"""Which types refuse every number that is not finite by their bounds alone; all messages do."""

from typing import Annotated, Any, Literal

import msgspec
import pytest
from msgspec import Meta, Struct

from legpush.bounds import Count, Reading
from legpush.messages.float_bounds import bounds_every_float
from legpush.messages.schemas import MESSAGES

AtLeast = Annotated[float, Meta(ge=0.0)]
AtMost = Annotated[float, Meta(le=1.0)]
Between = Annotated[float, Meta(gt=0.0, lt=1.0)]


class Inner(Struct):
    """A record in a record."""

    value: float


class Outer(Struct):
    """Holds it."""

    rows: tuple[Inner, ...]


class Itself(Struct):
    """A record that holds records of its own type."""

    value: Reading
    children: "tuple[Itself, ...]"


@pytest.mark.parametrize(
    "kind", [Reading, Between, tuple[Reading, Between], Count | None, str, bytes, bool, Literal["a"], Itself]
)
def test_floats_with_both_bounds_and_what_is_no_float(kind: Any) -> None:
    assert bounds_every_float(kind)


@pytest.mark.parametrize(
    "kind",
    [
        float,
        AtLeast,
        AtMost,
        tuple[Reading, float],
        tuple[float, ...],
        float | None,
        Outer,
        Any,
        dict[str, float],
        list[float],
    ],
)
def test_a_float_without_both_bounds_and_what_may_hold_one(kind: Any) -> None:
    assert not bounds_every_float(kind)


@pytest.mark.parametrize("kind", MESSAGES)
def test_every_message_bounds_its_floats(kind: Any) -> None:
    assert bounds_every_float(kind)


@pytest.mark.parametrize("kind", [Reading, Between])
@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_bounds_refuse_what_is_not_finite(kind: Any, value: float) -> None:
    with pytest.raises(msgspec.ValidationError):
        msgspec.msgpack.decode(msgspec.msgpack.encode(value), type=kind)
