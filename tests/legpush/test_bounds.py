"""Bounds of numbers: every number of messages and files has both, and what is beyond is refused with its range."""

import re
from collections.abc import Iterator
from copy import deepcopy
from math import inf, nextafter
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec import inspect
from msgspec.structs import replace

from legpush.bounds import MAX_APPEARING, MAX_OBSTACLES, MAX_OVERLAP
from legpush.errors import MessageError, ScenarioError
from legpush.fields import range_of
from legpush.history.entries import Acted, Planned
from legpush.messages import codec
from legpush.messages.schemas import MESSAGES
from legpush.messages.stepping import Reset, Trace
from legpush.scenarios.file import load_scenario
from legpush.scenarios.grid import CellSource, MapSource
from legpush.scenarios.maps.map_server import MapServerFile
from legpush.scene.plan_settings import Anytime, Smoothing
from legpush.scene.reference import Arcs, Left, Right, Sine, Straight
from legpush.scene.robot_body import Joints
from legpush.scene.scenario import MissionSettings, Scenario
from tests.legpush import examples
from tests.legpush.scenarios.small_scenario import plain_scenario, write
from tests.robots import ROBOT

Number = inspect.IntType | inspect.FloatType

MESSAGE_SIZE_SUFFICES: Final = {
    # Texts for people, keys, and bytes: a process hands them on and does no work that grows with them.
    *("Plan.reason", "Refusal.reason", "Status.phase", "Status.detail", "Status.waiting_for", "Status.numerics"),
    *("Copy.key", "Copy.payload", "Published.key", "Fact.media_type", "Fact.data"),
    # Batches for recorders, which pass over each entry once.
    *("Copies.copies", "Copies.published", "Copies.facts", "Reward.terms"),
    # One row per tick of a step, which the simulator decides about; the agent hands them on.
    *(f"Trace.{name}" for name in Trace.__struct_fields__),
    # In a file that its owner wrote.
    *("CellSource.grid_file", "MapSource.grid_file", "MapServerFile.image"),
}
"""Fields without a largest length of their own: they are bounded by the largest size of a message or a file."""


class Found(NamedTuple):
    """A part of a field that may need a bound."""

    field: str
    """Such as `Box.mass_kg`."""
    kind: inspect.Type


class Leaf(NamedTuple):
    """A number in an example."""

    steps: tuple[str | int, ...]
    """Keys and indices that lead to it."""
    field: str
    kind: Number

    def path(self) -> str:
        """The same place as errors write it."""
        return "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in self.steps)[1:]


def parts(kind: inspect.Type, field: str, seen: set[type]) -> Iterator[Found]:
    """Every part of a type, with the field that it belongs to; each record once."""
    yield Found(field, kind)
    match kind:
        case inspect.Metadata():
            yield from parts(kind.type, field, seen)
        case inspect.StructType() if kind.cls not in seen:
            seen.add(kind.cls)
            for each in kind.fields:
                yield from parts(each.type, f"{kind.cls.__name__}.{each.name}", seen)
        case inspect.UnionType():
            for variant in kind.types:
                yield from parts(variant, field, seen)
        case inspect.TupleType():
            for item in kind.item_types:
                yield from parts(item, field, seen)
        case inspect.VarTupleType():
            yield from parts(kind.item_type, field, seen)


def leaves(plain: Any, kind: inspect.Type, steps: tuple[str | int, ...] = (), field: str = "") -> Iterator[Leaf]:
    """The numbers of an example."""
    match kind:
        case inspect.IntType() | inspect.FloatType() if not isinstance(plain, list):
            yield Leaf(steps, field, kind)
        case inspect.StructType():
            for each in kind.fields:
                yield from leaves(plain[each.name], each.type, (*steps, each.name), f"{kind.cls.__name__}.{each.name}")
        case inspect.UnionType() if isinstance(plain, dict):
            tagged = [one for one in kind.types if isinstance(one, inspect.StructType)]
            (one,) = [one for one in tagged if one.tag_field is None or plain[one.tag_field] == one.tag]
            yield from leaves(plain, one, steps, field)
        case inspect.UnionType() if plain is not None:
            for variant in kind.types:
                yield from leaves(plain, variant, steps, field)
        case inspect.TupleType():
            for index, item in enumerate(kind.item_types):
                yield from leaves(plain[index], item, (*steps, index), field)
        case inspect.VarTupleType() if isinstance(plain, list):
            for index, value in enumerate(plain):
                yield from leaves(value, kind.item_type, (*steps, index), field)
        case inspect.Metadata():
            yield from leaves(plain, kind.type, steps, field)


