"""How a person adapts: adaptability, and the change of mode it brings (Sec. 2.1 and 3.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from coadapt.arrays import FloatArray


@dataclass(frozen=True)
class Adaptability:
    """What the robot assumes of a person's adaptability ``alpha`` before it knows them.

    Attributes:
        values: ``[A]`` possible values, each in [0, 1], increasing.
        prior: ``[A]`` distribution over them.
        transition: ``[A, A]`` row-stochastic ``T_alpha``: how it changes from step to step.
    """

    values: FloatArray
    prior: FloatArray
    transition: FloatArray

    @classmethod
    def over(
        cls,
        values: Sequence[float],
        prior: Sequence[float] | None = None,
        transition: FloatArray | None = None,
    ) -> Self:
        """Adaptability over ``values``; by default uniform and fixed throughout the task.

        Raises:
            ValueError: if a value is outside [0, 1] or repeated, or prior or transition are not
                distributions of the right size.
        """
        alpha = np.array(values, dtype=np.float64)
        if alpha.ndim != 1 or len(alpha) == 0:
            raise ValueError("adaptability needs at least one value")
        if not (np.all(alpha >= 0) and np.all(alpha <= 1)):
            raise ValueError(f"adaptability values must lie in [0, 1], not {list(values)}")
        if np.any(np.diff(alpha) <= 0):
            raise ValueError(f"adaptability values must increase, not {list(values)}")
        count = len(alpha)
        chances = np.full(count, 1 / count) if prior is None else np.array(prior, dtype=np.float64)
        moves = np.eye(count) if transition is None else np.array(transition, dtype=np.float64)
        require_distribution("adaptability prior", chances, (count,))
        require_distribution("adaptability transition", moves, (count, count))
        return cls(values=alpha, prior=chances, transition=moves)

    @property
    def is_fixed(self) -> bool:
        """Whether ``T_alpha`` is the identity."""
        return bool(np.array_equal(self.transition, np.eye(len(self.values))))


def mode_transition(alpha: float, perceived: FloatArray) -> FloatArray:
    """``T_mh``: the change of human mode given what the robot seems to be doing (Eq. 3-4).

    ``P(m' | alpha, m, m_r)`` is ``alpha`` for ``m' = m_r`` and ``1 - alpha`` for ``m' = m``; where
    ``m_r = m`` the two coincide and the mode stays with probability 1.

    Args:
        alpha: adaptability in [0, 1].
        perceived: ``[M]`` the person's distribution over robot modes, Eq. 2.

    Returns:
        ``[M, M]``, row ``m`` the distribution of ``m'``.
    """
    modes = len(perceived)
    transition = np.zeros((modes, modes))
    for m in range(modes):
        for m_r in range(modes):
            switch = np.zeros(modes)  # Eq. 4, P(. | alpha, m, m_r)
            switch[m_r] += alpha
            switch[m] += 1.0 - alpha
            transition[m] += switch * perceived[m_r]  # Eq. 3
    return transition


def require_distribution(name: str, rows: FloatArray, shape: tuple[int, ...]) -> None:
    """Raise ValueError unless ``rows`` has ``shape`` and its last axis holds distributions."""
    if rows.shape != shape:
        raise ValueError(f"{name} has shape {rows.shape}, expected {shape}")
    if not np.all(rows >= 0) or not np.allclose(rows.sum(axis=-1), 1.0, rtol=0, atol=1e-9):
        raise ValueError(f"{name} must be non-negative and sum to 1")
