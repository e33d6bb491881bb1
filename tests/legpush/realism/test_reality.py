"""What the seed of an episode draws from `[realism]`."""

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import asdict, replace

from legpush.realism.reality import AS_ASSUMED, Reality, Senses, drawn_reality
from legpush.realism.settings import FloorTiles, FootForceSensors, Gusts, ImuSensor, PoseSensor, Realism

SEEDS = st.integers(0, 2**32 - 1)
WIDE = Realism(
    motor_strength=(0.5, 1.5),
    joint_friction_n_m=(0.0, 2.0),
    payload_kg=(1.0, 9.0),
    payload_x_m=(-0.2, 0.2),
    com_x_m=(-0.02, 0.02),
    com_y_m=(-0.02, 0.02),
    foot_friction=(0.4, 1.0),
    slope_deg=(0.0, 5.0),
    uphill_deg=(0.0, 360.0),
    command_latency_s=(0.0, 0.06),
    floor=FloorTiles(height_m=(0.01, 0.05), size_m=(0.2, 0.4)),
    imu=ImuSensor(gyro_bias_rad_s=(0.0, 0.002)),
    foot_forces=FootForceSensors(noise_n=(2.0, 4.0), bias_n=5.0),
    sensor_latency_s=(0.0, 0.04),
    box_pose=PoseSensor(noise_m=(0.0, 0.02), noise_deg=(0.0, 2.0), rate_hz=(5.0, 20.0)),
)


@given(seed=SEEDS)
@settings(max_examples=30, deadline=None)
def test_an_ideal_world_is_as_assumed_for_every_seed(seed: int) -> None:
    reality = drawn_reality(Realism(), seed)
    assert reality.ideal
    assert reality == Reality(seed=seed)


@given(seed=SEEDS)
@settings(max_examples=50, deadline=None)
def test_every_draw_lies_in_its_interval_and_a_seed_draws_the_same_again(seed: int) -> None:
    reality = drawn_reality(WIDE, seed)
    assert reality == drawn_reality(WIDE, seed)
    assert not reality.ideal
    assert 0.5 <= reality.motor_strength <= 1.5
    assert 1.0 <= reality.payload_kg <= 9.0
    assert all(abs(place) <= 0.2 for place in reality.payload_m)
    assert reality.foot_friction is not None
    assert 0.4 <= reality.foot_friction <= 1.0
    assert 0.01 <= reality.tile_height_m <= 0.05
    assert 5.0 <= reality.box_pose.rate_hz <= 20.0
    assert reality.localization.exact
    assert 0.0 <= reality.senses.gyro_bias_rad_s <= 0.002
    assert 2.0 <= reality.senses.force_noise_n <= 4.0
    assert reality.senses.force_bias_n == 5.0
    assert 0.0 <= reality.senses.latency_s <= 0.04


@given(seed=SEEDS, name=st.sampled_from(["motor_strength", "payload_kg", "command_latency_s", "foot_friction"]))
@settings(max_examples=30, deadline=None)
def test_an_item_that_is_fixed_changes_no_other_draw(seed: int, name: str) -> None:
    changes: dict[str, Any] = {name: 0.05 if name == "command_latency_s" else 1.0}
    drawn, fixed = (asdict(drawn_reality(one, seed)) for one in (WIDE, replace(WIDE, **changes)))
    assert {key for key in drawn if drawn[key] != fixed[key]} <= {name}


def test_two_items_are_drawn_apart() -> None:
    offsets = [drawn_reality(WIDE, seed).com_offset_m for seed in range(20)]
    assert len(set(offsets)) == 20
    assert all(x != y for x, y, _ in offsets)


def test_places_of_what_is_not_there_make_no_other_world() -> None:
    nothing = Realism(payload_kg=0.0, payload_x_m=0.2, slope_deg=0.0, uphill_deg=90.0)
    assert drawn_reality(nothing, 0) == AS_ASSUMED


def test_gusts_repeat_with_numbers_of_their_own() -> None:
    gusts = Gusts(force_n=(50.0, 150.0), duration_s=0.2, at_s=(1.0, 2.0), every_s=3.0, direction_deg=(0.0, 360.0))
    reality = drawn_reality(Realism(gusts=gusts), 4)
    begins_s = reality.gust_begins_s(0, 0.0)
    assert begins_s is not None
    assert 1.0 <= begins_s <= 2.0
    assert reality.gust_begins_s(1, begins_s) == pytest.approx(begins_s + 3.0)
    found = [reality.gust(index, 0.0) for index in range(10)]
    assert len({gust.force_n for gust in found}) == len({gust.direction_rad for gust in found}) == 10
    assert all(50.0 <= gust.force_n <= 150.0 for gust in found)
    assert drawn_reality(Realism(gusts=Gusts(force_n=10.0, duration_s=0.2)), 0).gust_begins_s(1, 0.0) is None
    assert Reality().gust_begins_s(0, 0.0) is None


def test_what_the_robot_feels_makes_the_world_no_other_one_but_it_is_not_ideal() -> None:
    reality = drawn_reality(Realism(sensor_latency_s=0.02), 0)
    assert reality.senses == Senses(latency_s=0.02)
    assert reality.as_assumed
    assert not reality.ideal