def ends(kind: Number) -> tuple[float, float]:
    """The least and the largest value."""
    assert kind.ge is not None
    assert kind.le is not None
    return kind.ge, kind.le


def put(plain: Any, leaf: Leaf, value: float) -> Any:
    """The example with another number there."""
    changed = deepcopy(plain)
    node = changed
    for step in leaf.steps[:-1]:
        node = node[step]
    node[leaf.steps[-1]] = value
    return changed


FILES = (Scenario, CellSource, MapSource, MapServerFile, Acted, Planned)
FOUND = tuple(part for kind in (*MESSAGES, *FILES) for part in parts(inspect.type_info(kind), "", set()))
NUMBERS = tuple(part for part in FOUND if isinstance(part.kind, Number))

JOINTS = ROBOT.joints
TORQUE_LIMITED = replace(
    ROBOT,
    joints=Joints(
        hip_x=replace(JOINTS.hip_x, torque_by_angle=((0.0, 50.0),)),
        hip_y=replace(JOINTS.hip_y, torque_by_angle=((0.0, 50.0),)),
        knee=replace(JOINTS.knee, max_torque_n_m=60.0),
    ),
)
FULL_SCENARIO = replace(
    examples.SCENARIO,
    mission=MissionSettings(max_push_cycles=200),
    pushing=replace(examples.SCENARIO.pushing, face_change_m=0.5),
    planning=replace(examples.SCENARIO.planning, anytime=Anytime(), smoothing=Smoothing(max_deviation_m=1.0)),
    robot=TORQUE_LIMITED,
    realism=examples.REALISM,
    reference=Arcs(radius_m=1.0, segments=(Straight(length_m=1.0), Left(angle_deg=9.0), Right(angle_deg=9.0))),
)
SCENARIOS = (FULL_SCENARIO, replace(FULL_SCENARIO, reference=Sine(amplitude_m=0.4, wavelength_m=4.0)))
EXAMPLES: Final[dict[str, msgspec.Struct]] = {
    **examples.MESSAGES,
    **{f"reset to scenario {n}": Reset(scenario=one, seed=0) for n, one in enumerate(SCENARIOS)},
}


def test_every_number_of_messages_and_files_has_both_bounds() -> None:
    assert len(NUMBERS) > 150
    assert [field for field, kind in NUMBERS if range_of(kind) is None] == []


def test_every_text_and_array_has_a_largest_length_or_a_reason_to_have_none() -> None:
    sized = (inspect.StrType, inspect.BytesType, inspect.VarTupleType)
    unbounded = {
        field
        for field, kind in FOUND
        if isinstance(kind, sized) and kind.max_length is None and getattr(kind, "pattern", None) is None
    }
    assert unbounded == MESSAGE_SIZE_SUFFICES


def test_the_examples_have_every_number() -> None:
    covered = {
        leaf.field
        for one in EXAMPLES.values()
        for leaf in leaves(codec.unpack(codec.encode(one)), inspect.type_info(type(one)))
    }
    messages = {part.field for kind in MESSAGES for part in parts(inspect.type_info(kind), "", set())}
    assert {field for field, _ in NUMBERS if field in messages} == covered


def is_out_of_range(plain: Any, kind: type) -> bool:
    """Whether a number is refused because of its own bounds, not because fields have to fit one another."""
    try:
        codec.convert(plain, kind)
    except MessageError as error:
        return str(error).startswith(("Expected `int` ", "Expected `float` "))
    return False


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_number_at_a_bound_is_in_range_and_one_just_beyond_is_refused(name: str) -> None:
    example = EXAMPLES[name]
    plain, kind = codec.unpack(codec.encode(example)), type(example)
    n = 0
    for leaf in leaves(plain, inspect.type_info(kind)):
        for end, away in zip(ends(leaf.kind), (-1, 1), strict=True):
            n += 1
            assert not is_out_of_range(put(plain, leaf, end), kind)
            beyond = end + away if isinstance(leaf.kind, inspect.IntType) else nextafter(end, away * inf)
            with pytest.raises(MessageError) as refused:
                codec.convert(put(plain, leaf, beyond), kind)
            assert str(refused.value).endswith(f" - at `$.{leaf.path()}`")
            assert str(refused.value).startswith(("Expected `int` ", "Expected `float` "))
    assert n > 0


