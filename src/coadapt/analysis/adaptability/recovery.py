"""Whether the fit finds what was put in: simulated studies with people of known adaptability."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from coadapt.analysis.adaptability.beta import draw_beta, spread_of
from coadapt.analysis.adaptability.draws import Design, draw_recordings
from coadapt.analysis.adaptability.evidence import Evidence
from coadapt.analysis.adaptability.intervals import LEVEL
from coadapt.analysis.adaptability.population import fit_population, mean_interval
from coadapt.analysis.adaptability.posterior import posterior
from coadapt.analysis.shares import share_interval
from coadapt.arrays import BoolArray, FloatArray

DRAWN_AT_ONCE = 10_000
"""Participants, about: so many go through their trials in step."""


@dataclass(frozen=True, eq=False)
class Recovery:
    """What became of one true population in ``R`` studies.

    Attributes:
        mean, sd: of alpha in the population the participants were drawn from.
        participants: in each study.
        estimate: ``[R]`` the fitted means.
        estimated_sd: ``[R]`` the fitted standard deviations.
        low, high: ``[R]`` the confidence intervals of the mean.
        covered: ``[R]`` whether the interval holds the true mean.
        individual: share of all participants whose credible interval, from a uniform prior, holds
            their own alpha.
        information: mean bits that a participant's inputs told of their alpha.
    """

    mean: float
    sd: float
    participants: int
    estimate: FloatArray
    estimated_sd: FloatArray
    low: FloatArray
    high: FloatArray
    covered: BoolArray
    individual: float
    information: float

    @property
    def studies(self) -> int:
        """``R``."""
        return len(self.estimate)

    @property
    def bias(self) -> float:
        """Mean estimate less the truth."""
        return float(self.estimate.mean()) - self.mean

    @property
    def coverage(self) -> float:
        """Share of the studies whose interval holds the truth."""
        return float(self.covered.mean())

    @property
    def coverage_interval(self) -> tuple[float, float]:
        """95 % interval of the probability of covering, by Clopper and Pearson."""
        return share_interval(int(self.covered.sum()), self.studies)

    @property
    def width(self) -> float:
        """Mean width of the intervals."""
        return float((self.high - self.low).mean())

    def record(self) -> dict[str, object]:
        """For JSON."""
        low, high = self.coverage_interval
        return {
            "mean": self.mean,
            "sd": self.sd,
            "participants": self.participants,
            "studies": self.studies,
            "bias": self.bias,
            "coverage": self.coverage,
            "coverage_low": low,
            "coverage_high": high,
            "width": self.width,
            "estimates": self.estimate.tolist(),
            "low": self.low.tolist(),
            "high": self.high.tolist(),
            "estimated_sd": self.estimated_sd.tolist(),
            "individual_coverage": self.individual,
            "information_bits": self.information,
        }


def recover(
    design: Design,
    mean: float,
    sd: float,
    participants: int,
    studies: int,
    rng: np.random.Generator,
    *,
    level: float = LEVEL,
    tell: Callable[[int], None] | None = None,
) -> Recovery:
    """Simulate studies with a beta population and fit each.

    Args:
        design: what participants do.
        mean, sd: of alpha; everybody is alike where ``sd`` is 0.
        participants: in each study.
        studies: their number.
        rng: source of the draws.
        level: of the intervals.
        tell: called with the number of studies done.

    Raises:
        ValueError: if there is no such population, or a number is not positive.
    """
    if participants < 1 or studies < 1:
        raise ValueError("a recovery study needs at least one participant and one study")
    spread = spread_of(mean, sd)
    estimates = np.empty((studies, 4))
    covered = np.empty(studies, dtype=np.bool_)
    individual = information = 0.0
    together = max(1, DRAWN_AT_ONCE // participants)
    for first in range(0, studies, together):
        some = range(first, min(first + together, studies))
        alpha = draw_beta(mean, spread, len(some) * participants, rng)
        everybody = Evidence.of(design.person, draw_recordings(design, alpha, rng))
        known = posterior(everybody)
        ends = known.interval(level)
        individual += float(((ends[:, 0] <= alpha) & (alpha <= ends[:, 1])).sum())
        information += float(known.information.sum())
        for i in some:
            evidence = everybody.select((i - first) * participants + np.arange(participants))
            fitted = fit_population(evidence)
            interval = mean_interval(evidence, fitted, level)
            estimates[i] = fitted.mean, fitted.sd, interval.low, interval.high
            covered[i] = interval.covers(mean)
            if tell is not None:
                tell(i + 1)
    return Recovery(
        mean=mean,
        sd=sd,
        participants=participants,
        estimate=estimates[:, 0],
        estimated_sd=estimates[:, 1],
        low=estimates[:, 2],
        high=estimates[:, 3],
        covered=covered,
        individual=individual / (studies * participants),
        information=information / (studies * participants),
    )
