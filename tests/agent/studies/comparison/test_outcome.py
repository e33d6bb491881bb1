import numpy as np
import pytest

from agent_proc.evaluation.loss import MOST
from agent_proc.statistics.aggregate import OVER_BOTH, OVER_STARTS
from agent_proc.statistics.intervals import WILSON

from .parts import N_STARTS, outcome, rows


def test_each_contestant_has_its_means_over_trainings_and_starts() -> None:
    learned, scripted, constant = outcome().entries
    assert (learned.n_trainings, learned.n_starts) == (2, 2 * N_STARTS)
    of_learned = [row["position_error_m"] for row in rows() if row["policy"] in ("a", "b")]
    assert learned.means["position_error_m"].value == pytest.approx(np.mean(of_learned))
    assert learned.means["position_error_m"].kind == OVER_BOTH
    assert scripted.means["position_error_m"].kind == OVER_STARTS
    assert (constant.falls, learned.falls) == (2, 0)
    assert constant.means["success"].value == pytest.approx(1 - 2 / N_STARTS)
    assert constant.loss_profile[-1].value == pytest.approx(1 - 2 / N_STARTS), "a failure never counts as near"
    assert constant.means["loss"].value > 2 / N_STARTS * MOST


def test_a_success_each_time_is_no_certainty() -> None:
    success = outcome().entries[0].means["success"]
    assert (success.value, success.kind, success.n) == (1.0, WILSON, 2 * N_STARTS)
    assert success.low is not None
    assert success.low < 0.9


def test_differences_and_improvements_are_from_the_one_that_was_named() -> None:
    made = outcome()
    assert [each.label for each in made.versus] == ["learned", "constant"]
    learned, constant = made.versus
    assert learned.differences["position_error_m"].value == pytest.approx(0.0, abs=1e-12)
    assert learned.improvement.value == pytest.approx(0.5)
    assert constant.improvement.value == 0.0
    low = constant.differences["position_error_m"].low
    assert low is not None
    assert low > 0.0
