"""Scales of rated items: scores, and how well the items of a scale go together.

    α = k / (k - 1) · (1 - Σ var(item) / var(sum))                 Cronbach (1951)
    1 - (1 - α) · F(.975; n - 1, (n - 1)(k - 1)) is its lower limit, Feldt (1965)
    ρ = 2 r / (1 + r)           Spearman and Brown's reliability of two items (Eisinga et al. 2013)

A matrix of ratings has a row for each participant and a column for each item; NaN is a missing
answer.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec
import numpy as np
from scipy import stats

from coadapt.analysis.tests.result import LEVEL, Effect
from coadapt.analysis.tests.samples import CannotTest
from coadapt.arrays import FloatArray

LEAST_ANSWERED = 0.5
"""Share of the items that must be answered for a score."""


class ItemStatistics(msgspec.Struct, frozen=True, kw_only=True):
    """An item in numbers, turned round if it is reversed.

    Attributes:
        name: of the item.
        n, missing: number of ratings, and of those missing.
        mean, sd: of the ratings; None where there are too few.
        lowest, highest: shares of the ratings at the ends of the scale.
        rest: correlation with the sum of the other items; None where either does not vary.
        alpha_without: α of the scale without this item; None where there is none.
    """

    name: str
    n: int
    missing: int
    mean: float | None
    sd: float | None
    lowest: float | None
    highest: float | None
    rest: float | None
    alpha_without: float | None


class Reliability(msgspec.Struct, frozen=True, kw_only=True):
    """How well the items of a scale go together.

    Attributes:
        scale: its name.
        n: participants who answered all items; the coefficients rest on them.
        dropped: participants who did not.
        alpha: Cronbach's, or None.
        spearman_brown: of scales of two items, or None.
        items: each item in numbers, from all ratings of it.
        notes: why a coefficient is missing, and what else there is to say.
    """

    scale: str
    n: int
    dropped: int
    alpha: Effect | None
    spearman_brown: Effect | None
    items: tuple[ItemStatistics, ...]
    notes: tuple[str, ...]


def turned(ratings: FloatArray, is_reversed: Sequence[bool], points: int) -> FloatArray:
    """Ratings from 1 to ``points`` with those of reversed items turned round."""
    return np.where(np.asarray(is_reversed, dtype=bool), points + 1 - ratings, ratings)


def scores(ratings: FloatArray) -> FloatArray:
    """The mean of each participant's ratings; NaN if fewer than half of the items were answered.

    Args:
        ratings: turned round where needed.  # [participants, items]
    """
    answered = np.isfinite(ratings)
    count = answered.sum(axis=1)
    total = np.where(answered, ratings, 0.0).sum(axis=1)
    usable = count >= max(1, math.ceil(LEAST_ANSWERED * ratings.shape[1]))
    return np.where(usable, total / np.maximum(count, 1), np.nan)


def reliability(scale: str, names: Sequence[str], ratings: FloatArray, points: int) -> Reliability:
    """The coefficients of a scale and its items in numbers.

    Args:
        scale: its name.
        names: of its items.
        ratings: turned round where needed.  # [participants, items]
        points: number of points of the scale.
    """
    complete = ratings[np.isfinite(ratings).all(axis=1)]
    notes: list[str] = []
    alpha, brown = None, None
    try:
        alpha = cronbach(complete)
    except CannotTest as reason:
        notes.append(f"No α: {reason}.")
    if len(names) == 2:
        try:
            brown = spearman_brown(complete)
        except CannotTest as reason:
            notes.append(f"No Spearman-Brown coefficient: {reason}.")
    if alpha is not None and alpha.value < 0:
        notes.append("α is below 0: items go against each other; is one of them reversed?")
    dropped = len(ratings) - len(complete)
    if dropped:
        notes.append(f"{dropped} of {len(ratings)} left out of the coefficients: answers missing.")
    return Reliability(
        scale=scale,
        n=len(complete),
        dropped=dropped,
        alpha=alpha,
        spearman_brown=brown,
        items=tuple(_item(name, i, ratings, complete, points) for i, name in enumerate(names)),
        notes=tuple(notes),
    )


def cronbach(ratings: FloatArray, level: float = LEVEL) -> Effect:
    """Cronbach's α with Feldt's interval.

    Args:
        ratings: complete.  # [participants, items]
        level: of the interval.

    Raises:
        CannotTest: if there is one item alone, there are fewer than 3 participants, or their sums
            are
            all the same.
    """
    n, k = ratings.shape
    if k < 2:
        raise CannotTest("one item alone goes together with nothing")
    if n < 3:
        raise CannotTest(f"needs 3 participants who answered all items, found {n}")
    total = float(np.var(ratings.sum(axis=1), ddof=1))
    if total == 0:
        raise CannotTest("all participants have the same sum")
    alpha = k / (k - 1) * (1 - float(np.var(ratings, axis=0, ddof=1).sum()) / total)
    tail, df1, df2 = (1 - level) / 2, n - 1, (n - 1) * (k - 1)
    low, high = (1 - (1 - alpha) * float(stats.f.ppf(q, df1, df2)) for q in (1 - tail, tail))
    return Effect(name="α", value=alpha, low=low, high=high, level=level, method="Feldt (1965)")


def spearman_brown(ratings: FloatArray, level: float = LEVEL) -> Effect:
    """Spearman and Brown's coefficient of two items; the interval is Fisher's of their correlation.

    Args:
        ratings: complete.  # [participants, 2]
        level: of the interval.

    Raises:
        CannotTest: if there are fewer than 4 participants, an item does not vary, or the two always
            differ by the same.
    """
    n = len(ratings)
    if n < 4:
        raise CannotTest(f"needs 4 participants who answered both items, found {n}")
    r = _correlation(ratings[:, 0], ratings[:, 1])
    if r is None:
        raise CannotTest("an item has the same rating from all")
    if abs(r) > 1 - 1e-12:
        raise CannotTest("the two items say exactly the same")
    width = float(stats.norm.isf((1 - level) / 2)) / math.sqrt(n - 3)
    low, value, high = (
        2 * c / (1 + c)
        for c in (math.tanh(math.atanh(r) - width), r, math.tanh(math.atanh(r) + width))
    )
    return Effect(name="ρ", value=value, low=low, high=high, level=level, method="Fisher's z")


def _item(
    name: str, i: int, ratings: FloatArray, complete: FloatArray, points: int
) -> ItemStatistics:
    given = ratings[np.isfinite(ratings[:, i]), i]
    others = np.delete(complete, i, axis=1)
    without = None
    if others.shape[1] >= 2:
        try:
            without = cronbach(others).value
        except CannotTest:
            without = None
    n = len(given)
    return ItemStatistics(
        name=name,
        n=n,
        missing=len(ratings) - n,
        mean=float(given.mean()) if n else None,
        sd=float(np.std(given, ddof=1)) if n > 1 else None,
        lowest=float((given == 1).mean()) if n else None,
        highest=float((given == points).mean()) if n else None,
        rest=_correlation(complete[:, i], others.sum(axis=1)) if others.shape[1] else None,
        alpha_without=without,
    )


def _correlation(a: FloatArray, b: FloatArray) -> float | None:
    """Pearson's; None where it is not defined."""
    if len(a) < 3 or np.ptp(a) == 0 or np.ptp(b) == 0:
        return None
    return float(np.corrcoef(a, b)[0, 1])
