"""Problems as a `.pomdpx` file can hold them: one initial belief, and no end of an episode.

Added to a problem where needed, after its own observed states, which keep their numbers:

*a sink*
    if some ``(x, a)`` ends the episode. It leads there; the sink leads to itself and its rewards
    are 0. Values do not change.
*nothing*
    if all roots differ in x: the initial belief is a distribution over x, and over y given x.
*a start state*
    if roots share an x and are what the first observation tells apart: the start state leads by
    every action to the roots' x, its reward is 0, and the observation on arrival leaves the roots'
    beliefs. It costs one step, so the optimal value of the file is the discount times
    ``sum_i p_i V(root_i)``.
*copies*
    if roots share an x and are no such thing: all but the first start in a copy of x, to which
    nothing returns. Values do not change.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.momdp.files.sparse_rows import expanded, starts
from coadapt.momdp.model import MOMDP, Root
from coadapt.momdp.transition import HiddenTransition, SparseTransition

SAME = 1e-9
"""Largest difference between numbers that count as the same when roots are compared."""

SINK, START, COPY = "end", "start", "~"
"""Names of what is added; a copy's is that of its original, this and a number."""


def file_form(problem: MOMDP) -> tuple[MOMDP, float]:
    """``problem`` without ends and with one root for each x, and the factor of its value.

    Args:
        problem: one that `coadapt.check_momdp` accepts.

    Returns:
        The problem with `SparseTransition`, and by what the optimal value is multiplied: 1, or the
        discount if a start state was added.
    """
    result = replace(problem, transition=as_sparse(problem.transition))
    if np.any(np.diff(result.edge_start) == 0):
        result = _with_sink(result)
    if len({root.x for root in result.roots}) == len(result.roots):
        return result, 1.0
    merged = _merged(result.roots)
    if len({root.x for root in merged}) == len(merged):
        return replace(result, roots=merged), 1.0
    result = replace(result, roots=merged)
    if _told_apart_by_observation(result):
        return _with_start(result), result.discount
    return _with_copies(result), 1.0


