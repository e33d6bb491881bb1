"""The terms by which w1 and w2 change a push: zero at the usual curve, and a quadratic polynomial around it."""

import numpy as np

from agent_proc.push_model.curve_terms import CURVE_TERMS, curve_terms


def test_the_usual_curve_changes_nothing() -> None:
    assert [float(term) for term in curve_terms(np.array(0.5), np.array(0.5))] == [0.0] * len(CURVE_TERMS)


def test_terms_are_those_that_they_are_called() -> None:
    w1, w2 = np.array([0.0, 1.0, 0.7]), np.array([0.25, 0.5, 1.0])
    named = {"w1": w1 - 0.5, "w2": w2 - 0.5}
    expected = [np.prod([named[factor] for factor in term.split()], axis=0) for term in CURVE_TERMS]
    np.testing.assert_allclose(curve_terms(w1, w2), expected)
