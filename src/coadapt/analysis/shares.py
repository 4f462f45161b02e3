"""Confidence intervals of shares."""

from __future__ import annotations


def share_interval(count: int, total: int, level: float = 0.95) -> tuple[float, float]:
    """The interval of a probability by Clopper and Pearson, from ``count`` of ``total``.

    Raises:
        ValueError: if the count is not one of 0 to ``total``, or there is nothing to count.
    """
    # Imported now: only who needs statistics need wait for it.
    from scipy.stats import binomtest  # noqa: PLC0415

    if total < 1 or not 0 <= count <= total:
        raise ValueError(f"{count} of {total} is no share")
    found = binomtest(count, total).proportion_ci(confidence_level=level, method="exact")
    return float(found.low), float(found.high)