def as_sparse(transition: HiddenTransition) -> SparseTransition:
    """The same maps with every entry that is not 0."""
    if isinstance(transition, SparseTransition):
        return transition
    size = transition.hidden
    blocks, values = transition.rate.shape
    parts: list[SparseTransition] = []
    step = max(1, 1_000_000 // (size * size if transition.mixing is not None else size * values))
    for first in range(0, transition.count, step):
        target = transition.target[first : first + step]  # [k, M]
        if transition.mixing is not None:
            numbers = range(first, first + len(target))
            parts.append(SparseTransition.from_dense(np.stack([*map(transition.matrix, numbers)])))
            continue
        jump = transition.rate * target[:, None, :]  # [k, B, M']
        local = np.repeat(jump[:, :, None, :], values, axis=2)  # [k, B, M, M']
        stay = 1.0 - jump.sum(axis=2)
        local += np.maximum(stay, 0.0)[:, :, None, None] * np.eye(values)
        k, b, at, to = np.nonzero(local)
        rows = (k * blocks + b) * values + at
        counts = np.bincount(rows, minlength=len(target) * size)
        parts.append(
            SparseTransition(
                hidden=size,
                row_start=starts(counts),
                column=(b * values + to).astype(np.int64),
                value=local[k, b, at, to],
            )
        )
    return _stacked(size, parts)


def _stacked(size: int, parts: Sequence[SparseTransition]) -> SparseTransition:
    """All maps of ``parts``, one after the other."""
    rows = [np.diff(part.row_start) for part in parts]
    counts = np.concatenate([np.zeros(0, dtype=np.int64), *rows])
    return SparseTransition(
        hidden=size,
        row_start=starts(counts),
        column=np.concatenate([np.zeros(0, dtype=np.int64), *(part.column for part in parts)]),
        value=np.concatenate([np.zeros(0), *(part.value for part in parts)]),
    )


def _diagonal(size: int, value: FloatArray) -> SparseTransition:
    """A map that multiplies by ``value`` ``[Y]``."""
    kept = value != 0
    return SparseTransition(
        hidden=size,
        row_start=starts(kept.astype(np.int64)),
        column=np.flatnonzero(kept).astype(np.int64),
        value=value[kept],
    )


def _new_name(names: Sequence[str], wanted: str) -> str:
    while wanted in names:
        wanted += "_"
    return wanted


def _with_state(
    problem: MOMDP,
    name: str,
    following: Sequence[tuple[int, int]],
    sight: IntArray,
    reward: FloatArray,
) -> MOMDP:
    """``problem`` with one more observed state.

    Args:
        problem: the problem.
        name: of the state.
        following: successor and map of its edges, the same for every action.
        sight: ``[A]`` the observation matrices on arrival.
        reward: ``[A, Y]``.
    """
    actions = problem.shape[2]
    own = np.array(following, dtype=np.int64).reshape(-1, 2)
    last = int(problem.edge_start[-1])
    return replace(
        problem,
        edge_start=np.r_[problem.edge_start, last + len(own) * np.arange(1, actions + 1)],
        edge_next=np.r_[problem.edge_next, np.tile(own[:, 0], actions)],
        edge_map=np.r_[problem.edge_map, np.tile(own[:, 1], actions)],
        observation_index=np.column_stack((problem.observation_index, sight)),
        reward=np.concatenate((problem.reward, reward[None])),
        observed_names=(*problem.observed_names, name),
    )


def _with_sink(problem: MOMDP) -> MOMDP:
    states, size, actions, seen = problem.shape
    transition = as_sparse(problem.transition)
    sink, stay = states, transition.count
    length = np.diff(problem.edge_start)
    ended = np.flatnonzero(length == 0)
    at = problem.edge_start[ended]
    problem = replace(
        problem,
        edge_start=starts(np.maximum(length, 1)),
        edge_next=np.insert(problem.edge_next, at, sink),
        edge_map=np.insert(problem.edge_map, at, stay),
        transition=_stacked(size, [transition, _diagonal(size, np.ones(size))]),
        observation=np.concatenate((problem.observation, np.full((1, size, seen), 1.0 / seen))),
    )
    return _with_state(
        problem,
        _new_name(problem.observed_names, SINK),
        [(sink, stay)],
        np.full(actions, len(problem.observation) - 1),
        np.zeros((actions, size)),
    )


def _merged(roots: Sequence[Root]) -> tuple[Root, ...]:
    """Equal roots as one."""
    merged: list[Root] = []
    for root in roots:
        for i, known in enumerate(merged):
            if known.x == root.x and np.array_equal(known.belief, root.belief):
                merged[i] = replace(known, probability=known.probability + root.probability)
                break
        else:
            merged.append(root)
    return tuple(merged)


def _mixtures(roots: Sequence[Root]) -> dict[int, tuple[float, FloatArray]]:
    """For each x of a root its probability and the belief before anything told roots apart."""
    mixtures: dict[int, tuple[float, FloatArray]] = {}
    for root in roots:
        chance, mass = mixtures.get(root.x, (0.0, np.zeros_like(root.belief)))
        mixtures[root.x] = (chance + root.probability, mass + root.probability * root.belief)
    return {x: (chance, mass / chance) for x, (chance, mass) in mixtures.items()}


def _told_apart_by_observation(problem: MOMDP) -> bool:
    """Whether the roots of each x are what an observation there makes of their mixture."""
    for x, (chance, mixture) in _mixtures(problem.roots).items():
        own = [root for root in problem.roots if root.x == x]
        for number in np.unique(problem.observation_index[:, x]):
            joint = mixture[:, None] * problem.observation[number]  # [Y, O]
            missing = np.array([root.probability / chance for root in own])
            for column in joint.T[joint.sum(axis=0) > SAME]:
                total = column.sum()
                distance = [np.abs(root.belief - column / total).max() for root in own]
                nearest = int(np.argmin(distance))
                if distance[nearest] > SAME:
                    return False
                missing[nearest] -= total
            if np.abs(missing).max() > SAME:
                return False
    return True


def _with_start(problem: MOMDP) -> MOMDP:
    states, size, actions, _ = problem.shape
    transition = as_sparse(problem.transition)
    mixtures = _mixtures(problem.roots)
    belief = np.sum([chance * mixture for chance, mixture in mixtures.values()], axis=0)
    maps: list[SparseTransition] = [transition]
    following: list[tuple[int, int]] = []
    for i, (x, (chance, mixture)) in enumerate(mixtures.items()):
        # Where no root may be, the first x takes all.
        share = np.full(size, float(i == 0))
        share[belief > 0] = chance * mixture[belief > 0] / belief[belief > 0]
        following.append((x, transition.count + i))
        maps.append(_diagonal(size, share))
    problem = replace(
        problem,
        transition=_stacked(size, maps),
        roots=(Root(states, belief / belief.sum()),),
    )
    return _with_state(
        problem,
        _new_name(problem.observed_names, START),
        sorted(following),
        problem.observation_index[:, 0],
        np.zeros((actions, size)),
    )


def _with_copies(problem: MOMDP) -> MOMDP:
    states, _, actions, _ = problem.shape
    taken: set[int] = set()
    original = list(range(states))
    names = list(problem.observed_names)
    roots: list[Root] = []
    for root in problem.roots:
        if root.x in taken:
            original.append(root.x)
            copies = original.count(root.x)
            name = f"{problem.observed_names[root.x]}{COPY}{copies}"
            names.append(_new_name(names, name))
            roots.append(replace(root, x=len(original) - 1))
        else:
            taken.add(root.x)
            roots.append(root)
    rows = (np.array(original)[:, None] * actions + np.arange(actions)).ravel()
    _, place = expanded(problem.edge_start, rows)
    return replace(
        problem,
        edge_start=starts(np.diff(problem.edge_start)[rows]),
        edge_next=problem.edge_next[place],
        edge_map=problem.edge_map[place],
        observation_index=problem.observation_index[:, original],
        reward=problem.reward[original],
        roots=tuple(roots),
        observed_names=tuple(names),
    )
