"""Corrections of p for several comparisons. Their number is always said."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import msgspec

from coadapt.analysis.tests import apa
from coadapt.analysis.tests.result import Found, TestResult

Correction = Literal["none", "bonferroni", "holm"]


def adjusted(values: Sequence[float], correction: Correction) -> tuple[float, ...]:
    """Each p after the correction for ``len(values)`` comparisons.

    Bonferroni multiplies each by their number. Holm multiplies the smallest by it, the next by one
    less, and so on, and lets none be smaller than one before it (Holm 1979).
    """
    count = len(values)
    if correction == "none":
        return tuple(values)
    if correction == "bonferroni":
        return tuple(min(1.0, count * p) for p in values)
    found, largest = [0.0] * count, 0.0
    for rank, i in enumerate(sorted(range(count), key=lambda i: values[i])):
        largest = max(largest, min(1.0, (count - rank) * values[i]))
        found[i] = largest
    return tuple(found)


def correct(results: Sequence[Found], correction: Correction) -> tuple[Found, ...]:
    """The results with ``p`` corrected for their number; those not tested count, too."""
    comparisons = len(results)
    # What could not be tested takes its place in the count, as if it had found nothing.
    values = [r.p if isinstance(r, TestResult) else 1.0 for r in results]
    changed = adjusted(values, correction)
    return tuple(
        _changed(r, p, comparisons, correction) if isinstance(r, TestResult) else r
        for r, p in zip(results, changed, strict=True)
    )


def _changed(result: TestResult, p: float, comparisons: int, correction: Correction) -> TestResult:
    if correction == "none" or comparisons == 1:
        return msgspec.structs.replace(result, adjusted=p)
    name = {"bonferroni": "Bonferroni", "holm": "Holm"}[correction]
    before, after = apa.p_value(result.p), apa.p_value(p)
    said = f"{after} ({name}-corrected for {comparisons} comparisons; uncorrected {before})"
    return msgspec.structs.replace(
        result,
        comparisons=comparisons,
        correction=correction,
        adjusted=p,
        sentence=result.sentence.replace(before, said, 1),
    )
