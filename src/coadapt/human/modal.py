"""Modal policies: what a person (or the robot) who heads for a goal may do in each state.

A mode is a stochastic policy that stands for all the paths to one goal (Sec. 3.1). With the
principle of maximum entropy (Ziebart et al. 2008), a path of ``n`` steps has probability
proportional to ``exp(-c n)`` for a step cost ``c``. Soft value iteration gives the policy:

    V(g) = 0,   V(other goals) = -inf,
    V(s) = log sum_a exp(-c + V(T(s, a))),
    pi(a | s) = exp(-c + V(T(s, a)) - V(s)).

As ``c`` grows the policy becomes uniform over the shortest paths. A cost may also differ from step
to step, ``c(s, a) > 0``, and a goal be a region of states.

Where moves are uncertain a path is a chain of states, and its probability also contains those of
the outcomes, ``exp(-c n) prod P(s' | s, a)`` (Ziebart et al. 2008, Eq. 4): in the equations above
``exp(V(T(s, a)))`` becomes ``sum_s' P(s' | s, a) exp(V(s'))``.

The values of far states are too small to exponentiate, and iteration with logarithms is slow. So
the iteration is carried out on ``u(s) = exp(V(s) - B(s))`` for a lower bound ``B``, at first that
of one shortest path, ``B(s) = -c d(s)``:

    u(s) = sum_a exp(-c + B(T(s, a)) - B(s)) u(T(s, a)).

It rises from ``u = 1``; where it has become large, ``B`` takes it up.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import dijkstra
from scipy.sparse.linalg import MatrixRankWarning, spsolve

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.human.history import NO_STATE

TOLERANCE = 1e-13
"""Soft value iteration ends when no value moves by more than this, in nats."""

LARGE = 1e100
"""Values of ``u`` up to here are kept apart from the bound."""

MAX_SWEEPS = 1_000_000


def maximum_entropy_policy(
    moves: IntArray,
    goal: int | Sequence[int],
    step_cost: float | FloatArray,
    other_goals: Sequence[int] = (),
    chances: FloatArray | None = None,
) -> FloatArray:
    """The maximum-entropy modal policy towards ``goal``.

    Args:
        moves: ``[X, A]`` the state each action leads to; a blocked move leads to its own state.
            Or ``[X, A, N]`` the states it may lead to, filled up with `NO_STATE`.
        goal: index of the goal state, or of several.
        step_cost: ``c`` in nats, above the point where the sum over paths diverges; or ``[X, A]``
            costs, all above 0.
        other_goals: states that end a path elsewhere, so no path to ``goal`` passes through them.
        chances: ``[X, A, N]`` the probabilities of the outcomes, 0 at `NO_STATE`.

    Returns:
        ``[X, A]``, each row a distribution. Where no action matters (goal states, states that
        cannot reach the goal) the row is uniform.

    Raises:
        ValueError: if the step cost is too small for the sum over all paths to be finite.
    """
    paths = _Paths.of(moves, goal, step_cost, other_goals, chances)
    value = _soft_value(paths)
    steers = np.isfinite(value) & ~paths.ends
    policy = np.full(paths.weight.shape[:2], 1.0 / moves.shape[1])
    log_policy = np.logaddexp.reduce(paths.weight[steers] + value[paths.following[steers]], axis=2)
    log_policy -= np.logaddexp.reduce(log_policy, axis=1, keepdims=True)
    policy[steers] = np.exp(log_policy)
    return policy


def soft_value(
    moves: IntArray,
    goal: int | Sequence[int],
    step_cost: float | FloatArray,
    other_goals: Sequence[int] = (),
    chances: FloatArray | None = None,
) -> FloatArray:
    """``[X]`` soft values ``V`` in nats: minus infinity where ``goal`` cannot be reached.

    Raises:
        ValueError: as `maximum_entropy_policy`.
    """
    return _soft_value(_Paths.of(moves, goal, step_cost, other_goals, chances))


@dataclass(frozen=True)
class _Paths:
    """What the sum over paths runs over.

    Attributes:
        goals: states where paths end.
        ends: ``[X]`` those and the states where they must not pass.
        following: ``[X, A, N]`` the states a step may lead to; 0 with weight minus infinity
            where there is none.
        weight: ``[X, A, N]`` logarithm of the factor of each, ``log P(s' | s, a) - c(s, a)``.
    """

    goals: IntArray
    ends: BoolArray
    following: IntArray
    weight: FloatArray

    @classmethod
    def of(
        cls,
        moves: IntArray,
        goal: int | Sequence[int],
        step_cost: float | FloatArray,
        other_goals: Sequence[int],
        chances: FloatArray | None,
    ) -> Self:
        outcomes = moves[:, :, None] if moves.ndim == 2 else moves
        states, actions, _ = outcomes.shape
        cost = np.asarray(step_cost, dtype=np.float64)
        if cost.shape not in ((), (states, actions)):
            raise ValueError(f"step costs have shape {cost.shape}, expected {(states, actions)}")
        if not np.all(np.isfinite(cost)):
            raise ValueError(f"step cost {step_cost} is not a finite number")
        if cost.ndim == 2 and not np.all(cost > 0):
            raise ValueError(f"step costs must be above 0, not {cost.min():g}")
        exists = outcomes != NO_STATE
        chance = np.where(exists, 1.0 if chances is None else chances, 0.0)
        log_chance = np.log(chance, out=np.full(chance.shape, -np.inf), where=chance > 0)
        ends = np.zeros(states, dtype=np.bool_)
        goals = np.atleast_1d(np.array(goal, dtype=np.int64))
        ends[goals] = True
        ends[list(other_goals)] = True
        weight = log_chance - (cost[:, :, None] if cost.ndim == 2 else cost)
        if chances is not None and not np.all(cost > 0):
            raise ValueError(f"step costs of uncertain moves must be above 0, not {cost.min():g}")
        paths = cls(goals, ends, np.where(exists, outcomes, 0), weight)
        if not cost.min() > np.log(actions):
            paths.require_convergent(float(cost.min()))
        return paths

    def among(self, rows: IntArray, values: FloatArray) -> sparse.csr_array:
        """``[R, X]`` with ``values`` ``[R, A, N]`` at the states that may follow ``rows``."""
        following = self.following[rows]
        row_start = np.arange(len(rows) + 1) * following[0].size
        shape = (len(rows), len(self.ends))
        return sparse.csr_array((values.ravel(), following.ravel(), row_start), shape=shape)

    def require_convergent(self, cost: float) -> None:
        """Refuse costs for which the sum over all paths is infinite.

        The sum is finite when the matrix of the steps' factors among the states that do not end a
        path (``exp(-c)`` times the adjacency matrix) has a spectral radius below 1. For a
        non-negative matrix ``M`` that is so exactly when ``(I - M) u = 1`` has a positive solution.

        Raises:
            ValueError: if the sum is infinite.
        """
        inner = np.flatnonzero(~self.ends)
        if len(inner) == 0:
            return
        graph = self.among(inner, np.exp(self.weight[inner])).tocsc()[:, inner]
        graph.sum_duplicates()
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            # At the boundary itself the system is singular: the solution below is then refused.
            warnings.simplefilter("ignore", MatrixRankWarning)
            system = sparse.eye_array(len(inner), format="csc") - graph
            solution = spsolve(system, np.ones(len(inner)))
        if not (np.all(np.isfinite(solution)) and np.all(solution > 0)):
            actions = self.weight.shape[1]
            raise ValueError(
                f"step cost {cost:g} is too small: the sum over all paths to the goal is "
                f"infinite; any cost above ln {actions} = {np.log(actions):.4f} is safe here"
            )


def _soft_value(paths: _Paths) -> FloatArray:
    """The values from a shortest path upwards, see the head of this file."""
    value = _best_path(paths)
    rising = np.flatnonzero(np.isfinite(value) & ~paths.ends)
    if len(rising) == 0:
        return value
    weight, following = paths.weight[rising], paths.following[rising]
    sweeps = 0
    while sweeps < MAX_SWEEPS:
        sweep = paths.among(rising, np.exp(value[following] - value[rising, None, None] + weight))
        u = np.ones(len(value))
        growth = np.inf
        while growth > TOLERANCE and sweeps < MAX_SWEEPS and u.max() < LARGE:
            new: FloatArray = np.asarray(sweep @ u)
            growth = float(np.max(new / u[rising], initial=1.0)) - 1.0
            u[rising] = new
            sweeps += 1
        value += np.log(u)
        if growth <= TOLERANCE:
            return value
    raise ValueError(
        f"soft values did not settle in {MAX_SWEEPS} sweeps: the step cost is too close "
        "to the smallest one for which the sum over paths is finite"
    )


def _best_path(paths: _Paths) -> FloatArray:
    """``[X]`` the logarithm of the factor of one path, minus infinity where there is none.

    It is the best one, or one of the fewest steps where all steps count alike.
    """
    going = np.flatnonzero(~paths.ends)
    weight = paths.weight[going]
    row, _, _ = possible = np.nonzero(np.isfinite(weight))
    before, after, length = going[row], paths.following[going][possible], -weight[possible]
    # Of several ways from one state to another the best.
    order = np.lexsort((length, after, before))
    before, after, length = before[order], after[order], length[order]
    best = np.ones(len(order), dtype=np.bool_)
    best[1:] = (before[1:] != before[:-1]) | (after[1:] != after[:-1])
    before, after, length = before[best], after[best], length[best]
    states = len(paths.ends)
    alike = len(length) == 0 or bool(np.all(length == length[0]))
    arrivals = sparse.csr_array((length, (after, before)), shape=(states, states))
    if alike:
        arrivals.data[:] = 1.0
    distance = np.min(dijkstra(arrivals, indices=paths.goals), axis=0)
    reaches = np.isfinite(distance)
    value = np.full(states, -np.inf)
    value[reaches] = -distance[reaches] * (length[0] if alike and len(length) else 1.0)
    return value
