"""Compiled loops over participants, steps and values of alpha."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.jit import bare, kernel

SMALL = 1e-200
"""A likelihood so small is put away as a logarithm before it vanishes."""


class Steps(NamedTuple):
    """The steps of all participants as the person saw them."""

    first_trial: IntArray  # [P + 1]
    first_step: IntArray  # [T + 1]
    emission: FloatArray  # [S, M] O(a_h | m, x), the probability of the input in each mode
    perceived: FloatArray  # [S, M] P(m_r | window, a_r), Eq. 2
    prior: FloatArray  # [M] of the first mode
    is_kept: bool  # whether the mode lasts from one trial to the next


@kernel
def log_likelihood(steps: Steps, alpha: FloatArray, out: FloatArray) -> None:
    """Write ``log P(inputs | alpha)`` of each participant to ``out`` ``[P, J]``.

    The forward recursion: correct by the input, predict by the robot's action (Eq. 3-5), for all
    ``J`` values side by side.
    """
    modes, values = len(steps.prior), len(alpha)
    belief = np.empty((modes, values))
    total, scale, logs = np.empty(values), np.empty(values), np.empty(values)
    for p in range(len(steps.first_trial) - 1):
        scale[:] = 1.0
        logs[:] = 0.0
        for trial in range(steps.first_trial[p], steps.first_trial[p + 1]):
            if trial == steps.first_trial[p] or not steps.is_kept:
                for m in range(modes):
                    belief[m, :] = steps.prior[m]
            for s in range(steps.first_step[trial], steps.first_step[trial + 1]):
                total[:] = 0.0
                for m in range(modes):
                    chance = steps.emission[s, m]
                    for j in range(values):
                        belief[m, j] *= chance
                        total[j] += belief[m, j]
                for j in range(values):
                    scale[j] *= total[j]
                    if total[j] > 0.0:
                        total[j] = 1.0 / total[j]
                for m in range(modes):
                    seen = steps.perceived[s, m]
                    for j in range(values):
                        belief[m, j] = (1.0 - alpha[j]) * belief[m, j] * total[j] + alpha[j] * seen
                for j in range(values):
                    if scale[j] < SMALL:
                        logs[j] += np.log(scale[j]) if scale[j] > 0.0 else -np.inf
                        scale[j] = 1.0
        for j in range(values):
            out[p, j] = logs[j] + np.log(scale[j])


@kernel
def smoothed_modes(steps: Steps, alpha: FloatArray, weight: FloatArray, out: FloatArray) -> None:
    """Write ``P(m_h^t | all inputs)`` of each step to ``out`` ``[S, M]``.

    Forward-backward for each alpha, averaged with the posterior ``weight`` ``[P, J]``.
    """
    modes = len(steps.prior)
    out[:, :] = 0.0
    for p in range(len(steps.first_trial) - 1):
        first = int(steps.first_step[steps.first_trial[p]])
        last = int(steps.first_step[steps.first_trial[p + 1]])
        begins = np.zeros(last - first + 1, dtype=np.bool_)
        for trial in range(steps.first_trial[p], steps.first_trial[p + 1]):
            begins[steps.first_step[trial] - first] = True
        forward = np.empty((last - first, modes))
        backward = np.empty(modes)
        for j in range(len(alpha)):
            if weight[p, j] > 0.0:
                _forward(steps, alpha[j], first, last, begins, forward)
                _add_smoothed(steps, alpha[j], weight[p, j], first, begins, forward, backward, out)


@bare
def _forward(
    steps: Steps,
    alpha: float,
    first: int,
    last: int,
    begins: BoolArray,
    forward: FloatArray,
) -> None:
    """Write ``P(m^t | inputs up to t)`` to ``forward``."""
    modes = len(steps.prior)
    for s in range(first, last):
        row = forward[s - first]
        if s == first or (begins[s - first] and not steps.is_kept):
            for m in range(modes):
                row[m] = steps.prior[m]
        else:
            for m in range(modes):
                stays = (1.0 - alpha) * forward[s - first - 1, m]
                row[m] = stays + alpha * steps.perceived[s - 1, m]
        total = 0.0
        for m in range(modes):
            row[m] *= steps.emission[s, m]
            total += row[m]
        for m in range(modes):
            row[m] /= total


@bare
def _add_smoothed(
    steps: Steps,
    alpha: float,
    weight: float,
    first: int,
    begins: BoolArray,
    forward: FloatArray,
    backward: FloatArray,
    out: FloatArray,
) -> None:
    """Go backwards and add ``weight`` times the smoothed distributions to ``out``."""
    modes = len(steps.prior)
    backward[:] = 1.0
    for s in range(first + len(forward) - 1, first - 1, -1):
        # `backward` is now proportional to P(later inputs | m^t).
        total = 0.0
        for m in range(modes):
            total += forward[s - first, m] * backward[m]
        for m in range(modes):
            out[s, m] += weight * forward[s - first, m] * backward[m] / total
        if s == first:
            break
        if begins[s - first] and not steps.is_kept:
            backward[:] = 1.0
            continue
        # P(inputs from s on | m^{s-1}) by the change of mode after step s - 1, Eq. 3-4.
        jump = largest = 0.0
        for m in range(modes):
            backward[m] *= steps.emission[s, m]
            jump += steps.perceived[s - 1, m] * backward[m]
            largest = max(largest, backward[m])
        for m in range(modes):
            backward[m] = ((1.0 - alpha) * backward[m] + alpha * jump) / largest


@kernel
def mixture_log_likelihood(likelihood: FloatArray, weights: FloatArray, out: FloatArray) -> None:
    """Write ``sum_p log sum_j L[p, j] W[j, k]`` to ``out`` ``[K]``.

    Args:
        likelihood: ``[P, J]`` of each participant at each alpha, on any scale of their own.
        weights: ``[J, K]`` populations.
        out: ``[K]``.
    """
    count = weights.shape[1]
    total = np.empty(count)
    out[:] = 0.0
    for p in range(len(likelihood)):
        total[:] = 0.0
        for j in range(len(weights)):
            share = likelihood[p, j]
            if share > 0.0:
                for k in range(count):
                    total[k] += share * weights[j, k]
        for k in range(count):
            out[k] += np.log(total[k]) if total[k] > 0.0 else -np.inf


@kernel
def em_weights(
    likelihood: FloatArray, held: int, tolerance: float, most: int, weights: FloatArray
) -> int:
    """Improve ``weights`` ``[J]`` by EM until they settle; the number of iterations.

    Args:
        likelihood: ``[P, J]``, each row on any scale.
        held: a value whose weight stays as it is, or -1.
        tolerance: largest change of a weight in the last iteration.
        most: number of iterations at most.
        weights: begun with, and the result.
    """
    people, values = likelihood.shape
    share = np.empty(values)
    rest = 1.0 if held < 0 else 1.0 - weights[held]
    for iteration in range(most):
        share[:] = 0.0
        for p in range(people):
            total = 0.0
            for j in range(values):
                total += weights[j] * likelihood[p, j]
            if total > 0.0:
                for j in range(values):
                    share[j] += weights[j] * likelihood[p, j] / total
        total = 0.0
        for j in range(values):
            if j != held:
                total += share[j]
        change = 0.0
        for j in range(values):
            if j != held:
                new = rest * share[j] / total if total > 0.0 else weights[j]
                change = max(change, abs(new - weights[j]))
                weights[j] = new
        if change <= tolerance:
            return iteration + 1
    return most
