"""Exact values of small problems and exact evaluation of policies: an oracle for tests.

Nothing here is compiled and nothing is shared with the solver. The price is speed: problems of a
few observed states, up to `MAX_HIDDEN` hidden ones and short horizons.

*Value iteration.* With ``V`` extended to unnormalised beliefs by ``V(x, c b) = c V(x, b)``,

    (H V)(x, b) = max_a [ R(x, a) . b + gamma sum_{x', o} V(x', (b J_{x a x'}) * O(o | a, x', .)) ],

where ``J_{x a x'}[y, y'] = P(x', y' | x, y, a)``. If ``V(x', .)`` is the largest of a set of linear
functions, so is ``H V``, and the vector that is best at a given belief is found by choosing, for
each ``a``, ``x'`` and ``o``, the best vector of ``x'`` (a *backup*). To collect all vectors of
``H V`` we use linear support (Cheng 1988): let ``F`` be the largest of the vectors found so far.
``H V - F`` is convex on each cell of ``F``, the set of beliefs where one vector is best, so it is
largest in a corner of some cell. We back up all corners, add what lies more than ``epsilon`` above
``F`` and stop when nothing does: then ``F <= H V <= F + epsilon`` at every belief. No cross-sums
are built and nothing needs pruning.

*Error.* ``H`` is monotone and contracts by gamma. Started below ``V*``, every ``F_n`` stays below
``V*``, and ``V* <= F_n + d_n`` with ``d_n = gamma d_{n-1} + epsilon_n``. We choose ``epsilon_n =
(1 - gamma) / 2 * d_{n-1}``, so ``d_n`` shrinks by ``(1 + gamma) / 2`` in every step.

*Evaluation.* Under a policy the pair (x, belief) is a Markov chain. We follow it from the roots and
count, for every pair, the expected discounted number of visits ``m``, the solution of ``m = m_0 +
gamma P^T m``. The value is ``sum m r`` over the pairs followed, plus what the others, where we
stopped, are worth: between the worst and the best that any behaviour could achieve if it saw y.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu
from scipy.spatial import HalfspaceIntersection

from coadapt.arrays import FloatArray
from coadapt.momdp.belief import likelihood, predict
from coadapt.momdp.model import MOMDP, return_range
from coadapt.momdp.policy import AlphaVectorPolicy

MAX_HIDDEN = 6
"""The number of corners of cells explodes with the number of hidden states."""

SAME_BELIEF = 12
"""Beliefs of one observed state that agree to this many decimals count as one."""

SWEEPS = 300
"""Sweeps of value iteration on the observed problem, for the bounds of `evaluate_policy`."""


@dataclass(frozen=True)
class ExactSolution:
    """The optimal value, up to an interval.

    Attributes:
        lower, upper: ``[R]`` bounds of the optimal value at each root of the problem.
        policy: alpha vectors whose value nowhere exceeds the optimal one, nor falls short of it
            by more than ``error``.
        error: ``upper - lower``, the same at all beliefs.
        iterations: number of steps of value iteration.
    """

    lower: FloatArray
    upper: FloatArray
    policy: AlphaVectorPolicy
    error: float
    iterations: int


@dataclass(frozen=True)
class PolicyValue:
    """What following a policy collects, up to an interval.

    Attributes:
        lower, upper: ``[R]`` bounds of the expected discounted reward from each root.
        beliefs: number of pairs of observed state and belief followed.
    """

    lower: FloatArray
    upper: FloatArray
    beliefs: int


@dataclass(frozen=True)
class _Edge:
    """A successor of an (x, a): its index, ``J`` ``[Y, Y']`` and ``O(o | y')`` ``[Y', O]``."""

    x: int
    joint: FloatArray
    observation: FloatArray


def exact_value(
    problem: MOMDP, tolerance: float = 1e-6, *, max_vectors: int = 2000
) -> ExactSolution:
    """The optimal value at every root, to within ``tolerance``.

    Args:
        problem: a small MOMDP that `check_momdp` accepts.
        tolerance: width of the interval, in reward units, above 0.
        max_vectors: largest number of alpha vectors of one observed state.

    Raises:
        ValueError: if the problem has more than `MAX_HIDDEN` hidden states, a set of vectors
            exceeds ``max_vectors``, or the tolerance is below what rounding allows.
    """
    states, hidden, actions, _ = problem.shape
    if hidden > MAX_HIDDEN:
        raise ValueError(f"{hidden} hidden states are too many; exact values need {MAX_HIDDEN}")
    low, high = return_range(problem)
    if not tolerance > 1e-9 * max(1.0, abs(low), abs(high)):
        raise ValueError(f"tolerance {tolerance} is too small for values of {low:g} to {high:g}")
    edges = [[_edges(problem, x, a) for a in range(actions)] for x in range(states)]
    sets = [np.full((1, hidden), low) for _ in range(states)]
    chosen = [np.zeros(1, dtype=np.int64) for _ in range(states)]
    error = high - low
    iterations = 0
    while error > tolerance:
        epsilon = (1.0 - problem.discount) / 2 * error
        steps = [
            _apply(problem, edges[x], sets, problem.reward[x], epsilon, max_vectors)
            for x in range(states)
        ]
        sets, chosen = [step[0] for step in steps], [step[1] for step in steps]
        error = problem.discount * error + epsilon
        iterations += 1
    policy = AlphaVectorPolicy(
        start=np.cumsum([0, *(len(vectors) for vectors in sets)]),
        vectors=np.concatenate(sets),
        actions=np.concatenate(chosen),
    )
    lower = np.array([policy.value(root.x, root.belief) for root in problem.roots])
    return ExactSolution(lower, lower + error, policy, error, iterations)


def _edges(problem: MOMDP, x: int, a: int) -> list[_Edge]:
    return [
        _Edge(
            x=int(problem.edge_next[e]),
            joint=problem.transition.matrix(int(problem.edge_map[e])),
            observation=problem.observation[
                problem.observation_index[a, int(problem.edge_next[e])]
            ],
        )
        for e in problem.edges(x, a)
    ]


def _apply(
    problem: MOMDP,
    edges: list[list[_Edge]],
    sets: list[FloatArray],
    reward: FloatArray,
    epsilon: float,
    max_vectors: int,
) -> tuple[FloatArray, np.typing.NDArray[np.int64]]:
    """The vectors of ``H V`` at one observed state, up to ``epsilon``, and their actions."""
    hidden = reward.shape[1]
    found = np.empty((0, hidden))
    actions = np.empty(0, dtype=np.int64)
    corners = np.concatenate((np.eye(hidden), np.full((1, hidden), 1.0 / hidden)))
    while True:
        vectors, action = _backup(problem.discount, edges, sets, reward, corners)
        before = len(found)
        for b, vector, a in zip(corners, vectors, action, strict=True):
            if not len(found) or float(b @ vector) > float((found @ b).max()) + epsilon:
                found = np.concatenate((found, vector[None]))
                actions = np.append(actions, a)
        if len(found) == before:
            return found, actions
        if len(found) > max_vectors:
            raise ValueError(f"more than {max_vectors} alpha vectors in one observed state")
        corners = _cell_corners(found)


def _backup(
    discount: float,
    edges: list[list[_Edge]],
    sets: list[FloatArray],
    reward: FloatArray,
    beliefs: FloatArray,
) -> tuple[FloatArray, np.typing.NDArray[np.int64]]:
    """The vector of ``H V`` that is best at each of ``beliefs`` ``[P, Y]``, and its action."""
    candidates: list[FloatArray] = []
    for a in range(len(reward)):
        plan = np.tile(reward[a], (len(beliefs), 1))
        for edge in edges[a]:
            after = np.zeros_like(plan)  # [P, Y'] sum over o of O(o | y') times the best vector
            mass = beliefs @ edge.joint
            for o in range(edge.observation.shape[1]):
                values = (mass * edge.observation[:, o]) @ sets[edge.x].T
                after += edge.observation[:, o] * sets[edge.x][np.argmax(values, axis=1)]
            plan += discount * after @ edge.joint.T
        candidates.append(plan)
    stacked = np.stack(candidates)  # [A, P, Y]
    best = np.argmax(np.einsum("apy,py->ap", stacked, beliefs), axis=0)
    return stacked[best, np.arange(len(beliefs))], best


def _cell_corners(vectors: FloatArray) -> FloatArray:
    """``[P, Y]`` the corners of the cells into which ``max_i vectors[i] . b`` divides all beliefs.

    They are the corners of ``{(b, v): v >= vectors[i] . b for all i, b a belief}``, in the
    coordinates ``b_0, ..., b_{Y-2}, v``.
    """
    count, hidden = vectors.shape
    if count == 1 or hidden == 1:
        return np.eye(hidden)
    low, high = float(vectors.min()), float(vectors.max())
    scaled = (vectors - low) / max(high - low, np.finfo(np.float64).tiny)
    # Rows (n, d) of half-spaces n . (b, v) + d <= 0.
    rows = np.zeros((count + hidden + 1, hidden + 1))
    rows[:count, :-2] = scaled[:, :-1] - scaled[:, -1:]
    rows[:count, -2] = -1.0
    rows[:count, -1] = scaled[:, -1]
    rows[count : count + hidden - 1, : hidden - 1] = -np.eye(hidden - 1)
    rows[-2, : hidden - 1], rows[-2, -1] = 1.0, -1.0
    rows[-1, hidden - 1], rows[-1, -1] = 1.0, -2.0
    inside = np.full(hidden, 1.0 / hidden)
    inside[-1] = 1.5
    points = HalfspaceIntersection(rows, inside).intersections[:, :-1]
    points = np.clip(points[np.all(np.isfinite(points), axis=1)], 0.0, 1.0)
    beliefs = np.column_stack((points, np.clip(1.0 - points.sum(axis=1), 0.0, 1.0)))
    return np.unique((beliefs / beliefs.sum(axis=1, keepdims=True)).round(14), axis=0)


def evaluate_policy(
    problem: MOMDP,
    policy: AlphaVectorPolicy,
    tolerance: float = 1e-9,
    *,
    max_beliefs: int = 100_000,
) -> PolicyValue:
    """What following ``policy`` from each root collects.

    The interval holds whatever its width. It is at most ``tolerance`` wide unless ``max_beliefs``
    was reached. Beliefs that agree to `SAME_BELIEF` decimals are taken for the same one.

    Args:
        problem: a MOMDP that `check_momdp` accepts.
        policy: alpha vectors for every observed state that the policy can come to.
        tolerance: width of the interval to reach, in reward units.
        max_beliefs: largest number of pairs of observed state and belief to follow.
    """
    chain = _Chain(problem, policy)
    while True:
        visits = chain.visits()
        stopped = chain.stopped
        worst, best = chain.bounds(stopped)
        doubt = visits[stopped] * (best - worst)[:, None]
        known = visits[chain.followed].T @ np.array([chain.reward[i] for i in chain.followed])
        if np.all(doubt.sum(axis=0) <= tolerance) or len(chain.followed) >= max_beliefs:
            return PolicyValue(
                lower=known + visits[stopped].T @ worst,
                upper=known + visits[stopped].T @ best,
                beliefs=len(chain.followed),
            )
        room = min(max(64, len(chain.followed)), max_beliefs - len(chain.followed))
        # Those that leave most in doubt first; a stable order keeps the result reproducible.
        for i in np.argsort(-doubt.max(axis=1), kind="stable")[:room]:
            chain.follow(stopped[int(i)])


class _Chain:
    """The Markov chain of (x, belief) under a policy, as far as it has been followed."""

    def __init__(self, problem: MOMDP, policy: AlphaVectorPolicy) -> None:
        self._problem = problem
        self._policy = policy
        self._worst, self._best = _observed_bounds(problem)
        self._index: dict[tuple[int, bytes], int] = {}
        self._pairs: list[tuple[int, FloatArray]] = []
        self._moves: list[tuple[int, int, float]] = []  # from, to, gamma times probability
        self.reward: dict[int, float] = {}
        self._roots = [self._pair(root.x, root.belief) for root in problem.roots]

    @property
    def followed(self) -> list[int]:
        """The pairs whose successors are known."""
        return list(self.reward)

    @property
    def stopped(self) -> list[int]:
        """The other pairs."""
        return [i for i in range(len(self._pairs)) if i not in self.reward]

    def follow(self, i: int) -> None:
        """Take the policy's action in pair ``i``."""
        problem = self._problem
        x, belief = self._pairs[i]
        a = self._policy.action(x, belief)
        self.reward[i] = float(problem.reward[x, a] @ belief)
        for x_next in {int(problem.edge_next[e]) for e in problem.edges(x, a)}:
            mass = predict(problem, x, belief, a, x_next)
            for o in range(problem.shape[3]):
                joint = mass * likelihood(problem, a, x_next, o)
                chance = float(joint.sum())
                if chance > 0:
                    to = self._pair(x_next, joint / chance)
                    self._moves.append((i, to, problem.discount * chance))

    def visits(self) -> FloatArray:
        """``[N, R]`` expected discounted number of visits to each pair from each root."""
        count = len(self._pairs)
        start = np.zeros((count, len(self._roots)))
        start[self._roots, np.arange(len(self._roots))] = 1.0
        source, to, weight = zip(*self._moves, strict=True) if self._moves else ((), (), ())
        into = sparse.csc_array((weight, (to, source)), shape=(count, count))
        return splu(sparse.eye_array(count, format="csc") - into).solve(start)

    def bounds(self, pairs: list[int]) -> tuple[FloatArray, FloatArray]:
        """Bounds of what each of ``pairs`` can be worth."""
        worst = [float(self._worst[x] @ b) for x, b in (self._pairs[i] for i in pairs)]
        best = [float(self._best[x] @ b) for x, b in (self._pairs[i] for i in pairs)]
        return np.array(worst), np.array(best)

    def _pair(self, x: int, belief: FloatArray) -> int:
        key = (x, (belief.round(SAME_BELIEF) + 0.0).tobytes())
        if key not in self._index:
            self._index[key] = len(self._pairs)
            self._pairs.append((x, belief))
        return self._index[key]


def _observed_bounds(problem: MOMDP) -> tuple[FloatArray, FloatArray]:
    """``[X, Y]`` bounds of what any behaviour collects from (x, y), even one that sees y.

    Value iteration from a bound gives a bound after any number of sweeps.
    """
    states, hidden, actions, _ = problem.shape
    low, high = return_range(problem)
    worst, best = np.full((states, hidden), low), np.full((states, hidden), high)
    edges = [[_edges(problem, x, a) for a in range(actions)] for x in range(states)]
    for _ in range(SWEEPS):
        q_worst, q_best = problem.reward.copy(), problem.reward.copy()
        for x in range(states):
            for a in range(actions):
                for edge in edges[x][a]:
                    q_worst[x, a] += problem.discount * edge.joint @ worst[edge.x]
                    q_best[x, a] += problem.discount * edge.joint @ best[edge.x]
        settled = np.array_equal(worst, q_worst.min(axis=1)) and np.array_equal(
            best, q_best.max(axis=1)
        )
        worst, best = q_worst.min(axis=1), q_best.max(axis=1)
        if settled:
            break
    return worst, best
