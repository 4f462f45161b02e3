"""Scores and coefficients of scales."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.analysis.scales import cronbach, reliability, scores, spearman_brown, turned
from coadapt.analysis.tests import CannotTest

NAN = float("nan")


def test_scores_are_means_of_what_was_answered() -> None:
    ratings = np.array([[1, 2, 3, 4], [5, 5, NAN, NAN], [5, NAN, NAN, NAN], [NAN] * 4], dtype=float)
    # Half of the items must be there.
    np.testing.assert_array_equal(scores(ratings), [2.5, 5.0, NAN, NAN])


@given(st.integers(2, 11), st.data())
def test_turning_twice_changes_nothing(points: int, data: st.DataObject) -> None:
    row = st.lists(st.integers(1, points), min_size=3, max_size=3)
    ratings = np.array(data.draw(st.lists(row, min_size=1, max_size=5)), dtype=float)
    which = data.draw(st.lists(st.booleans(), min_size=3, max_size=3))
    once = turned(ratings, which, points)
    assert ((once >= 1) & (once <= points)).all()
    np.testing.assert_array_equal(turned(once, which, points), ratings)


def test_alpha_by_hand() -> None:
    # Item variances 1 and 1, variance of the sums 3: α = 2 (1 - 2/3); r = .5, ρ = 2 · .5 / 1.5.
    ratings = np.array([[1, 1], [2, 3], [3, 2]], dtype=float)
    assert cronbach(ratings).value == pytest.approx(2 / 3)
    ratings = np.array([[1, 1], [2, 3], [3, 2], [2, 2]], dtype=float)
    r = np.corrcoef(ratings.T)[0, 1]
    assert spearman_brown(ratings).value == pytest.approx(2 * r / (1 + r))
    # Both items vary equally, so both coefficients are the same.
    assert spearman_brown(ratings).value == pytest.approx(cronbach(ratings).value)


@pytest.mark.parametrize(
    ("ratings", "says"),
    [
        ([[1], [2], [3]], "one item alone"),
        ([[1, 2], [2, 3]], "needs 3 participants"),
        ([[3, 3], [3, 3], [3, 3]], "the same sum"),
        ([[1, 5], [5, 1], [3, 3]], "the same sum"),
    ],
)
def test_no_alpha(ratings: list[list[int]], says: str) -> None:
    with pytest.raises(CannotTest, match=says):
        cronbach(np.array(ratings, dtype=float))


@pytest.mark.parametrize(
    ("ratings", "says"),
    [
        ([[1, 2], [2, 3], [3, 4]], "needs 4 participants"),
        ([[1, 3], [2, 3], [3, 3], [4, 3]], "the same rating from all"),
        ([[1, 2], [2, 3], [3, 4], [4, 5]], "exactly the same"),
    ],
)
def test_no_spearman_brown(ratings: list[list[int]], says: str) -> None:
    with pytest.raises(CannotTest, match=says):
        spearman_brown(np.array(ratings, dtype=float))


def test_what_is_missing_is_said() -> None:
    ratings = np.array([[3, 3, 5], [3, 4, 5], [3, 2, NAN], [3, 5, 4], [3, 1, 2]], dtype=float)
    found = reliability("x", ("a", "b", "c"), ratings, 5)
    assert (found.n, found.dropped) == (4, 1)
    assert [item.missing for item in found.items] == [0, 0, 1]
    assert found.items[0].rest is None  # does not vary
    assert found.items[2].highest == pytest.approx(2 / 4)
    assert any("1 of 5 left out" in note for note in found.notes)


def test_items_against_each_other_are_told() -> None:
    ratings = np.array([[1, 5], [2, 4], [5, 2], [4, 1], [3, 3]], dtype=float)
    found = reliability("x", ("a", "b"), ratings, 5)
    assert found.alpha is not None and found.alpha.value < 0
    assert any("is one of them reversed?" in note for note in found.notes)
