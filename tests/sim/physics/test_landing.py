"""Touchdowns that end a swing: on a floor where it was expected, higher, lower, and on none."""

from collections.abc import Callable

import numpy as np
import pytest

from legpush.arrays import Floats
from legpush.errors import MotionError
from legpush.geometry import Pose2
from legpush.scene.conventions import LEGS
from legpush.scene.scenario import Scenario
from sim_proc.control.footsteps import GAIT_ORDER
from sim_proc.control.gait import PathWalk
from sim_proc.control.plant import TickLog, Touchdown
from sim_proc.control.posture import Posture
from sim_proc.control.steps import Steps
from sim_proc.control.swing import search_swing
from sim_proc.physics.landing import Landing
from sim_proc.physics.physics import Physics
from tests.robots import ROBOT
from tests.sim.commands import held
from tests.sim.floors import lay_tile

START = Pose2(x_m=2.0, y_m=3.0, yaw_rad=0.0)
FIRST = LEGS.index(GAIT_ORDER[0])
"""The leg that steps first."""
RADIUS_M = ROBOT.legs.foot_radius_m

Walking = tuple[Physics, PathWalk]
Walker = Callable[[], Walking]


@pytest.fixture
def walker(at_the_box: Scenario) -> Walker:
    """Makes a robot that stands on the floor, and begins a path of 1.5 m straight ahead."""

    def make() -> Walking:
        physics = Physics(at_the_box, START, at_the_box.box.pose.pose())
        Posture(physics).stand(25)
        ahead = [START @ Pose2(x_m=s, y_m=0.0, yaw_rad=0.0) for s in (0.0, 0.5, 1.0, 1.5)]
        return physics, PathWalk(Steps(Posture(physics)), ahead)

    return make


@pytest.fixture
def foothold_m(walker: Walker) -> Floats:
    """Where the foot of the first step comes down on a flat floor, (2,)."""
    _, walk = walker()
    place: Floats = walk.cycle()[0].tips_m[-1, FIRST, :2]
    return place


def first_cycle(walk: PathWalk) -> list[TickLog]:
    logs = walk.cycle()
    assert len(logs) == len(GAIT_ORDER)
    return logs


@pytest.mark.parametrize("top_m", [0.01, 0.02, 0.03])
def test_a_foot_that_meets_the_floor_early_ends_its_swing_there(
    top_m: float, foothold_m: Floats, walker: Walker, monkeypatch: pytest.MonkeyPatch
) -> None:
    n_flat = len(first_cycle(walker()[1])[0].qpos)
    lay_tile(monkeypatch, foothold_m, top_m)
    physics, walk = walker()

    log, *following = first_cycle(walk)

    assert len(log.qpos) < n_flat
    assert log.touched_down
    assert log.tips_m[-1, FIRST, 2] == pytest.approx(RADIUS_M + top_m, abs=0.004)
    stands = np.concatenate([part.tips_m for part in following])[:, FIRST, 2]
    assert np.abs(stands - RADIUS_M - top_m).max() < 0.003
    assert not physics.fallen


@pytest.mark.parametrize("top_m", [-0.01, -0.02, -0.03])
def test_a_foot_that_meets_the_floor_late_goes_on_down_and_no_other_is_lifted_before(
    top_m: float, foothold_m: Floats, walker: Walker, monkeypatch: pytest.MonkeyPatch
) -> None:
    n_flat = len(first_cycle(walker()[1])[0].qpos)
    lay_tile(monkeypatch, foothold_m, top_m)
    physics, walk = walker()

    log, *following = first_cycle(walk)

    expected = 1 + np.searchsorted(-search_swing(np.zeros(3), ROBOT.gait)[:, 2], -top_m)
    assert expected / 2 <= len(log.qpos) - n_flat <= expected + 1
    assert log.touched_down
    assert log.tips_m[-1, FIRST, 2] == pytest.approx(RADIUS_M + top_m, abs=0.004)
    others = np.delete(log.tips_m[:, :, 2], FIRST, axis=1)
    assert np.abs(others - RADIUS_M).max() < 0.003
    stands = np.concatenate([part.tips_m for part in following])[:, FIRST, 2]
    assert np.abs(stands - RADIUS_M - top_m).max() < 0.003
    assert not physics.fallen