PLAIN_SCENARIOS = [msgspec.to_builtins(one) for one in SCENARIOS]
PLACES = [
    (plain, leaf)
    for plain in PLAIN_SCENARIOS
    for leaf in leaves(msgspec.json.decode(msgspec.json.encode(plain)), inspect.type_info(Scenario))
]


@given(place=st.sampled_from(PLACES), above=st.booleans(), data=st.data())
@settings(max_examples=150, deadline=None)
def test_a_number_beyond_its_bounds_is_refused_with_file_field_and_range(
    place: tuple[Any, Leaf], above: bool, data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    plain, leaf = place
    low, high = ends(leaf.kind)
    if isinstance(leaf.kind, inspect.IntType):
        value: float = data.draw(
            st.integers(int(high) + 1, 2**63 - 1) if above else st.integers(-(2**63), int(low) - 1)
        )
    else:
        value = data.draw(
            st.floats(min_value=high, exclude_min=True, allow_infinity=False)
            if above
            else st.floats(max_value=low, exclude_max=True, allow_infinity=False)
        )
    path = write(tmp_path_factory.mktemp("beyond"), without_nothing(put(as_lists(plain), leaf, value)))
    with pytest.raises(ScenarioError) as refused:
        load_scenario(path)
    word = "a whole number" if isinstance(leaf.kind, inspect.IntType) else "a number"
    where, _, fault = str(refused.value).partition(": ")
    assert re.fullmatch(rf"{path}:\d+", where)
    assert fault == f"at `{leaf.path()}`: expected {word} from {range_of(leaf.kind)}, got {value!r}"
    assert refused.value.exit_code == 2


def as_lists(plain: Any) -> Any:
    """The same with lists instead of tuples."""
    return msgspec.json.decode(msgspec.json.encode(plain))


def without_nothing(plain: Any) -> Any:
    """The same without fields that are None, which TOML lacks."""
    return {
        key: without_nothing(value) if isinstance(value, dict) else value
        for key, value in plain.items()
        if value is not None
    }


def blocks(n: int, apart_m: float, appears_at_s: float = 0.0) -> list[dict[str, float]]:
    """Small blocks at the far side of a small scenario's room."""
    return [
        {
            "x_min_m": 0.1 + i // 100 * apart_m,
            "x_max_m": 0.101 + i // 100 * apart_m,
            "y_min_m": 4.8 + i % 100 * apart_m,
            "y_max_m": 4.801 + i % 100 * apart_m,
            "appears_at_s": appears_at_s,
        }
        for i in range(n)
    ]


@pytest.mark.parametrize(
    ("obstacles", "more", "words"),
    [
        (blocks(MAX_OBSTACLES, 0.0015), 1, f"at `room.obstacles`: expected an array of length <= {MAX_OBSTACLES}"),
        (blocks(MAX_OVERLAP, 0.0), 1, f"at `room`: expected at most {MAX_OVERLAP} obstacles that overlap in one place"),
        (
            blocks(MAX_APPEARING, 0.0015, 1.0),
            1,
            f"at `room`: expected at most {MAX_APPEARING} obstacles with appears_at_s, got {MAX_APPEARING + 1}",
        ),
    ],
    ids=["number", "overlap", "appearing"],
)
def test_obstacles_that_the_physics_cannot_carry_are_refused_with_their_file(
    obstacles: list[dict[str, float]], more: int, words: str, tmp_path: Path
) -> None:
    plain = plain_scenario()
    plain["room"]["obstacles"] = obstacles
    assert len(load_scenario(write(tmp_path, plain)).room.obstacles) == len(obstacles)
    plain["room"]["obstacles"] = obstacles + more * obstacles[-1:]
    with pytest.raises(ScenarioError) as refused:
        load_scenario(write(tmp_path, plain))
    assert re.fullmatch(rf"{tmp_path / 'small.toml'}:\d+: {re.escape(words)}.*", str(refused.value))
