"""How a person adapts: adaptability, and the change of mode it brings (Sec. 2.1 and 3.4).

Adaptability ``alpha`` is the probability that a person who sees the robot in another mode than
their own switches to it. In the paper it is one number. It may also differ from goal to goal: then
``alpha[m']`` is the readiness to switch *to* mode ``m'``. Somebody may follow the robot gladly to
one goal and never to another.

``T_alpha`` is how adaptability itself changes from step to step. The paper keeps it as it is;
`Adaptability.drifting`, `Adaptability.tiring` and `Adaptability.switching` are ours.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from coadapt.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Adaptability:
    """What the robot assumes of a person's adaptability ``alpha`` before it knows them.

    Attributes:
        values: the possible values, in [0, 1]: ``[A]``, increasing, or ``[A, M]`` where they differ
            from goal to goal, one row a kind of person.
        prior: ``[A]`` distribution over them.
        transition: ``[A, A]`` row-stochastic ``T_alpha``: how it changes from step to step.
    """

    values: FloatArray
    prior: FloatArray
    transition: FloatArray

    @classmethod
    def over(
        cls,
        values: Sequence[float] | Sequence[Sequence[float]] | FloatArray,
        prior: Sequence[float] | FloatArray | None = None,
        transition: FloatArray | None = None,
    ) -> Self:
        """Adaptability over ``values``; by default uniform and fixed throughout the task.

        Args:
            values: ``[A]`` in increasing order, or ``[A, M]`` rows that differ, in any order.
            prior: ``[A]``.
            transition: ``[A, A]``.

        Raises:
            ValueError: if a value is outside [0, 1] or repeated, or prior or transition are not
                distributions of the right size.
        """
        alpha = np.array(values, dtype=np.float64)
        if alpha.ndim not in (1, 2) or alpha.size == 0:
            raise ValueError("adaptability needs at least one value")
        shown = alpha.tolist()
        if not (np.all(alpha >= 0) and np.all(alpha <= 1)):
            raise ValueError(f"adaptability values must lie in [0, 1], not {shown}")
        if alpha.ndim == 1 and np.any(np.diff(alpha) <= 0):
            raise ValueError(f"adaptability values must increase, not {shown}")
        if len(np.unique(alpha, axis=0)) < len(alpha):
            raise ValueError(f"adaptability values must differ from each other, not {shown}")
        count = len(alpha)
        chances = np.full(count, 1 / count) if prior is None else np.array(prior, dtype=np.float64)
        moves = np.eye(count) if transition is None else np.array(transition, dtype=np.float64)
        require_distribution("adaptability prior", chances, (count,))
        require_distribution("adaptability transition", moves, (count, count))
        return cls(values=alpha, prior=chances, transition=moves)

    @classmethod
    def from_density(cls, density: Callable[[float], float], points: int) -> Self:
        """Adaptability on a grid, from a density over [0, 1], for example a beta distribution.

        The interval is cut into cells of equal width. Each is represented by its middle, and its
        prior is its share of the density's mass.

        Args:
            density: proportional to a density; it may be infinite at 0 and 1 themselves.
            points: number of cells, at least 1.

        Raises:
            ValueError: if there are no cells, or the density is negative or without a finite
                positive mass.
        """
        # Imported now: only who has a density need wait for it.
        from scipy.integrate import IntegrationWarning, quad  # noqa: PLC0415

        if points < 1:
            raise ValueError(f"a grid needs at least 1 point, not {points}")
        edges = (np.arange(points + 1) / points).tolist()
        middle = (2 * np.arange(points) + 1) / (2 * points)
        mass, here = np.full(points, np.nan), np.array([density(x) for x in middle.tolist()])
        with warnings.catch_warnings(), suppress(IntegrationWarning, ArithmeticError):
            warnings.simplefilter("error", IntegrationWarning)
            for i in range(points):
                mass[i] = quad(density, edges[i], edges[i + 1], limit=200)[0]
        if not (np.all(mass >= 0) and np.all(here >= 0) and 0 < mass.sum() < np.inf):
            raise ValueError(
                "the density of adaptability must be non-negative with a finite positive mass"
            )
        return cls.over(middle, mass / mass.sum())

    @property
    def is_fixed(self) -> bool:
        """Whether ``T_alpha`` is the identity."""
        return bool(np.array_equal(self.transition, np.eye(len(self.values))))

    @property
    def is_by_goal(self) -> bool:
        """Whether values differ from goal to goal."""
        return self.values.ndim == 2

    @property
    def levels(self) -> FloatArray:
        """``[A]`` the values as one number each: the mean over the goals where they differ."""
        return self.values.mean(axis=1) if self.is_by_goal else self.values

    @property
    def names(self) -> tuple[str, ...]:
        """``A`` labels such as ``alpha=0.5`` or, by goal, ``alpha=0.2/0.8``, all different."""
        return tuple(
            f"alpha={'/'.join(repr(v).removesuffix('.0') for v in row)}"
            for row in self.values.reshape(len(self.values), -1).tolist()
        )

    def rates(self, modes: int) -> FloatArray:
        """``[A, M]`` the probability of a switch to each mode, once it is perceived.

        Raises:
            ValueError: if the values are those of another number of goals.
        """
        if not self.is_by_goal:
            return np.repeat(self.values[:, None], modes, axis=1)
        if self.values.shape[1] != modes:
            raise ValueError(
                f"adaptability has values for {self.values.shape[1]} goals, expected {modes}"
            )
        return self.values

    def drifting(self, rate: float) -> Self:
        """As this one, but alpha drifts: a random walk over the values in their order.

        Args:
            rate: probability per step of a move to one of the two neighbouring values, each as
                likely; at an end the move outwards is left out. On a grid of spacing ``d``, away
                from the ends, the variance of alpha so grows by ``rate * d**2`` a step.

        Raises:
            ValueError: if the rate is outside [0, 1].
        """
        count = len(self.values)
        walk = 0.5 * (np.eye(count, k=1) + np.eye(count, k=-1))
        walk += np.diag(1.0 - walk.sum(axis=1))
        return self._changing(rate, walk)

    def tiring(self, rate: float) -> Self:
        """As this one, but alpha falls: people tire of giving way.

        Args:
            rate: probability per step of a move to the value before; the first one stays. So a
                value lasts ``1 / rate`` steps on average.

        Raises:
            ValueError: if the rate is outside [0, 1], or values by goal rise anywhere from a row to
                the one before.
        """
        if np.any(np.diff(self.values, axis=0) < 0):
            raise ValueError("adaptability can only fall where no goal's values decrease")
        count = len(self.values)
        down = np.eye(count, k=-1)
        down[0, 0] = 1.0
        return self._changing(rate, down)

    def switching(self, rate: float) -> Self:
        """As this one, but alpha is drawn anew from the prior now and then.

        Args:
            rate: probability per step of a new draw, which may give the same value again.

        Raises:
            ValueError: if the rate is outside [0, 1].
        """
        return self._changing(rate, np.tile(self.prior, (len(self.values), 1)))

    def _changing(self, rate: float, change: FloatArray) -> Self:
        """With a probability of ``rate`` per step, ``T_alpha`` is ``change``."""
        if not 0 <= rate <= 1:
            raise ValueError(f"the rate of change of adaptability must lie in [0, 1], not {rate}")
        stay = np.eye(len(self.values))
        return replace(self, transition=(1.0 - rate) * stay + rate * change)


def mode_transition(alpha: float | FloatArray, perceived: FloatArray) -> FloatArray:
    """``T_mh``: the change of human mode given what the robot seems to be doing (Eq. 3-4).

    ``P(m' | alpha, m, m_r)`` is ``alpha`` for ``m' = m_r`` and ``1 - alpha`` for ``m' = m``; where
    ``m_r = m`` the two coincide and the mode stays with probability 1. Where adaptability differs
    from goal to goal ``alpha`` is that towards ``m_r``.

    Args:
        alpha: adaptability in [0, 1], one number or ``[M]`` by goal.
        perceived: ``[M]`` the person's distribution over robot modes, Eq. 2.

    Returns:
        ``[M, M]``, row ``m`` the distribution of ``m'``.
    """
    modes = len(perceived)
    towards = np.broadcast_to(alpha, (modes,))
    transition = np.zeros((modes, modes))
    for m in range(modes):
        for m_r in range(modes):
            switch = np.zeros(modes)  # Eq. 4, P(. | alpha, m, m_r)
            switch[m_r] += towards[m_r]
            switch[m] += 1.0 - towards[m_r]
            transition[m] += switch * perceived[m_r]  # Eq. 3
    return transition


def require_distribution(name: str, rows: FloatArray, shape: tuple[int, ...]) -> None:
    """Raise ValueError unless ``rows`` has ``shape`` and its last axis holds distributions."""
    if rows.shape != shape:
        raise ValueError(f"{name} has shape {rows.shape}, expected {shape}")
    if not np.all(rows >= 0) or not np.allclose(rows.sum(axis=-1), 1.0, rtol=0, atol=1e-9):
        raise ValueError(f"{name} must be non-negative and sum to 1")
