"""What a policy collects, by simulation: for problems of any size.

An episode draws a root and a hidden state from its belief. Then, step by step, the policy takes the
action of its best alpha vector at the current belief, collects ``R(x, a, y)`` of the state that is
really there, and the belief is updated exactly. The mean of the discounted returns estimates the
policy's value; if the policy's alpha vectors are a lower bound, it lies above them up to chance.

`coadapt.momdp.exact` computes the same without chance for problems small enough.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.momdp.model import MOMDP, return_range
from coadapt.momdp.policy import AlphaVectorPolicy, require_fit
from coadapt.momdp.sarsop.episodes import (
    NO_VECTOR,
    OVER,
    Episodes,
    as_columns,
    mark_ended,
    run_steps,
)
from coadapt.momdp.sarsop.problem import as_arrays

BEYOND = 1e-4
"""Discount at which an episode is cut off by default: part of a reward that still counts."""

LONGEST = 10_000
"""Steps after which an episode is cut off by default even if rewards count for longer."""

BLOCK = 250
"""Episodes that share a generator."""

CALL_STEPS = 32
"""Steps of a block between two looks at progress and Ctrl-C."""

NORMAL_95 = 1.959963984540054
"""Standard errors of a normal distribution to either side that hold 95 %."""


@dataclass(frozen=True)
class SimulatedValue:
    """An estimate of what a policy collects.

    Attributes:
        mean: mean discounted return of the episodes, each up to the horizon.
        standard_error: of the mean: standard deviation by the root of the number of episodes.
        episodes: number of episodes.
        horizon: most steps of an episode.
        unfinished: number of episodes in which rewards could have followed after the horizon.
        truncation: the mean would change by no more than this if these had gone on.
        steps: number of steps of all episodes together.
    """

    mean: float
    standard_error: float
    episodes: int
    horizon: int
    unfinished: int
    truncation: float
    steps: int

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % confidence interval of the mean, by the normal distribution."""
        reach = NORMAL_95 * self.standard_error
        return self.mean - reach, self.mean + reach


def default_horizon(discount: float) -> int:
    """Steps after which a reward counts at most `BEYOND` of its size, `LONGEST` at most."""
    if discount <= BEYOND:
        return 1
    return min(LONGEST, math.ceil(math.log(BEYOND) / math.log(discount)))


def simulate_policy(
    problem: MOMDP,
    policy: AlphaVectorPolicy,
    episodes: int = 10_000,
    *,
    rng: np.random.Generator,
    horizon: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> SimulatedValue:
    """Let ``policy`` act in ``problem``.

    Each block of `BLOCK` episodes has a generator spawned from ``rng``, so the first episodes are
    the same however many there are.

    Args:
        problem: a MOMDP that `check_momdp` accepts.
        policy: alpha vectors for every observed state that the policy can come to.
        episodes: how many, at least 2.
        rng: the source of chance.
        horizon: steps after which an episode is cut off, at least 1; by default `default_horizon`.
        progress: told now and then how many episodes are done.

    Raises:
        ValueError: if a number is out of its range, the policy does not fit the problem, or it has
            no alpha vector for an observed state that an episode came to.
    """
    if episodes < 2:
        raise ValueError(f"episodes must be at least 2, not {episodes}")
    if horizon is not None and horizon < 1:
        raise ValueError(f"horizon must be at least 1 step, not {horizon}")
    require_fit(problem, policy)
    steps = default_horizon(problem.discount) if horizon is None else horizon
    simulator = _Simulator(problem, policy)
    totals = np.empty(episodes)
    unfinished = taken = 0
    first = range(0, episodes, BLOCK)
    for begin, generator in zip(first, rng.spawn(len(first)), strict=True):
        size = min(BLOCK, episodes - begin)

        def tell(part: float, begin: int = begin, size: int = size) -> None:
            if progress is not None:
                progress(begin + int(part * size))

        block = simulator.start(size, generator)
        taken += simulator.run(block, steps, generator, tell)
        totals[begin : begin + size] = block.total
        unfinished += int((block.x != OVER).sum())
    later = max(abs(bound) for bound in return_range(problem))
    return SimulatedValue(
        mean=float(totals.mean()),
        standard_error=float(totals.std(ddof=1) / math.sqrt(episodes)),
        episodes=episodes,
        horizon=steps,
        unfinished=unfinished,
        truncation=problem.discount**steps * later * unfinished / episodes,
        steps=taken,
    )


class _Simulator:
    """The arrays that all blocks share."""

    def __init__(self, problem: MOMDP, policy: AlphaVectorPolicy) -> None:
        self._problem = problem
        self._arrays = as_arrays(problem)
        self._policy = as_columns(policy)
        self._ended = mark_ended(self._arrays)

    def start(self, size: int, rng: np.random.Generator) -> Episodes:
        """``size`` episodes before their first step."""
        roots = self._problem.roots
        chosen = _draw(np.array([root.probability for root in roots]), rng.random(size))
        uniform = rng.random(size)
        y = np.empty(size, dtype=np.int64)
        for r, root in enumerate(roots):
            here = chosen == r
            y[here] = _draw(root.belief, uniform[here])
        x = np.array([root.x for root in roots])[chosen]
        belief = np.stack([root.belief for root in roots])[chosen]
        x[self._ended[x, y]] = OVER
        return Episodes(x, y, belief, np.zeros(size))

    def run(
        self, block: Episodes, horizon: int, rng: np.random.Generator, tell: Callable[[float], None]
    ) -> int:
        """Run ``block`` for ``horizon`` steps; the number of steps taken by all its episodes."""
        size, taken = len(block.x), 0
        for begin in range(0, horizon, CALL_STEPS):
            tell(begin / horizon)
            if np.all(block.x == OVER):
                break
            uniform = rng.random((size, min(CALL_STEPS, horizon - begin), 2))
            weight = self._problem.discount**begin
            steps = run_steps(self._arrays, self._policy, self._ended, block, weight, uniform)
            if steps == NO_VECTOR:
                raise ValueError("found no alpha vector for an observed state that was met")
            taken += steps
        return taken


def _draw(distribution: FloatArray, uniform: FloatArray) -> IntArray:
    """Indices drawn from ``distribution`` by numbers in [0, 1)."""
    possible: IntArray = np.flatnonzero(distribution)
    cumulative: FloatArray = np.cumsum(distribution[possible])
    # What rounding leaves beyond the last sum belongs to the last index.
    passed = (uniform[:, None] >= cumulative[:-1]).sum(axis=1)
    return possible[passed]