def test_a_foot_that_finds_no_floor_goes_back_and_the_path_is_refused(
    foothold_m: Floats, walker: Walker, monkeypatch: pytest.MonkeyPatch
) -> None:
    lay_tile(monkeypatch, foothold_m, -0.4)
    physics, walk = walker()
    before = physics.tips_m().copy()

    logs = walk.cycle()

    assert not physics.fallen
    lowest = np.concatenate([log.tips_m for log in logs])[:, FIRST, 2].min()
    assert lowest == pytest.approx(ROBOT.touchdown_m - ROBOT.gait.search_depth_m, abs=0.01)
    np.testing.assert_allclose(physics.tips_m(), before, atol=0.01)
    assert np.linalg.norm(physics.data.qvel[:6]) < 0.05
    tick = physics.tick
    with pytest.raises(MotionError, match=r"at most 0\.05 m below the place of the foot RR at \(.*\), found none"):
        walk.cycle()
    assert physics.tick == tick


def test_equal_motions_on_a_floor_that_is_not_flat_end_in_equal_bits(
    foothold_m: Floats, walker: Walker, monkeypatch: pytest.MonkeyPatch
) -> None:
    lay_tile(monkeypatch, foothold_m, 0.02)
    crcs = []
    for _ in range(2):
        physics, walk = walker()
        first_cycle(walk)
        crcs.append(physics.state_crc())
    assert crcs[0] == crcs[1]


@pytest.mark.parametrize(("first_tick", "landing_tick", "n_ticks"), [(0, 9, 1), (4, 9, 5), (0, 0, 9)])
def test_a_run_ends_with_the_first_tick_in_which_a_touchdown_counts(
    walker: Walker, first_tick: int, landing_tick: int, n_ticks: int
) -> None:
    physics, _ = walker()
    commands = held(np.repeat(physics.joints_rad()[None], 9, axis=0))
    until = Touchdown(
        leg=0,
        force_n=20.0,
        first_tick=first_tick,
        landing_tick=landing_tick,
        lift_tick=0,
        carried=(),
        blocked_tick=0,
        stops_leg=False,
    )
    log = physics.run(commands, until)
    assert (len(log.qpos), log.touched_down) == (n_ticks, True)


def test_a_run_goes_on_to_its_end_without_the_force_of_a_touchdown(walker: Walker) -> None:
    physics, _ = walker()
    commands = held(np.repeat(physics.joints_rad()[None], 9, axis=0))
    until = Touchdown(
        leg=0, force_n=1e4, first_tick=0, landing_tick=9, lift_tick=0, carried=(), blocked_tick=9, stops_leg=True
    )
    log = physics.run(commands, until)
    assert (len(log.qpos), log.touched_down) == (9, False)


def test_a_leg_that_moves_fast_stops_within_a_step_of_its_touchdown(walker: Walker) -> None:
    physics, _ = walker()
    joints = physics.joints_rad()
    lower = joints.copy()
    lower[2] -= 0.05
    until = Touchdown(
        leg=0, force_n=20.0, first_tick=0, landing_tick=1, lift_tick=0, carried=(), blocked_tick=9, stops_leg=True
    )
    log = physics.run(held(np.stack([lower])), until)
    commanded = log.ctrl[0, :, 2]
    assert log.touched_down
    np.testing.assert_array_equal(commanded[1:], commanded[1])


