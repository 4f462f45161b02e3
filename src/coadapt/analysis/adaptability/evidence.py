"""What the recordings say of alpha: the likelihood of every participant's inputs on a grid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from coadapt.analysis.adaptability.beta import GRID_POINTS, alpha_grid
from coadapt.analysis.adaptability.likelihood import PersonModel, log_likelihoods
from coadapt.analysis.adaptability.recordings import Recordings
from coadapt.analysis.kernels.adaptability import mixture_log_likelihood
from coadapt.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Evidence:
    """How likely the inputs of ``P`` participants are at the ``J`` values of `alpha_grid`.

    Attributes:
        log_likelihood: ``[P, J]`` in nats.

    Raises:
        ValueError: if a participant's inputs are impossible for every alpha.
    """

    log_likelihood: FloatArray

    def __post_init__(self) -> None:
        impossible = np.flatnonzero(~np.isfinite(self._best))
        if len(impossible):
            raise ValueError(
                f"the inputs of participant {impossible[0] + 1} are impossible for every alpha; "
                "with a lapse rate above 0 every input is possible"
            )

    @classmethod
    def of(cls, person: PersonModel, recordings: Recordings, points: int = GRID_POINTS) -> Self:
        """What ``recordings`` say, on a grid of ``points``."""
        return cls(log_likelihoods(person, recordings, alpha_grid(points)))

    def __len__(self) -> int:
        """Number of participants."""
        return len(self.log_likelihood)

    @property
    def points(self) -> int:
        """``J``."""
        return self.log_likelihood.shape[1]

    @property
    def alpha(self) -> FloatArray:
        """``[J]`` the grid."""
        return alpha_grid(self.points)

    @cached_property
    def _best(self) -> FloatArray:
        return self.log_likelihood.max(axis=1, initial=-np.inf)

    @cached_property
    def scaled(self) -> FloatArray:
        """``[P, J]`` the likelihoods, each participant's divided by their largest."""
        return np.exp(self.log_likelihood - self._best[:, None])

    @cached_property
    def offset(self) -> float:
        """What `scaled` leaves out of the sum of the log likelihoods."""
        return float(self._best.sum())

    def select(self, participants: IntArray) -> Evidence:
        """The evidence of some of the participants, each as often as it is named."""
        return Evidence(self.log_likelihood[participants])

    def of_populations(self, weights: FloatArray) -> FloatArray:
        """``[...]`` log likelihood (nats) of all inputs in populations ``weights`` ``[J, ...]``."""
        flat = np.ascontiguousarray(weights.reshape(len(weights), -1))
        out = np.empty(flat.shape[1])
        mixture_log_likelihood(self.scaled, flat, out)
        return (out + self.offset).reshape(weights.shape[1:])

    def by_participant(self, weights: FloatArray) -> FloatArray:
        """``[P, ...]`` log likelihood (nats) of each participant's inputs in populations."""
        share = np.tensordot(self.scaled, weights, axes=(1, 0))
        with np.errstate(divide="ignore"):
            logs = np.log(share)
        return logs + self._best.reshape(-1, *(1,) * (weights.ndim - 1))
