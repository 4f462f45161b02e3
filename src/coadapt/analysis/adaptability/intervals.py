"""Confidence intervals by profile likelihood.

An interval holds the values ``t`` of a parameter that a likelihood-ratio test does not refuse:

    2 (max log L - max log L given t)  <=  c,

with ``c`` the quantile of the chi-squared distribution with one degree of freedom, 3.84 for 95 %.
Such an interval needs no standard error, never leaves the range of the parameter and may end at its
border.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt

LEVEL = 0.95

PRECISION = 1e-5
"""To which an end of an interval is computed."""


@dataclass(frozen=True)
class Interval:
    """An estimate with its confidence interval.

    Attributes:
        estimate: the most likely value.
        low, high: the ends.
        level: of confidence, for example 0.95.
    """

    estimate: float
    low: float
    high: float
    level: float

    def covers(self, value: float) -> bool:
        """Whether ``value`` lies in it; the ends, as precisely as they are known, belong to it."""
        return self.low - PRECISION <= value <= self.high + PRECISION


def profile_interval(
    log_likelihood: Callable[[float], float],
    estimate: float,
    best: float,
    borders: tuple[float, float],
    level: float = LEVEL,
) -> Interval:
    """The interval of a parameter whose most likely value is known.

    Args:
        log_likelihood: the largest log likelihood (nats) given a value of the parameter.
        estimate: the most likely value.
        best: its log likelihood.
        borders: the smallest and the largest value to consider.
        level: of confidence.

    Raises:
        ValueError: if the level is not between 0 and 1.
    """
    # Imported now: only who fits need wait for it.
    from scipy.optimize import brentq  # noqa: PLC0415
    from scipy.special import chdtri  # noqa: PLC0415

    if not 0 < level < 1:
        raise ValueError(f"the level of confidence must lie between 0 and 1, not {level}")
    wanted = sqrt(float(chdtri(1.0, 1.0 - level)))

    def excess(value: float) -> float:
        # The root of the ratio is nearly straight. Without end it would tell a search nothing.
        ratio = min(2.0 * (best - log_likelihood(value)), 1e6)
        return sqrt(max(ratio, 0.0)) - wanted

    def end(border: float) -> float:
        if estimate == border or excess(border) <= 0:
            return border
        if excess(estimate) > 0:  # by rounding, or a level near 0
            return estimate
        return float(brentq(excess, estimate, border, xtol=PRECISION))

    return Interval(estimate, end(borders[0]), end(borders[1]), level)
