"""Looking at what a test assumes. What is found is told; no test is chosen by it."""

from __future__ import annotations

import numpy as np
from scipy import stats

from coadapt.analysis.tests.result import Check
from coadapt.analysis.tests.samples import Samples

SIGNIFICANT = 0.05
"""A p below which data speak against an assumption."""

INDEPENDENT = Check(
    assumption="independent values",
    method="by design: one value a participant, participants allocated at random",
)


def normal_within(samples: Samples) -> tuple[Check, ...]:
    """Whether the values of each sample are normal, by Shapiro and Wilk's test."""
    return tuple(map(_normal, samples.names, samples.arrays))


def _normal(name: str, values: np.ndarray) -> Check:
    assumption, method = f"normal values in {name}", "Shapiro-Wilk"
    if len(values) < 3:
        return Check(assumption=assumption, method=method, note="needs 3 values at least")
    if np.ptp(values) == 0:
        note = "all values are the same"
        return Check(assumption=assumption, method=method, holds=False, note=note)
    found = stats.shapiro(values)
    p = float(found.pvalue)
    return Check(
        assumption=assumption,
        method=method,
        statistic=float(found.statistic),
        p=p,
        holds=p >= SIGNIFICANT,
    )


def equal_variances(samples: Samples) -> Check:
    """Whether the samples vary equally, by Brown and Forsythe's form of Levene's test."""
    assumption, method = "equal variances", "Brown-Forsythe (Levene's test about medians)"
    away = [np.abs(array - np.median(array)) for array in samples.arrays]
    if all(np.ptp(values) == 0 for values in away):
        note = "values lie equally far from the median in every group"
        return Check(assumption=assumption, method=method, note=note)
    found = stats.levene(*samples.arrays, center="median")
    p = float(found.pvalue)
    note = ""
    if samples.constant:
        note = f"all values of {', '.join(samples.constant)} are the same"
    return Check(
        assumption=assumption,
        method=method,
        statistic=float(found.statistic),
        p=p,
        holds=p >= SIGNIFICANT,
        note=note,
    )


def ties(samples: Samples) -> Check:
    """How many values are tied, which rank tests correct for."""
    pooled = samples.pooled
    _, counts = np.unique(pooled, return_counts=True)
    tied = int(counts[counts > 1].sum())
    return Check(
        assumption="few ties",
        method="counted; the test is corrected for them",
        statistic=tied / len(pooled),
        holds=None,
        note=f"{tied} of {len(pooled)} values are tied, {len(counts)} values are different",
    )
