"""The arrays of one search and their upkeep between kernel calls."""

from __future__ import annotations

from functools import cache

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.jit import is_compiled
from coadapt.momdp.model import MOMDP, Root
from coadapt.momdp.policy import AlphaVectorPolicy
from coadapt.momdp.sarsop.bounds import add_vectors
from coadapt.momdp.sarsop.controller import controller, controller_values
from coadapt.momdp.sarsop.expand import plant
from coadapt.momdp.sarsop.initial import (
    SETTLED,
    fast_informed_bound,
    mdp_values,
    observed_policies,
    policy_values,
)
from coadapt.momdp.sarsop.problem import Problem, as_arrays
from coadapt.momdp.sarsop.prune import prune_vectors, retire_points, retire_vectors
from coadapt.momdp.sarsop.sample import (
    CLOSED,
    MANY_POINTS,
    MANY_VECTORS,
    NO_ROOM,
    STALLED,
    Bins,
    new_bins,
    run_trials,
)
from coadapt.momdp.sarsop.solution import Record, Solution, Status
from coadapt.momdp.sarsop.tree import (
    BACKUPS,
    BLOCK,
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
    lacking,
    new_scratch,
    new_tree,
    size_after,
    size_of,
    size_of_first,
)

SWEEPS = 10_000
"""Most sweeps of each initial bound."""

WORK = 20_000_000
"""Most products that go into the fast informed bound: where it takes more, search does better."""

VALUES = 400_000
"""Most values that are computed for each policy that starts the lower bound."""

FEWER_VALUES = 40_000
"""The same for policies that take one action everywhere though they see where they are: others have
the better values then, and these are slow to settle."""

NUMBERS = 16_000_000
"""Most numbers in the alpha vectors that the search starts from, if one policy has no more."""

ENDS = {CLOSED: Status.GAP, STALLED: Status.PRECISION}


COMPILING = "compiling the solver once for this machine, which takes about half a minute"


def kernels_are_compiled() -> bool:
    """Whether `compile_kernels` finds all on disk."""
    return is_compiled(run_trials)


@cache
def compile_kernels(controllers: bool = False) -> None:
    """Load the compiled kernels, or compile them and keep them on disk.

    Those that read policies as ``controllers``, which few searches need, only if asked for.
    """
    # One backup of a problem with one state touches every kernel that a search calls.
    problem = MOMDP.from_arrays(
        transition_x=np.ones((1, 1, 1)),
        transition_y=np.ones((1, 1, 1, 1)),
        observation=np.ones((1, 1, 1, 1)),
        reward=np.ones((1, 1, 1)),
        discount=0.5,
        roots=[Root(0, np.ones(1))],
    )
    policy = AlphaVectorPolicy(np.array([0, 1]), np.zeros((1, 1)), np.array([0]))
    search = Search(problem, policy if controllers else None)
    search.run(1e-3, 0.0, 1)
    search.tidy(np.full(COUNTS, 1 << 40))  # more than there is
    _ = search.record(0.0)


