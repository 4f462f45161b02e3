"""SARSOP: point-based planning near the beliefs an optimal policy reaches.

Kurniawati, Hsu, Lee, "SARSOP: Efficient point-based POMDP planning by approximating optimally
reachable belief spaces", RSS 2008; for mixed observability Ong, Png, Hsu, Lee, IJRR 2010.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from time import perf_counter

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.momdp.model import MOMDP
from coadapt.momdp.policy import AlphaVectorPolicy
from coadapt.momdp.sarsop.bounds import add_vector, refresh_lower, refresh_upper
from coadapt.momdp.sarsop.expand import add_node
from coadapt.momdp.sarsop.initial import (
    SETTLED,
    fast_informed_bound,
    mdp_values,
    observed_policies,
    policy_values,
)
from coadapt.momdp.sarsop.problem import Problem, as_arrays
from coadapt.momdp.sarsop.progress import ProgressLine
from coadapt.momdp.sarsop.prune import prune_points, prune_vectors
from coadapt.momdp.sarsop.sample import CLOSED, NO_ROOM, STALLED, Bins, new_bins, run_trials
from coadapt.momdp.sarsop.tree import (
    BACKUPS,
    BRANCHES,
    CHILDREN,
    COUNTS,
    ENTRIES,
    GROUPS,
    KEPT,
    LISTED,
    NODES,
    NONE,
    POINTS,
    VECTORS,
    Tree,
    grow,
    new_tree,
)

SWEEPS = 10_000
"""Most sweeps of each initial bound."""

POLICIES = 8
"""Most hidden states whose best policy starts the lower bound."""

CALL_SECONDS = 0.1
"""About how long a kernel runs before Python looks up."""


class Status(Enum):
    """Why the solver stopped: the gap is closed, or else what ended the search before that.

    ``PRECISION`` means that the bounds no longer move in floating-point numbers.
    """

    GAP = "gap"
    PRECISION = "precision"
    BACKUPS = "backups"
    TIME = "time"
    INTERRUPTED = "interrupted"


ENDS = {CLOSED: Status.GAP, STALLED: Status.PRECISION}


@dataclass(frozen=True)
class Record:
    """Where the solver stood after some work.

    Attributes:
        seconds: since the start of solving.
        backups: number of backups.
        lower, upper: bounds of the value, weighted by the probability of the roots.
        gap: largest difference of the bounds at any root.
        vectors: number of alpha vectors.
    """

    seconds: float
    backups: int
    lower: float
    upper: float
    gap: float
    vectors: int


@dataclass(frozen=True)
class Solution:
    """A policy with certified bounds.

    Attributes:
        policy: its value at each root is at least ``root_lower``.
        root_lower, root_upper: ``[R]`` bounds of the optimal value at each root of the problem.
        lower, upper: the same weighted by the probability of the roots.
        status: why the solver stopped.
        trace: bounds over work; the last record is the end.
        backups: number of backups.
        vectors: number of alpha vectors of the policy.
        seconds: wall-clock time of solving.
    """

    policy: AlphaVectorPolicy
    root_lower: FloatArray
    root_upper: FloatArray
    lower: float
    upper: float
    status: Status
    trace: tuple[Record, ...]
    backups: int
    vectors: int
    seconds: float

    @property
    def gap(self) -> float:
        """Largest difference of the bounds at any root."""
        return float(np.max(self.root_upper - self.root_lower))


@dataclass(frozen=True)
class SARSOP:
    """The solver's settings. For given settings without a time limit its result is fixed.

    Attributes:
        gap: stop once the bounds at every root are at most this far apart, in reward units.
        max_backups: stop after about this many backups (the trial under way is finished).
        time_limit: stop after about this many seconds. The result then depends on the machine.
        progress: show a line with the bounds on standard error.
        callback: called with every `Record` of the trace.

    Raises:
        ValueError: if a setting is out of its range.
    """

    gap: float = 1e-3
    max_backups: int | None = None
    time_limit: float | None = None
    progress: bool = False
    callback: Callable[[Record], None] | None = None

    def __post_init__(self) -> None:
        if not self.gap > 0:
            raise ValueError(f"gap must be positive, not {self.gap}")
        if self.max_backups is not None and self.max_backups < 0:
            raise ValueError(f"max_backups must be at least 0, not {self.max_backups}")
        if self.time_limit is not None and not self.time_limit >= 0:
            raise ValueError(f"time_limit must be at least 0 seconds, not {self.time_limit}")

    def solve(self, problem: MOMDP) -> Solution:
        """Plan for ``problem``.

        Ctrl-C ends the search and returns the best policy so far, with status ``INTERRUPTED``.
        """
        with ProgressLine(self.progress) as line:
            line.say("preparing kernels and initial bounds")
            start = perf_counter()
            search = _Search(problem)
            trace: list[Record] = []

            def record() -> None:
                trace.append(search.record(perf_counter() - start))
                if self.callback is not None:
                    self.callback(trace[-1])

            record()
            try:
                status = self._search(search, start, record, line)
            except KeyboardInterrupt:
                status = Status.INTERRUPTED
            record()
            return search.solution(status, tuple(trace), perf_counter() - start)

    def _search(
        self, search: _Search, start: float, record: Callable[[], None], line: ProgressLine
    ) -> Status:
        last = self.max_backups
        call = 50  # backups asked of the next kernel call
        next_record = 100
        while True:
            done = search.backups
            seconds = perf_counter() - start
            line.show(search.record, seconds)
            if last is not None and done >= last:
                return Status.BACKUPS
            if self.time_limit is not None and seconds >= self.time_limit:
                return Status.TIME
            if done >= next_record:
                record()
                # Records lie a tenth of the work apart: at the same work on every machine.
                next_record = done + max(100, done // 10)
            ahead = min(call, next_record - done)
            if last is not None:
                ahead = min(ahead, last - done)
            before = perf_counter()
            ended = search.run(self.gap, ahead)
            if ended is not None:
                return ended
            spent = perf_counter() - before
            call = int(np.clip(call * CALL_SECONDS / max(spent, 1e-6), call / 2, call * 2)) + 1


class _Search:
    """The arrays of one search, and their upkeep between kernel calls."""

    def __init__(self, problem: MOMDP) -> None:
        self._problem = problem
        self._weight = np.array([root.probability for root in problem.roots])
        self._arrays = as_arrays(problem)
        _, hidden, actions, observations = problem.shape
        fan = int(np.diff(problem.edge_start).max(initial=1)) * observations
        self._room = np.zeros(COUNTS, dtype=np.int64)
        # The most that opening one node and backing it up may add.
        self._room[NODES] = self._room[CHILDREN] = actions * fan
        self._room[ENTRIES] = actions * fan * hidden
        self._room[BRANCHES] = actions
        self._room[VECTORS] = self._room[GROUPS] = self._room[POINTS] = 1
        self._tree, self._bins = self._begin(self._arrays)
        self._roots = self._plant()

    @property
    def backups(self) -> int:
        return int(self._tree.used[BACKUPS])

    def run(self, gap: float, backups: int) -> Status | None:
        """Do about ``backups`` backups; why there is no point in going on, or None."""
        stop = self.backups + backups
        while True:
            ahead = max(stop - self.backups, 0)
            state = run_trials(
                self._arrays, self._tree, self._bins, self._roots, gap, ahead, self._room
            )
            if state != NO_ROOM:
                return ENDS.get(state)
            prune_vectors(self._tree)
            prune_points(self._tree)
            # Ask for ample room, or pruning would be due again at once.
            room = np.maximum(self._room, self._tree.used // 4)
            self._tree = grow(self._tree, room)

    def record(self, seconds: float) -> Record:
        lower, upper = self._root_bounds()
        return Record(
            seconds=seconds,
            backups=self.backups,
            lower=float((self._weight * lower).sum()),
            upper=float((self._weight * upper).sum()),
            gap=float(np.max(upper - lower)),
            vectors=int(
                (self._tree.vectors["replaced_by"][: self._tree.used[VECTORS]] == NONE).sum()
            ),
        )

    def solution(self, status: Status, trace: tuple[Record, ...], seconds: float) -> Solution:
        policy = self._policy()
        # The bounds handed out are those of the policy handed out, not of the search.
        lower = np.array([policy.value(r.x, r.belief) for r in self._problem.roots])
        _, upper = self._root_bounds()
        return Solution(
            policy=policy,
            root_lower=lower,
            root_upper=upper,
            lower=float((self._weight * lower).sum()),
            upper=float((self._weight * upper).sum()),
            status=status,
            trace=trace,
            backups=self.backups,
            vectors=len(policy.vectors),
            seconds=seconds,
        )

    def _begin(self, p: Problem) -> tuple[Tree, Bins]:
        tolerance = SETTLED * float(np.abs(p.reward).max(initial=1e-6))
        q = mdp_values(p, tolerance, SWEEPS)
        policies = observed_policies(q, POLICIES)
        fast_informed_bound(p, q, tolerance, SWEEPS)
        tree = new_tree(p, q)
        states = p.reward.shape[0]
        room = np.zeros_like(self._room)
        room[VECTORS] = room[GROUPS] = states * len(policies)
        tree = grow(tree, room)
        for policy in policies:
            values = policy_values(p, policy, tolerance, SWEEPS)
            for x in range(states):
                add_vector(tree, x, values[x], int(policy[x]))
        prune_vectors(tree)
        tree.used[KEPT] = tree.used[LISTED]
        return tree, new_bins(float(tree.corner.min()), float(tree.corner.max()))

    def _plant(self) -> IntArray:
        """The nodes of the roots."""
        self._tree = grow(self._tree, len(self._problem.roots) * self._room)
        nodes: list[int] = []
        for root in self._problem.roots:
            support = np.flatnonzero(root.belief)
            mass = root.belief[support]
            nodes.append(add_node(self._tree, root.x, support, mass))
        return np.array(nodes, dtype=np.int64)

    def _root_bounds(self) -> tuple[FloatArray, FloatArray]:
        scratch = np.zeros(self._arrays.reward.shape[2])
        lower = [refresh_lower(self._tree, n) for n in self._roots]
        upper = [refresh_upper(self._tree, n, scratch) for n in self._roots]
        return np.array(lower), np.array(upper)

    def _policy(self) -> AlphaVectorPolicy:
        tree = self._tree
        alive = np.flatnonzero(tree.vectors["replaced_by"][: tree.used[VECTORS]] == NONE)
        observed = tree.vectors["x"][alive]
        order = alive[np.argsort(observed, kind="stable")]
        counts = np.bincount(observed, minlength=len(tree.newest_vector))
        return AlphaVectorPolicy(
            start=np.concatenate(([0], np.cumsum(counts))),
            vectors=tree.alpha[order].copy(),
            actions=tree.vectors["action"][order],
        )
