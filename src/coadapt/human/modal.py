"""Modal policies: what a person (or the robot) who heads for a goal may do in each state.

A mode is a stochastic policy that stands for all the paths to one goal (Sec. 3.1). With the
principle of maximum entropy (Ziebart et al. 2008), a path of ``n`` steps has probability
proportional to ``exp(-c n)`` for a step cost ``c``. Soft value iteration gives the policy:

    V(g) = 0,   V(other goals) = -inf,
    V(s) = log sum_a exp(-c + V(T(s, a))),
    pi(a | s) = exp(-c + V(T(s, a)) - V(s)).

As ``c`` grows the policy becomes uniform over the shortest paths.

The values of far states are too small to exponentiate, and iteration with logarithms is slow. So
the iteration is carried out on ``u(s) = exp(V(s) - B(s))`` for a lower bound ``B``, at first that
of one shortest path, ``B(s) = -c d(s)``:

    u(s) = sum_a exp(-c + B(T(s, a)) - B(s)) u(T(s, a)).

It rises from ``u = 1``; where it has become large, ``B`` takes it up.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import dijkstra
from scipy.sparse.linalg import MatrixRankWarning, spsolve

from coadapt.arrays import BoolArray, FloatArray, IntArray

TOLERANCE = 1e-13
"""Soft value iteration ends when no value moves by more than this, in nats."""

LARGE = 1e100
"""Values of ``u`` up to here are kept apart from the bound."""

MAX_SWEEPS = 1_000_000


def maximum_entropy_policy(
    moves: IntArray, goal: int, step_cost: float, other_goals: Sequence[int] = ()
) -> FloatArray:
    """The maximum-entropy modal policy towards ``goal``.

    Args:
        moves: ``[X, A]`` the state each action leads to; a blocked move leads to its own state.
        goal: index of the goal state.
        step_cost: ``c`` in nats, above the point where the sum over paths diverges.
        other_goals: states that end a path elsewhere, so no path to ``goal`` passes through them.

    Returns:
        ``[X, A]``, each row a distribution. Where no action matters (goal states, states that
        cannot reach the goal) the row is uniform.

    Raises:
        ValueError: if the step cost is too small for the sum over all paths to be finite.
    """
    value = soft_value(moves, goal, step_cost, other_goals)
    states, actions = moves.shape
    policy = np.full((states, actions), 1.0 / actions)
    steers = np.isfinite(value)
    steers[[goal, *other_goals]] = False
    log_policy = -step_cost + value[moves[steers]]
    log_policy -= np.logaddexp.reduce(log_policy, axis=1, keepdims=True)
    policy[steers] = np.exp(log_policy)
    return policy


def soft_value(
    moves: IntArray, goal: int, step_cost: float, other_goals: Sequence[int] = ()
) -> FloatArray:
    """``[X]`` soft values ``V`` in nats: minus infinity where ``goal`` cannot be reached.

    Raises:
        ValueError: as `maximum_entropy_policy`.
    """
    states, actions = moves.shape
    ends = np.zeros(states, dtype=np.bool_)
    ends[[goal, *other_goals]] = True
    require_convergent(moves, ends, step_cost)
    distance = _distances(moves, goal, ends)
    reaches = np.isfinite(distance)
    value = np.full(states, -np.inf)
    value[reaches] = -step_cost * distance[reaches]
    rising = np.flatnonzero(reaches & (distance > 0))
    following = moves[rising].ravel()
    row_start = np.arange(len(rising) + 1) * actions
    sweeps = 0
    while sweeps < MAX_SWEEPS:
        weight = np.exp(value[following] - np.repeat(value[rising], actions) - step_cost)
        sweep = sparse.csr_array((weight, following, row_start), shape=(len(rising), states))
        u = np.ones(states)
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
        f"soft values did not settle in {MAX_SWEEPS} sweeps: step cost {step_cost:g} is too close "
        "to the smallest one for which the sum over paths is finite"
    )


def _distances(moves: IntArray, goal: int, ends: BoolArray) -> FloatArray:
    """``[X]`` fewest moves to ``goal`` past no other end; infinite where there is no such path."""
    going = np.flatnonzero(~ends)
    before = np.repeat(going, moves.shape[1])
    arrivals = sparse.csr_array(
        (np.ones(len(before)), (moves[going].ravel(), before)), shape=(len(moves), len(moves))
    )
    return dijkstra(arrivals, indices=[goal], unweighted=True)[0]


def require_convergent(moves: IntArray, ends: BoolArray, step_cost: float) -> None:
    """Refuse a step cost for which the sum over all paths is infinite.

    The sum is finite when the spectral radius of ``exp(-c)`` times the adjacency matrix among
    the states that do not end a path is below 1. For a non-negative matrix ``M`` that is so
    exactly when ``(I - M) u = 1`` has a positive solution.

    Raises:
        ValueError: if the sum is infinite, or the cost is not a finite number.
    """
    states, actions = moves.shape
    if not np.isfinite(step_cost):
        raise ValueError(f"step cost {step_cost} is not a finite number")
    if step_cost > np.log(actions):
        return
    inner = np.flatnonzero(~ends)
    position = np.full(states, -1)
    position[inner] = np.arange(len(inner))
    row = np.repeat(np.arange(len(inner)), actions)
    column = position[moves[inner]].ravel()
    stays = column >= 0
    weight = np.full(int(stays.sum()), np.exp(-step_cost))
    graph = sparse.csc_array((weight, (row[stays], column[stays])), shape=(len(inner), len(inner)))
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        # At the boundary itself the system is singular: the solution below is then refused.
        warnings.simplefilter("ignore", MatrixRankWarning)
        solution = spsolve(sparse.eye_array(len(inner), format="csc") - graph, np.ones(len(inner)))
    if not (np.all(np.isfinite(solution)) and np.all(solution > 0)):
        raise ValueError(
            f"step cost {step_cost:g} is too small: the sum over all paths to the goal is "
            f"infinite; any cost above ln {actions} = {np.log(actions):.4f} is safe here"
        )
