"""How likely demonstrated paths are, given what their steps cost.

A path to goal ``g`` has probability proportional to ``exp(-theta . F)``, where ``F`` is the sum of
the features ``f(x, a)`` along it and ``theta`` weighs them (Ziebart, Maas, Bagnell, Dey 2008,
Eq. 4, with costs for rewards). With one feature that is 1 everywhere ``theta`` is the step cost
``c`` of `coadapt.human.modal`. The logarithm of the likelihood of paths ``i`` is concave in
``theta``, and

    gradient        sum_i E[F | g_i, x_i] - F_i         (expected minus observed; their Eq. 6)
    minus Hessian   sum_i Cov[F | g_i, x_i]

where the expectation is over all paths from where path ``i`` begins to its goal. By one step of
the path, ``F`` changes what it is expected to be by ``delta = f(x, a) + w(x') - w(x)``, where
``w(x) = E[F | g, x]``. These changes are uncorrelated, so the covariance is a sum over expected
visits, ``Cov[F] = sum_x d(x) sum_a pi(a | x) delta delta^T``.

Moves are certain here: where the world adds chance, what people do depends on what they believe of
it, and the likelihood is another one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.human.modal import maximum_entropy_policy


@dataclass(frozen=True)
class Demonstration:
    """A path that somebody took to a goal that is known.

    Attributes:
        goal: index of the goal.
        steps: state and action of each step, in order; the last one leads to the goal.
    """

    goal: int
    steps: Sequence[tuple[int, int]]

    @classmethod
    def along(cls, moves: IntArray, start: int, actions: Sequence[int], goal: int) -> Self:
        """The path that ``actions`` make from ``start``.

        Args:
            moves: ``[X, A]`` the state each action leads to.
            start: the first state.
            actions: indices of the actions, in order.
            goal: index of the goal.
        """
        steps: list[tuple[int, int]] = []
        for action in actions:
            steps.append((start, action))
            start = int(moves[start, action])
        return cls(goal, tuple(steps))


@dataclass(frozen=True, eq=False)
class LikelihoodAt:
    """The likelihood at some weights, and its derivatives.

    Attributes:
        weights: ``[K]`` ``theta``.
        log_likelihood: of all demonstrations, in nats.
        gradient: ``[K]`` expected minus observed features.
        information: ``[K, K]`` minus the Hessian.
    """

    weights: FloatArray
    log_likelihood: float
    gradient: FloatArray
    information: FloatArray


@dataclass(frozen=True, eq=False)
class PathLikelihood:
    """The likelihood of demonstrations, as a function of the weights.

    Attributes:
        moves: ``[X, A]``.
        goals: the states of each goal.
        features: ``[X, A, K]``, scaled to a size of at most 1.
        scale: ``[K]`` what they were divided by.
        starts: ``[G, X]`` how many demonstrations to each goal begin in each state.
        taken: ``[G, X, A]`` how often each step occurs in them.
    """

    moves: IntArray
    goals: Sequence[Sequence[int]]
    features: FloatArray
    scale: FloatArray
    starts: FloatArray
    taken: FloatArray

    @classmethod
    def of(
        cls,
        moves: IntArray,
        goals: Sequence[Sequence[int]],
        demonstrations: Sequence[Demonstration],
        features: FloatArray,
    ) -> Self:
        """The likelihood of ``demonstrations``, with the arguments of `fit_cost`.

        Raises:
            ValueError: if there is none, one is no path to its goal, or the features cannot be
                used.
        """
        if moves.ndim != 2:
            raise ValueError("demonstrations can be fitted only where every move has one outcome")
        states, actions = moves.shape
        if features.ndim != 3 or features.shape[:2] != moves.shape or features.shape[2] == 0:
            raise ValueError(
                f"features have shape {features.shape}, expected ({states}, {actions}, K)"
            )
        if not np.all(np.isfinite(features)):
            raise ValueError("features must be finite numbers")
        if not demonstrations:
            raise ValueError("there are no demonstrations, expected at least one")
        scale = np.abs(features).max(axis=(0, 1))
        if np.any(scale == 0):
            raise ValueError(f"feature {int(np.argmin(scale))} is 0 everywhere")
        starts, taken = np.zeros((len(goals), states)), np.zeros((len(goals), states, actions))
        for i, demonstration in enumerate(demonstrations):
            _require_path(f"demonstration {i}", demonstration, moves, goals)
            starts[demonstration.goal, demonstration.steps[0][0]] += 1
            for state, action in demonstration.steps:
                taken[demonstration.goal, state, action] += 1
        return cls(moves, goals, features / scale, scale, starts, taken)

    @cached_property
    def ends(self) -> BoolArray:
        """``[X]`` where paths end."""
        is_end = np.zeros(len(self.moves), dtype=np.bool_)
        for states in self.goals:
            is_end[list(states)] = True
        return is_end

    @cached_property
    def observed(self) -> FloatArray:
        """``[K]`` the features along all demonstrations."""
        return np.einsum("gxa,xak->k", self.taken, self.features)

    def at(self, weights: FloatArray) -> LikelihoodAt | None:
        """The likelihood at ``weights``; None where the sum over all paths is infinite."""
        cost = self.features @ weights
        likelihood, count = 0.0, len(weights)
        expected, information = np.zeros(count), np.zeros((count, count))
        for g in np.flatnonzero(self.starts.any(axis=1)).tolist():
            goal = self.goals[g]
            others = [s for h, states in enumerate(self.goals) if h != g for s in states]
            try:
                policy = maximum_entropy_policy(self.moves, goal, cost, others)
            except ValueError:
                return None
            steps = self.taken[g] > 0
            with np.errstate(divide="ignore"):
                likelihood += float((self.taken[g][steps] * np.log(policy[steps])).sum())
            if not np.isfinite(likelihood):
                return None
            mean, covariance = self._counts(policy, self.starts[g])
            expected += mean
            information += covariance
        return LikelihoodAt(weights, likelihood, expected - self.observed, information)

    def _counts(self, policy: FloatArray, starts: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mean ``[K]`` and covariance ``[K, K]`` of the features, summed over all ``starts``."""
        inner = _visited(self.moves, policy, starts, self.ends)
        place = np.full(len(self.moves), -1)
        place[inner] = np.arange(len(inner))
        pi, following = policy[inner], self.moves[inner]
        stays = (place[following] >= 0) & (pi > 0)
        row = np.repeat(np.arange(len(inner)), pi.shape[1]).reshape(pi.shape)
        chain = sparse.csc_array(
            (pi[stays], (row[stays], place[following][stays])), shape=(len(inner), len(inner))
        )
        system = sparse.csc_array(sparse.eye_array(len(inner)) - chain)
        step = np.einsum("xa,xak->xk", pi, self.features[inner])
        to_come = np.zeros((len(self.moves), step.shape[1]))
        to_come[inner] = splu(system).solve(step)
        visits: FloatArray = splu(system.transpose().tocsc()).solve(starts[inner])
        change = self.features[inner] + to_come[following] - to_come[inner][:, None]
        covariance = np.einsum("xa,xaj,xak->jk", visits[:, None] * pi, change, change)
        return visits @ step, covariance


