"""Poses that are measured with noise, at a rate, late, and not always."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from legpush.arrays import Floats
from legpush.realism.reality import BOX_STREAM, EXACT, Reality
from legpush.scenarios.file import load_scenario
from sim_proc.perception import Perception, PoseSensor, planar

BOX = load_scenario("push").box


def qpos_at(tick: int) -> Floats:
    """Robot and box on straight ways: 1 cm and 2 cm each tick."""
    qpos = np.zeros(26)
    qpos[[0, 3]] = 0.01 * tick, 1.0
    qpos[[19, 21, 22]] = 5.0 + 0.02 * tick, 0.2, 1.0
    return qpos


def at_the_box(qpos: Floats) -> Floats:
    """Feet (n, 4, 3) in the middle of the box, so that they may move it all the time."""
    return np.repeat(qpos[:, None, 19:22], 4, axis=1)


def run(reality: Reality, n_ticks: int) -> list[tuple[float, int]]:
    """Perceived x of the box, and when it was measured, after each tick."""
    perception, found = Perception(reality, qpos_at(0), BOX), []
    for tick in range(1, n_ticks + 1):
        perception.take(tick, qpos_at(tick)[None], at_the_box(qpos_at(tick)[None]))
        seen = perception.perceived(qpos_at(tick), tick)
        assert seen is not None
        found.append((seen.box.position_m[0], seen.box_tick))
    return found


def test_exact_perception_gives_the_truth_and_has_no_state() -> None:
    perception = Perception(Reality(), qpos_at(0), BOX)
    perception.take(1, qpos_at(1)[None], at_the_box(qpos_at(1)[None]))
    assert perception.perceived(qpos_at(1), 1) is None
    assert perception.place_of_world() is None
    assert perception.as_bytes() == b""
    assert (perception.box(qpos_at(1)) == qpos_at(1)[19:]).all()


def test_measurements_come_at_their_rate_and_late() -> None:
    found = run(Reality(box_pose=replace(EXACT, rate_hz=10.0, latency_s=0.05)), 20)
    # Measured every 5 ticks, given 3 ticks later, which is the first whole number after 0.05 s.
    assert [tick for _, tick in found] == [0] * 7 + [5] * 5 + [10] * 5 + [15] * 3
    assert all(x == pytest.approx(5.0 + 0.02 * tick) for x, tick in found)


def test_lost_measurements_leave_the_last_one() -> None:
    found = run(Reality(box_pose=replace(EXACT, rate_hz=50.0, dropouts=0.5)), 400)
    made = {tick for _, tick in found}
    assert 150 <= len(made) <= 250
    assert all(before <= after for (_, before), (_, after) in pairwise(found))


def test_noise_has_its_standard_deviation_and_no_bias() -> None:
    sensor, errors = PoseSensor(replace(EXACT, noise_m=0.01), 3, BOX_STREAM, qpos_at(0)[19:]), np.empty(1000)
    for tick, _ in enumerate(errors):
        sensor.pass_tick(tick + 1, qpos_at(tick + 1)[19:])
        errors[tick] = sensor.known.seen.x_m - (5.0 + 0.02 * sensor.known.tick)
    assert errors.std() == pytest.approx(0.01, rel=0.1)
    assert abs(errors.mean()) < 0.001


@given(split=st.integers(1, 59), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=25, deadline=None)
def test_runs_may_be_split_anywhere(split: int, seed: int) -> None:
    sensed = replace(EXACT, noise_m=0.01, noise_deg=1.0, rate_hz=7.0, latency_s=0.05, dropouts=0.3)
    reality = Reality(seed=seed, box_pose=sensed, localization=replace(sensed, rate_hz=2.0))
    rows = np.array([qpos_at(tick) for tick in range(1, 61)])
    tips = at_the_box(rows)
    tips[::2] += 1.0
    whole, parts = Perception(reality, qpos_at(0), BOX), Perception(reality, qpos_at(0), BOX)
    whole.take(1, rows, tips)
    parts.take(1, rows[:split], tips[:split])
    parts.take(1 + split, rows[split:], tips[split:])
    assert whole.as_bytes() == parts.as_bytes()


def test_between_localizations_the_robot_measures_its_own_motion() -> None:
    perception = Perception(Reality(seed=1, localization=replace(EXACT, noise_m=0.02, rate_hz=2.0)), qpos_at(0), BOX)
    offsets = []
    for tick in range(1, 76):
        perception.take(tick, qpos_at(tick)[None], at_the_box(qpos_at(tick)[None]))
        seen = perception.perceived(qpos_at(tick), tick)
        assert seen is not None
        offsets.append((round(seen.trunk.x_m - 0.01 * tick, 9), round(seen.trunk.y_m, 9)))
        place = perception.place_of_world()
        assert place is not None
        back = place @ seen.trunk
        assert (back.x_m, back.y_m) == pytest.approx((0.01 * tick, 0.0), abs=1e-9)
    assert len(set(offsets)) == 4


def test_a_turned_pose_keeps_height_and_tilt() -> None:
    perception = Perception(Reality(seed=2, box_pose=replace(EXACT, noise_deg=5.0)), qpos_at(0), BOX)
    seen = perception.box(qpos_at(0))
    assert seen[2] == 0.2
    assert planar(seen).yaw_rad != 0.0
    assert np.linalg.norm(seen[3:]) == pytest.approx(1.0)
