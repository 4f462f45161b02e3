"""Problems and slow, independent readings of them, for the tests of planning."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.momdp import MOMDP, AlphaVectorPolicy, JumpTransition, Root, SparseTransition


def tiger(discount: float = 0.95) -> MOMDP:
    """The tiger problem of Kaelbling, Littman, Cassandra, "Planning and acting in partially
    observable stochastic domains", Artificial Intelligence 101 (1998), Sec. 5.1."""
    listen, left, right = range(3)
    transition_y = np.full((1, 3, 2, 2), 0.5)
    transition_y[0, listen] = np.eye(2)
    observation = np.full((3, 1, 2, 2), 0.5)
    observation[listen, 0] = [[0.85, 0.15], [0.15, 0.85]]
    reward = np.empty((1, 3, 2))
    reward[0, listen] = -1
    reward[0, left] = [-100, 10]  # the tiger is behind the left door in the first hidden state
    reward[0, right] = [10, -100]
    return MOMDP.from_arrays(
        transition_x=np.ones((1, 3, 1)),
        transition_y=transition_y,
        observation=observation,
        reward=reward,
        discount=discount,
        roots=[Root(0, np.array([0.5, 0.5]))],
        hidden_names=["tiger-left", "tiger-right"],
        action_names=["listen", "open-left", "open-right"],
        observation_names=["hear-left", "hear-right"],
    )


def corridor(*, jump: bool = False) -> MOMDP:
    """Two observed states and a door that ends the task, with either kind of transition.

    ``stay`` keeps the place, ``go`` leads on; ``door`` ends. Hidden are two moods, of which each
    becomes the other with probability 0.25 (as a jump: rate 0.5, target uniform).
    """
    hidden = np.array([[0.75, 0.25], [0.25, 0.75]])
    transition_x = np.zeros((3, 2, 3))
    transition_x[0, 0, 0] = transition_x[0, 1, 1] = 1
    transition_x[1, 0, 1] = transition_x[1, 1, 2] = 1
    observation = np.tile(np.array([[0.9, 0.1], [0.2, 0.8]]), (2, 3, 1, 1))
    problem = MOMDP.from_arrays(
        transition_x=transition_x,
        transition_y=np.tile(hidden, (3, 2, 1, 1)),
        observation=observation,
        reward=np.arange(12.0).reshape(3, 2, 2),
        discount=0.5,
        roots=[Root(0, np.array([0.5, 0.5]), 0.25, "seen"), Root(1, np.array([1.0, 0.0]), 0.75)],
        terminal=[2],
        observed_names=["near", "far", "door"],
        hidden_names=["calm", "tense"],
        action_names=["stay", "go"],
        observation_names=["smile", "frown"],
    )
    if not jump:
        return problem
    return replace(
        problem,
        transition=JumpTransition(rate=np.full((1, 2), 0.5), target=np.full((4, 2), 0.5)),
    )


def dense_map(transition: SparseTransition | JumpTransition, k: int) -> FloatArray:
    """``[Y, Y']`` map ``k``, entry by entry from the definition of its kind."""
    size = transition.hidden
    dense = np.zeros((size, size))
    if isinstance(transition, SparseTransition):
        for y in range(size):
            row = k * size + y
            for i in range(transition.row_start[row], transition.row_start[row + 1]):
                dense[y, transition.column[i]] += transition.value[i]
        return dense
    blocks, values = transition.rate.shape
    mixing = np.eye(blocks) if transition.mixing is None else transition.mixing
    for i in range(blocks):
        for m in range(values):
            for m_next in range(values):
                jumps = transition.rate[i] * transition.target[k]
                moves = jumps[m_next] + (m == m_next) * (1 - jumps.sum())
                for j in range(blocks):
                    dense[i * values + m, j * values + m_next] += moves * mixing[i, j]
    return dense


def joint(problem: MOMDP) -> FloatArray:
    """``[X, A, Y, X', Y']`` the probabilities ``P(x', y' | x, y, a)``; all 0 at an end."""
    x_count, y_count, a_count, _ = problem.shape
    dense = np.zeros((x_count, a_count, y_count, x_count, y_count))
    for x in range(x_count):
        for a in range(a_count):
            row = x * a_count + a
            for e in range(problem.edge_start[row], problem.edge_start[row + 1]):
                mapped = dense_map(problem.transition, int(problem.edge_map[e]))
                dense[x, a, :, problem.edge_next[e], :] += mapped
    return dense


def observations(problem: MOMDP) -> FloatArray:
    """``[A, X', Y', O]`` the probabilities ``O(o | a, x', y')``."""
    return problem.observation[problem.observation_index]


def known_hidden_policy(problem: MOMDP, sweeps: int = 200) -> AlphaVectorPolicy:
    """The vectors ``Q(x, ., a)`` of the problem in which y is seen: a usable policy, no bound."""
    moves = joint(problem)
    q = np.zeros(problem.reward.shape)
    for _ in range(sweeps):
        q = problem.reward + problem.discount * np.einsum("xayuv,uv->xay", moves, q.max(axis=1))
    x_count, _, a_count, _ = problem.shape
    actions: IntArray = np.tile(np.arange(a_count), x_count)
    return AlphaVectorPolicy(
        start=np.arange(x_count + 1) * a_count,
        vectors=q.reshape(x_count * a_count, -1),
        actions=actions,
    )
