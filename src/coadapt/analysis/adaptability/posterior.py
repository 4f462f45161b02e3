"""What is known of each participant: their adaptability, and their mode at every step.

The posterior of alpha is ``P(alpha | inputs) ∝ P(alpha) P(inputs | alpha)`` on `alpha_grid`. Its
interval is the shortest set of grid values with the wanted probability, from its first to its last.
A participant with whom the robot never disagreed has told nothing of their alpha: their posterior
is the prior, which `information` shows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coadapt.analysis.adaptability.beta import beta_weights
from coadapt.analysis.adaptability.evidence import Evidence
from coadapt.analysis.adaptability.intervals import LEVEL
from coadapt.analysis.adaptability.likelihood import PersonModel
from coadapt.analysis.adaptability.recordings import Recordings
from coadapt.analysis.kernels.adaptability import smoothed_modes
from coadapt.arrays import FloatArray


def uniform_prior(points: int) -> FloatArray:
    """``[J]`` every alpha from 0 to 1 alike."""
    return beta_weights(np.array(0.5), np.array(1.0 / 3.0), points)  # Beta(1, 1)


@dataclass(frozen=True, eq=False)
class Posterior:
    """The posterior of adaptability of ``P`` participants.

    Attributes:
        alpha: ``[J]`` the grid.
        probability: ``[P, J]``.
        prior: ``[J]``.
        log_evidence: ``[P]`` log probability (nats) of the inputs, whatever alpha is.
    """

    alpha: FloatArray
    probability: FloatArray
    prior: FloatArray
    log_evidence: FloatArray

    @property
    def mean(self) -> FloatArray:
        """``[P]`` mean alpha."""
        return self.probability @ self.alpha

    @property
    def sd(self) -> FloatArray:
        """``[P]`` standard deviation of alpha."""
        return np.sqrt(np.maximum(self.probability @ self.alpha**2 - self.mean**2, 0.0))

    @property
    def information(self) -> FloatArray:
        """``[P]`` bits that the inputs told of alpha: divergence of posterior from prior."""
        ratio = np.divide(
            self.probability, self.prior, out=np.ones_like(self.probability), where=self.prior > 0
        )
        logs = np.log2(np.where(self.probability > 0, ratio, 1.0))
        return np.maximum((self.probability * logs).sum(axis=1), 0.0)

    def interval(self, level: float = LEVEL) -> FloatArray:
        """``[P, 2]`` the ends of the credible intervals.

        Raises:
            ValueError: if the level is not between 0 and 1.
        """
        if not 0 < level < 1:
            raise ValueError(f"the level of probability must lie between 0 and 1, not {level}")
        # The grid is uneven: by density, so that the set is the shortest.
        width = np.gradient(self.alpha)
        order = np.argsort(-self.probability / width, axis=1, kind="stable")
        mass = np.cumsum(np.take_along_axis(self.probability, order, axis=1), axis=1)
        needed = (mass < level * mass[:, -1:]).sum(axis=1) + 1
        ends = np.empty((len(order), 2))
        for p, count in enumerate(needed.tolist()):
            inside = self.alpha[order[p, :count]]
            ends[p] = inside.min(), inside.max()
        return ends


def posterior(evidence: Evidence, prior: FloatArray | None = None) -> Posterior:
    """The posterior of each participant.

    Args:
        evidence: what the recordings say.
        prior: ``[J]`` weights on the grid, for example those of a population; uniform by default.
    """
    before = uniform_prior(evidence.points) if prior is None else prior
    joint = evidence.scaled * before
    total = joint.sum(axis=1, keepdims=True)
    return Posterior(
        alpha=evidence.alpha,
        probability=joint / total,
        prior=before,
        log_evidence=evidence.by_participant(before[:, None])[:, 0],
    )


@dataclass(frozen=True, eq=False)
class Modes:
    """The mode of every participant over time, all of their inputs considered.

    Attributes:
        probability: ``[S, M]`` of each mode at each step.
        disagreements: ``[P]`` expected number of steps in which the participant saw the robot in
            another mode than their own: the occasions to adapt.
    """

    probability: FloatArray
    disagreements: FloatArray


def modes_over_time(person: PersonModel, recordings: Recordings, found: Posterior) -> Modes:
    """The modes by forward-backward, averaged over the posterior of alpha."""
    steps = person.steps(recordings)
    out = np.empty(steps.emission.shape)
    smoothed_modes(steps, found.alpha, found.probability, out)
    apart = (out * (1.0 - steps.perceived)).sum(axis=1)
    before = np.concatenate(([0.0], np.cumsum(apart)))
    ends = recordings.first_step[recordings.first_trial]
    return Modes(probability=out, disagreements=np.diff(before[ends]))