class Search:
    """One search of one problem."""

    def __init__(
        self,
        problem: MOMDP,
        start: AlphaVectorPolicy | None = None,
        memory_limit: int | None = None,
    ) -> None:
        """The first bounds of ``problem``, in at most ``memory_limit`` bytes of arrays.

        Raises:
            MemoryError: if they take more.
        """
        self._memory_limit = memory_limit
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
        self._room[VECTORS] = self._room[GROUPS] = 1
        self._room[POINTS] = BLOCK
        self._scratch = new_scratch(self._arrays)
        self._tree, self._bins = self._begin(self._arrays, start)
        self._roots = self._plant()
        # With any gap allowed the roots look at the first vectors, and nothing is searched.
        _ = self.run(np.inf, 0.0, 0)

    @property
    def backups(self) -> int:
        return int(self._tree.used[BACKUPS])

    def run(self, gap: float, relative_gap: float, backups: int) -> Status | None:
        """Do at most about ``backups`` backups; why there is no point in going on, or None.

        Fewer where the arrays had to grow, so that the caller can look at the clock.
        """
        limit = self._memory_limit
        if limit is not None and size_of(self._tree) > limit:
            return Status.MEMORY
        stop = self.backups + backups
        while True:
            state = run_trials(
                self._arrays,
                self._tree,
                self._bins,
                self._roots,
                gap,
                relative_gap,
                stop,
                self._room,
                self._scratch,
            )
            if state == MANY_VECTORS:
                retire_vectors(self._tree)
            elif state == MANY_POINTS:
                retire_points(self._tree)
            else:
                break
        if state != NO_ROOM:
            return ENDS.get(state)
        self.tidy(self._room)
        # Ask for ample room, or pruning would be due again at once.
        room = np.maximum(self._room, self._tree.used // 4)
        room[POINTS] = max(room[POINTS], self._tree.used[POINTS])
        if limit is not None and size_after(self._tree, room) > limit:
            return Status.MEMORY
        grow(self._tree, room)
        return None

    def tidy(self, room: IntArray) -> None:
        """Forget the vectors, or the points, that others replaced where ``room`` is lacking."""
        short = lacking(self._tree, room)
        if VECTORS in short or GROUPS in short:
            prune_vectors(self._tree)
            retire_vectors(self._tree)
        if POINTS in short:
            retire_points(self._tree)

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
            memory=size_of(self._tree),
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

    def _most_policies(self) -> int:
        """How many policies may start the lower bound."""
        most = NUMBERS // self._problem.states
        if self._memory_limit is not None:
            free = self._memory_limit - size_of_first(self._arrays)
            # Each is held twice: as it is, and in a group.
            most = min(most, 1 + free // (2 * 8 * self._problem.states))
        return max(1, most)

    def _begin(self, p: Problem, start: AlphaVectorPolicy | None) -> tuple[Tree, Bins]:
        least, limit = size_of_first(p), self._memory_limit
        if limit is not None and least > limit:
            raise MemoryError(
                f"memory_limit: the first bounds take {least:,} bytes, which is more than {limit:,}"
            )
        tolerance = SETTLED * float(np.abs(p.reward).max(initial=1e-6))
        q = mdp_values(p, tolerance, SWEEPS)
        policies = observed_policies(q, self._most_policies())
        fast_informed_bound(p, q, tolerance, SWEEPS, WORK)
        tree = new_tree(p, q)
        states = p.reward.shape[0]
        room = np.zeros_like(self._room)
        room[VECTORS] = states * len(policies)
        room[GROUPS] = states * -(-len(policies) // tree.lane_alpha.shape[2])
        grow(tree, room)
        for policy, order in policies:
            blind = states > 1 and bool((policy == policy[0]).all())
            most = FEWER_VALUES if blind else VALUES
            sweeps = min(SWEEPS, max(5, most // self._problem.states))
            values = policy_values(p, policy, order, tolerance, sweeps)
            add_vectors(tree, np.arange(states, dtype=np.int64), values, policy)
        if start is not None:
            states_met = controller(self._problem, p, start)
            # More exactly than the policies above: this is where the search goes on.
            vectors = controller_values(p, states_met)
            room[VECTORS] = room[GROUPS] = len(vectors)
            grow(tree, room)
            add_vectors(tree, states_met.x, vectors, states_met.action)
        prune_vectors(tree)
        tree.used[KEPT] = tree.used[LISTED]
        return tree, new_bins(float(tree.corner.min()), float(tree.corner.max()))

    def _plant(self) -> IntArray:
        """The nodes of the roots."""
        grow(self._tree, len(self._problem.roots) * self._room)
        nodes: list[int] = []
        for root in self._problem.roots:
            support = np.flatnonzero(root.belief)
            mass = root.belief[support]
            nodes.append(plant(self._tree, root.x, support, mass, self._scratch))
        return np.array(nodes, dtype=np.int64)

    def _root_bounds(self) -> tuple[FloatArray, FloatArray]:
        roots = self._tree.nodes[self._roots]
        return roots["lower"].copy(), roots["upper"].copy()

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