@pytest.mark.parametrize(("carried", "n_ticks", "not_down"), [((), 5, 0), ((0,), 9, None)])
def test_a_run_ends_before_the_lift_of_a_foot_if_another_one_is_off_the_floor(
    walker: Walker, carried: tuple[int, ...], n_ticks: int, not_down: int | None
) -> None:
    physics, _ = walker()
    raised = physics.joints_rad()
    raised[2] += 0.1
    until = Touchdown(
        leg=FIRST,
        force_n=15.0,
        first_tick=9,
        landing_tick=9,
        lift_tick=5,
        carried=carried,
        blocked_tick=9,
        stops_leg=True,
    )
    log = physics.run(held(np.repeat(raised[None], 9, axis=0)), until)
    assert (len(log.qpos), log.not_down) == (n_ticks, not_down)


N_TICKS, BLOCKED_TICK = 20, 12


def blocked_from(late_steps: int, *, stops_at: int | None, offset_rad: float = 0.0) -> int | None:
    """The first tick in which a leg counts as stopped, whose joints follow late, until one of them stops at a step."""
    turns = 0.3 * np.sin(np.linspace(0.0, 3.0, 10 * N_TICKS))
    turns[10 * BLOCKED_TICK :] = turns[10 * BLOCKED_TICK] - 0.001 * np.arange(10 * (N_TICKS - BLOCKED_TICK))
    planned = np.repeat(turns[:, None], 12, axis=1)
    measured = planned[np.maximum(np.arange(len(planned)) - late_steps, 0)] + offset_rad
    if stops_at is not None:
        measured[stops_at:, 2] = measured[stops_at, 2]
    touchdown = Touchdown(
        leg=0,
        force_n=20.0,
        lift_tick=0,
        carried=(),
        first_tick=6,
        landing_tick=N_TICKS,
        blocked_tick=BLOCKED_TICK,
        stops_leg=True,
    )
    lag = slice(0, 12), planned.reshape(N_TICKS, 10, 12), np.full(12, 0.01)
    landing = Landing(touchdown, slice(12, 16, 1), planned.reshape(N_TICKS, 10, 12), lag)
    sensors = np.concatenate([measured, np.zeros((len(measured), 4))], axis=1).reshape(N_TICKS, 10, 16)
    return next((tick for tick in range(N_TICKS) if landing.touched_down(tick, sensors[tick])), None)


@pytest.mark.parametrize("late_steps", [0, 3, 30, 55])
def test_a_leg_that_follows_late_or_with_an_offset_is_not_blocked(late_steps: int) -> None:
    assert blocked_from(late_steps, stops_at=None) is None
    assert blocked_from(late_steps, stops_at=None, offset_rad=0.005) is None


@pytest.mark.parametrize("late_steps", [0, 30])
def test_a_leg_is_blocked_as_soon_as_one_joint_stays_behind_while_the_others_move_on(late_steps: int) -> None:
    assert blocked_from(late_steps, stops_at=150) == 16


@pytest.mark.parametrize(("sensed_late_steps", "until_lifted", "down_from"), [(0, 8, 6), (10, 8, 12), (10, 5, 6)])
def test_a_foot_that_is_known_late_is_not_down_before_it_has_been_lifted(
    sensed_late_steps: int, until_lifted: int, down_from: int
) -> None:
    touchdown = Touchdown(
        leg=0, force_n=20.0, lift_tick=2, carried=(), first_tick=6, landing_tick=20, blocked_tick=20, stops_leg=True
    )
    still = np.zeros((N_TICKS, 10, 12))
    lag = slice(0, 12), still, np.full(12, 0.01)
    landing = Landing(touchdown, slice(12, 16, 1), still, lag, late_steps=sensed_late_steps)
    sensors = np.zeros((N_TICKS, 10, 16))
    sensors[:, :, 12] = -80.0
    # It stands until it is lifted, or meets something high at once.
    sensors[until_lifted:12, :, 12] = 0.0 if until_lifted > 6 else sensors[until_lifted:12, :, 12]
    sensors[until_lifted, :, 12] = 0.0
    looked_at = range(5, N_TICKS)
    assert next(tick for tick in looked_at if landing.touched_down(tick, sensors[tick])) == down_from
