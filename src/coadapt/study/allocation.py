"""Which condition the next participant is allocated to.

Pure functions of what has been allocated so far and a seed, so that an allocation can be checked
afterwards. Nobody can know the next one: it also depends on who finishes until then.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from coadapt.study.protocol import Study

Standing = Literal["completed", "active", "lost"]
"""Of a session; ``lost``: ended without being completed, or without a sign of life for too long."""


@dataclass(frozen=True)
class Allotted:
    """A session that was allocated before.

    Attributes:
        condition: to which condition.
        standing: what became of it.
        covariates: values by the names of covariates.
    """

    condition: str
    standing: Standing
    covariates: Mapping[str, str] = field(default_factory=dict[str, str])


def allocate(
    study: Study, before: Sequence[Allotted], covariates: Mapping[str, str] | None = None
) -> str | None:
    """The condition of the next participant; None if all quotas are met.

    Sessions that are completed or active count, also towards quotas. Lost ones do not: who drops
    out is replaced in their own condition.

    Args:
        study: gives conditions and settings.
        before: all sessions allocated so far, in the order of allocation.
        covariates: of the new one, for minimisation.
    """
    settings = study.allocation
    counting = [a for a in before if a.standing != "lost"]
    counts = Counter(a.condition for a in counting)
    open_ones = [c.name for c in study.conditions if c.quota is None or counts[c.name] < c.quota]
    if not open_ones:
        return None
    # A generator of its own for each allocation: the same whatever was drawn before.
    rng = np.random.default_rng([settings.seed, len(before)])
    if settings.method == "blocks":
        return _from_block(study, before, open_ones)
    if settings.method == "minimisation":
        return _minimised(study, counting, open_ones, covariates or {}, rng)
    fewest = min(counts[name] for name in open_ones)
    return _one_of([name for name in open_ones if counts[name] == fewest], rng)


def _from_block(study: Study, before: Sequence[Allotted], open_ones: Sequence[str]) -> str:
    """The first entry of the random blocks that no counting session has taken."""
    settings = study.allocation
    names = [c.name for c in study.conditions] * settings.repeats
    taken = Counter(a.condition for a in before if a.standing != "lost")
    block = 0
    while True:
        order = np.arange(len(names))
        np.random.default_rng([settings.seed, 1, block]).shuffle(order)
        for name in (names[int(i)] for i in order):
            if taken[name] > 0:
                taken[name] -= 1
            elif name in open_ones:
                return name
        block += 1


def _minimised(
    study: Study,
    counting: Sequence[Allotted],
    open_ones: Sequence[str],
    covariates: Mapping[str, str],
    rng: np.random.Generator,
) -> str:
    """Pocock and Simon 1975: the least sum of the ranges of the counts, with a chance."""
    settings = study.allocation
    imbalance: dict[str, int] = dict.fromkeys(open_ones, 0)
    for covariate in (None, *settings.covariates):
        alike = [
            a.condition
            for a in counting
            if covariate is None or a.covariates.get(covariate) == covariates.get(covariate)
        ]
        for name in open_ones:
            counts = Counter([*alike, name])
            levels = [counts[other] for other in open_ones]
            imbalance[name] += max(levels) - min(levels)
    least = min(imbalance.values())
    best = [name for name in open_ones if imbalance[name] == least]
    others = [name for name in open_ones if imbalance[name] > least]
    if others and rng.random() >= settings.chance:
        return _one_of(others, rng)
    return _one_of(best, rng)


def _one_of(names: Sequence[str], rng: np.random.Generator) -> str:
    return names[int(rng.integers(len(names)))]
