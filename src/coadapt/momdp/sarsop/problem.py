"""A MOMDP as arrays for the kernels, and its hidden transitions as linear operators."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse

from coadapt.arrays import FloatArray, Int32Array, IntArray
from coadapt.jit import bare
from coadapt.momdp.model import MOMDP
from coadapt.momdp.transition import JumpTransition


class Problem(NamedTuple):
    """What the kernels read. Sizes: X, A, Y, O, E edges, K maps, B blocks of M values, L tables."""

    edge_start: IntArray  # [X * A + 1]
    edge_next: IntArray  # [E]
    edge_map: IntArray  # [E]
    row_start: IntArray  # [K * Y + 1], of sparse maps
    column: IntArray  # [nnz]
    value: FloatArray  # [nnz]
    jumps: bool  # whether maps are stay-or-jump instead of sparse
    rate: FloatArray  # [B, M]
    target: FloatArray  # [K, M]
    mixing: FloatArray  # [B, B], or [0, 0] for the identity
    table: IntArray  # [A, X] observation table after action a in x'
    seen_start: IntArray  # [L * Y + 1], rows of the observation tables
    seen: IntArray  # [nnz] an observation possible in a row
    seen_chance: FloatArray  # [nnz] its probability
    reward: FloatArray  # [X, A, Y]
    discount: float
    observations: int  # O


def as_arrays(problem: MOMDP) -> Problem:
    """The arrays of ``problem``."""
    maps = problem.transition
    jumps = isinstance(maps, JumpTransition)
    no_floats, no_ints = np.zeros(0), np.zeros(0, dtype=np.int64)
    tables, hidden, observations = problem.observation.shape
    rows = sparse.csr_array(problem.observation.reshape(tables * hidden, observations))
    return Problem(
        edge_start=problem.edge_start,
        edge_next=problem.edge_next,
        edge_map=problem.edge_map,
        row_start=no_ints if jumps else maps.row_start,
        column=no_ints if jumps else maps.column,
        value=no_floats if jumps else maps.value,
        jumps=jumps,
        rate=maps.rate if jumps else np.zeros((0, 0)),
        target=maps.target if jumps else np.zeros((0, 0)),
        mixing=maps.mixing if jumps and maps.mixing is not None else np.zeros((0, 0)),
        table=problem.observation_index,
        seen_start=rows.indptr.astype(np.int64),
        seen=rows.indices.astype(np.int64),
        seen_chance=rows.data.astype(np.float64),
        reward=problem.reward,
        discount=problem.discount,
        observations=observations,
    )


@bare
def push(
    p: Problem, k: int, index: Int32Array, mass: FloatArray, out: FloatArray, spare: FloatArray
) -> None:
    """Write ``mass @ J_k`` to ``out`` ``[Y]``; ``mass`` lies on the hidden states ``index``.

    ``spare`` ``[Y]`` is scratch.
    """
    out[:] = 0.0
    hidden = out.shape[0]
    if not p.jumps:
        for i in range(index.shape[0]):
            row = k * hidden + index[i]
            for j in range(p.row_start[row], p.row_start[row + 1]):
                out[p.column[j]] += mass[i] * p.value[j]
        return
    blocks, modes = p.rate.shape
    for i in range(index.shape[0]):
        y = index[i]
        b = y // modes
        stay = 1.0
        for m in range(modes):
            jump = p.rate[b, m] * p.target[k, m]
            stay -= jump
            out[b * modes + m] += mass[i] * jump
        out[y] += mass[i] * max(stay, 0.0)
    if p.mixing.shape[0] > 0:
        for y in range(hidden):
            spare[y] = out[y]
            out[y] = 0.0
        for b in range(blocks):
            for b_next in range(blocks):
                for m in range(modes):
                    out[b_next * modes + m] += spare[b * modes + m] * p.mixing[b, b_next]


@bare
def pull(
    p: Problem, k: int, scale: float, values: FloatArray, out: FloatArray, spare: FloatArray
) -> None:
    """Add ``scale * J_k @ values`` to ``out``; both are ``[Y]``, and so is ``spare``, scratch."""
    hidden = out.shape[0]
    if not p.jumps:
        for y in range(hidden):
            total = 0.0
            for j in range(p.row_start[k * hidden + y], p.row_start[k * hidden + y + 1]):
                total += p.value[j] * values[p.column[j]]
            out[y] += scale * total
        return
    blocks, modes = p.rate.shape
    mixed = values
    if p.mixing.shape[0] > 0:
        mixed = spare
        mixed[:] = 0.0
        for b in range(blocks):
            for b_next in range(blocks):
                for m in range(modes):
                    mixed[b * modes + m] += p.mixing[b, b_next] * values[b_next * modes + m]
    for b in range(blocks):
        stay = 1.0
        jumped = 0.0
        for m in range(modes):
            jump = p.rate[b, m] * p.target[k, m]
            stay -= jump
            jumped += jump * mixed[b * modes + m]
        for m in range(modes):
            out[b * modes + m] += scale * (max(stay, 0.0) * mixed[b * modes + m] + jumped)


@bare
def row_of(p: Problem, k: int, y: int, index: IntArray, chance: FloatArray) -> int:
    """Write row ``y`` of ``J_k`` as pairs of ``index`` and ``chance`` ``[Y]``; their number."""
    hidden = p.reward.shape[2]
    size = 0
    if not p.jumps:
        for j in range(p.row_start[k * hidden + y], p.row_start[k * hidden + y + 1]):
            index[size] = p.column[j]
            chance[size] = p.value[j]
            size += 1
        return size
    blocks, modes = p.rate.shape
    b = y // modes
    stay = 1.0
    for m in range(modes):
        stay -= p.rate[b, m] * p.target[k, m]
    mixes = p.mixing.shape[0] > 0
    for b_next in range(blocks) if mixes else range(b, b + 1):
        share = p.mixing[b, b_next] if mixes else 1.0
        for m in range(modes):
            total = p.rate[b, m] * p.target[k, m]
            if m == y % modes:
                total += max(stay, 0.0)
            if share * total > 0.0:
                index[size] = b_next * modes + m
                chance[size] = share * total
                size += 1
    return size


@bare
def staying(p: Problem, k: int, out: FloatArray) -> None:
    """Write the probability with which ``J_k`` keeps each hidden state to ``out`` ``[Y]``."""
    hidden = out.shape[0]
    if not p.jumps:
        out[:] = 0.0
        for y in range(hidden):
            for j in range(p.row_start[k * hidden + y], p.row_start[k * hidden + y + 1]):
                if p.column[j] == y:
                    out[y] += p.value[j]
        return
    blocks, modes = p.rate.shape
    for b in range(blocks):
        stay = 1.0
        for m in range(modes):
            stay -= p.rate[b, m] * p.target[k, m]
        share = p.mixing[b, b] if p.mixing.shape[0] > 0 else 1.0
        for m in range(modes):
            jump = p.rate[b, m] * p.target[k, m]
            out[b * modes + m] = share * (max(stay, 0.0) + jump)
