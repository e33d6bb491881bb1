"""Measures of several motions are put together as if they had been one."""

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.messages.measures import MAX_PAIRS, TORQUE_BINS, Measures, UnexpectedContact, merged, torque_quantiles
from tests.legpush.examples import MEASURES

OTHER = replace(
    MEASURES,
    n_steps=5,
    max_torques_n_m=(40.0, 1.0, 1.0) * 4,
    least_to_limits_rad=(0.1, 0.9, 0.9) * 4,
    min_support_margin_m=0.03,
    min_zmp_margin_m=-0.01,
    max_push_moment_n_m=None,
    landing_speeds_m_s=(0.2,),
    max_penetration_m=0.002,
    unexpected=(
        UnexpectedContact(first="FL_lower", second="wall_0", n_steps=1, max_force_n=9.0),
        UnexpectedContact(first="box", second="wall_1", n_steps=8, max_force_n=1.0),
    ),
)


def test_nothing_is_measured_of_no_motion() -> None:
    assert merged([]) is None


def test_one_motion_keeps_its_measures() -> None:
    assert merged([MEASURES]) == MEASURES


def test_counts_add_up_and_extremes_stay() -> None:
    both = merged([MEASURES, OTHER])
    assert both is not None
    assert (both.n_steps, both.n_footsteps, both.n_touchdowns, both.n_outside_support) == (25, 8, 10, 6)
    assert both.max_torques_n_m == (40.0, 20.0, 30.0) * 4
    assert both.least_to_limits_rad == (0.1, 0.5, -0.01) * 4
    assert both.n_at_torque_limit == (0, 2, 4) * 4
    assert (both.min_support_margin_m, both.min_zmp_margin_m) == (-0.02, -0.01)
    assert both.max_push_moment_n_m == 2.5
    assert both.positive_work_j == 25.0
    assert both.landing_speeds_m_s == (*MEASURES.landing_speeds_m_s, 0.2)
    assert both.max_penetration_m == 0.002
    assert sum(both.torque_counts[1]) == 160


def test_the_order_of_motions_matters_only_for_the_list_of_landings() -> None:
    one, other = merged([MEASURES, OTHER, OTHER]), merged([OTHER, OTHER, MEASURES])
    assert one is not None
    assert other is not None
    assert sorted(one.landing_speeds_m_s) == sorted(other.landing_speeds_m_s)
    assert replace(one, landing_speeds_m_s=()) == replace(other, landing_speeds_m_s=())


def test_contacts_of_the_same_parts_are_one_and_no_pair_is_lost() -> None:
    both = merged([MEASURES, OTHER])
    assert both is not None
    assert [(each.first, each.second, each.n_steps, each.max_force_n) for each in both.unexpected] == [
        ("box", "wall_1", 8, 1.0),
        ("FL_lower", "wall_0", 3, 9.0),
    ]
    many: list[Measures] = [
        replace(OTHER, unexpected=(replace(OTHER.unexpected[0], second=f"wall_{index}"),))
        for index in range(MAX_PAIRS + 10)
    ]
    all_of_them = merged(many)
    assert all_of_them is not None
    assert len(all_of_them.unexpected) == MAX_PAIRS + 10


@pytest.mark.parametrize("share", [0.5, 0.99, 0.999, 1.0])
def test_quantiles_of_torques_are_those_of_the_torques_within_a_bin(share: float) -> None:
    shares = np.random.default_rng(1).beta(2.0, 5.0, (3, 20_000))
    counts = [np.histogram(row, TORQUE_BINS, (0.0, 1.0))[0].tolist() for row in shares]
    measures = replace(MEASURES, torque_counts=tuple(map(tuple, counts)))
    exact = np.quantile(shares, share, axis=1)
    got = np.array(torque_quantiles(measures, share))
    assert ((got >= exact - 1e-3) & (got <= exact + 1 / TORQUE_BINS + 1e-3)).all()