def _visited(moves: IntArray, policy: FloatArray, starts: FloatArray, ends: BoolArray) -> IntArray:
    """States where a path may be before it ends."""
    reached = np.zeros(len(moves), dtype=np.bool_)
    front = np.flatnonzero(starts)
    while len(front):
        reached[front] = True
        front = np.unique(moves[front][policy[front] > 0])
        front = front[~(reached[front] | ends[front])]
    return np.flatnonzero(reached)


def _require_path(
    name: str, demonstration: Demonstration, moves: IntArray, goals: Sequence[Sequence[int]]
) -> None:
    """Raise ValueError unless the demonstration is a path to its goal that ends there."""
    states, actions = moves.shape
    if not 0 <= demonstration.goal < len(goals):
        raise ValueError(f"{name} has goal {demonstration.goal}, expected 0 to {len(goals) - 1}")
    if not demonstration.steps:
        raise ValueError(f"{name} has no steps, expected at least one")
    expected = demonstration.steps[0][0]
    ends = {state for goal in goals for state in goal}
    for i, (state, action) in enumerate(demonstration.steps):
        if not (0 <= state < states and 0 <= action < actions):
            raise ValueError(
                f"{name}, step {i}: found state {state} and action {action}, expected a state "
                f"from 0 to {states - 1} and an action from 0 to {actions - 1}"
            )
        if state != expected:
            raise ValueError(
                f"{name}, step {i}: found state {state}, expected {expected}, to which the step "
                "before leads"
            )
        if state in ends:
            raise ValueError(f"{name}, step {i}: state {state} is a goal, where a path ends")
        expected = int(moves[state, action])
    if expected not in goals[demonstration.goal]:
        raise ValueError(
            f"{name} ends in state {expected}, expected one of its goal: "
            f"{', '.join(map(str, goals[demonstration.goal]))}"
        )
