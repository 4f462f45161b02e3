"""Whether the fit finds what was put in: simulated studies with people of known adaptability."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from coadapt.analysis.adaptability.beta import draw_beta, spread_of
from coadapt.analysis.adaptability.draws import Design, draw_recordings
from coadapt.analysis.adaptability.evidence import Evidence
from coadapt.analysis.adaptability.intervals import LEVEL, Interval
from coadapt.analysis.adaptability.likelihood import log_likelihoods
from coadapt.analysis.adaptability.population import fit_population, mean_interval, sd_interval
from coadapt.analysis.adaptability.posterior import posterior
from coadapt.analysis.adaptability.recordings import Recordings
from coadapt.analysis.adaptability.weights import fit_weights
from coadapt.analysis.shares import share_interval
from coadapt.arrays import BoolArray, FloatArray

DRAWN_AT_ONCE = 10_000
"""Participants, about: so many go through their trials in step."""


@dataclass(frozen=True, eq=False)
class Recovered:
    """What became of one number of a population in ``R`` studies.

    Attributes:
        true: the number.
        estimate: ``[R]`` what was found for it.
        low, high: ``[R]`` its confidence intervals.
        covered: ``[R]`` whether the interval holds the truth.
    """

    true: float
    estimate: FloatArray
    low: FloatArray
    high: FloatArray
    covered: BoolArray

    @classmethod
    def of(cls, true: float, found: Sequence[Interval]) -> Recovered:
        """From the intervals of the studies."""
        return cls(
            true,
            np.array([interval.estimate for interval in found]),
            np.array([interval.low for interval in found]),
            np.array([interval.high for interval in found]),
            np.array([interval.covers(true) for interval in found]),
        )

    @property
    def studies(self) -> int:
        """``R``."""
        return len(self.estimate)

    @property
    def bias(self) -> float:
        """Mean estimate less the truth."""
        return float(self.estimate.mean()) - self.true

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
            "true": self.true,
            "studies": self.studies,
            "bias": self.bias,
            "coverage": self.coverage,
            "coverage_low": low,
            "coverage_high": high,
            "width": self.width,
            "estimates": self.estimate.tolist(),
            "low": self.low.tolist(),
            "high": self.high.tolist(),
        }


@dataclass(frozen=True, eq=False)
class Recovery:
    """What became of one true beta population in many studies.

    Attributes:
        participants: in each study.
        mean: of alpha in the population the participants were drawn from.
        sd: of alpha; None where everybody is alike, and 0 lies at the border of what it may be.
        estimated_sd: ``[R]`` the fitted standard deviations.
        individual: share of all participants whose credible interval, from a uniform prior, holds
            their own alpha.
        information: mean bits that a participant's inputs told of their alpha.
    """

    participants: int
    mean: Recovered
    sd: Recovered | None
    estimated_sd: FloatArray
    individual: float
    information: float

    @property
    def true_sd(self) -> float:
        """Of the population."""
        return 0.0 if self.sd is None else self.sd.true

    def record(self) -> dict[str, object]:
        """For JSON."""
        return {
            "participants": self.participants,
            "mean": self.mean.record(),
            "sd": None if self.sd is None else self.sd.record(),
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
) -> Recovery:
    """Simulate studies with a beta population and fit each.

    Args:
        design: what participants do.
        mean, sd: of alpha; everybody is alike where ``sd`` is 0.
        participants: in each study.
        studies: their number.
        rng: source of the draws.
        level: of the intervals.

    Raises:
        ValueError: if there is no such population, or a number is not positive.
    """
    spread = spread_of(mean, sd)
    means: list[Interval] = []
    sds: list[Interval] = []
    estimated_sd: list[float] = []
    individual = information = 0.0

    def draw(count: int) -> FloatArray:
        return draw_beta(mean, spread, count, rng)

    for alpha, recordings in _together(design, draw, participants, studies, rng):
        everybody = Evidence.of(design.person, recordings)
        known = posterior(everybody)
        ends = known.interval(level)
        individual += float(((ends[:, 0] <= alpha) & (alpha <= ends[:, 1])).sum())
        information += float(known.information.sum())
        for who in np.arange(len(alpha)).reshape(-1, participants):
            evidence = everybody.select(who)
            fitted = fit_population(evidence)
            means.append(mean_interval(evidence, fitted, level))
            estimated_sd.append(fitted.sd)
            if sd > 0:
                sds.append(sd_interval(evidence, fitted, level))
    return Recovery(
        participants=participants,
        mean=Recovered.of(mean, means),
        sd=Recovered.of(sd, sds) if sds else None,
        estimated_sd=np.array(estimated_sd),
        individual=individual / (studies * participants),
        information=information / (studies * participants),
    )


def recover_weights(
    design: Design,
    values: Sequence[float],
    weights: Sequence[float],
    participants: int,
    studies: int,
    rng: np.random.Generator,
    *,
    level: float = LEVEL,
) -> tuple[Recovered, ...]:
    """Simulate studies with people of a few values of alpha, and fit the weight of each value.

    Args:
        design: what participants do.
        values: of alpha.
        weights: of each, with sum 1.
        participants, studies, rng, level: see `recover`.

    Raises:
        ValueError: if a number is not positive.
    """
    found: list[tuple[Interval, ...]] = []
    kinds = np.array(values, dtype=np.float64)

    def draw(count: int) -> FloatArray:
        return rng.choice(kinds, count, p=np.asarray(weights))

    for _, recordings in _together(design, draw, participants, studies, rng):
        likelihood = log_likelihoods(design.person, recordings, kinds)
        found.extend(
            fit_weights(study, values, level).weights
            for study in likelihood.reshape(-1, participants, len(values))
        )
    by_value = zip(*found, strict=True)
    return tuple(Recovered.of(w, each) for w, each in zip(weights, by_value, strict=True))


def _together(
    design: Design,
    draw: Callable[[int], FloatArray],
    participants: int,
    studies: int,
    rng: np.random.Generator,
) -> Iterator[tuple[FloatArray, Recordings]]:
    """The participants of some studies at a time, one study after the other: alpha, recordings."""
    if participants < 1 or studies < 1:
        raise ValueError("a recovery study needs at least one participant and one study")
    together = max(1, DRAWN_AT_ONCE // participants)
    for first in range(0, studies, together):
        alpha = draw((min(first + together, studies) - first) * participants)
        yield alpha, draw_recordings(design, alpha, rng)
