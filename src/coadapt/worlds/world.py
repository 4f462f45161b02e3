"""A world in which the robot alone moves: states, actions, moves, goals."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.human.history import NO_STATE

UNREACHABLE = -1
"""Distance of a state from which a goal cannot be reached."""

NO_GOAL = -1
"""Stands where a state is no goal."""

NEARNESS_DISCOUNT = 0.99
"""What one move more is worth to a robot that heads for one goal."""

SETTLED = 1e-13
"""Nearness is iterated until nothing changes by more."""


@dataclass(frozen=True)
class Goal:
    """States that end the task.

    Attributes:
        name: what people call it, for example "left".
        at: index of its state, or of several: a goal region.
        reward: what reaching it is worth, ``R_goal`` of Eq. 6.
    """

    name: str
    at: int | Sequence[int]
    reward: float

    @property
    def states(self) -> tuple[int, ...]:
        """Its states."""
        return (self.at,) if isinstance(self.at, int) else tuple(self.at)


@dataclass(frozen=True, eq=False)
class World:
    """Robot states and the moves between them.

    Attributes:
        name: short identifier, used in files and reports.
        moves: ``[X, A]`` the state each action leads to (``T: X_r x A_r -> X_r``, Sec. 2.2); a
            blocked move leads to its own state. Where moves are uncertain, ``[X, A, N]``: the
            different states each may lead to, filled up with `NO_STATE`.
        goals: one mode each, in the order of the modes.
        start: index of the first robot state.
        state_names: ``X`` labels.
        action_names: ``A`` labels.
        positions: ``[X, 2]`` where to draw each state: to the right, ahead (metres or cells).
        directions: ``[A, 2]`` where each action points on that drawing.
        chances: ``[X, A, N]`` the probability of each outcome, where moves are uncertain.
        starts: probability of each state in which the task may begin, ``start`` among them; by
            default it begins in ``start``.
        costs: ``[X, A]`` what a move costs the robot, at least 0, in the units of the rewards;
            nothing by default.

    Raises:
        ValueError: if the parts do not fit together.
    """

    name: str
    moves: IntArray
    goals: tuple[Goal, ...]
    start: int
    state_names: tuple[str, ...] = field(repr=False)
    action_names: tuple[str, ...]
    positions: FloatArray = field(repr=False)
    directions: FloatArray = field(repr=False)
    chances: FloatArray | None = field(default=None, repr=False)
    starts: Mapping[int, float] | None = None
    costs: FloatArray | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        states, actions = self.moves.shape[:2]
        _require_moves(self.moves, self.chances)
        if len(self.state_names) != states or len(self.action_names) != actions:
            raise ValueError("there must be one name for each state and action")
        if not self.goals:
            raise ValueError("a world needs at least one goal")
        goal_states = self.goal_states
        for where in (self.start, *self.start_chances, *goal_states):
            if not 0 <= where < states:
                raise ValueError(f"state {where} is not one of 0 to {states - 1}")
        for goal in self.goals:
            if not goal.states:
                raise ValueError(f"goal {goal.name} has no state")
        if len(set(goal_states)) < len(goal_states):
            raise ValueError("two goals share a state")
        if len({goal.name for goal in self.goals}) < len(self.goals):
            raise ValueError("two goals share a name")
        for where in self.start_chances:
            if where in goal_states:
                raise ValueError(f"the start, {self.state_names[where]}, is a goal")
        chances = np.array(list(self.start_chances.values()))
        if self.start not in self.start_chances or not _are_distributions(chances):
            raise ValueError(
                "starts must be positive probabilities that sum to 1, the start among them"
            )
        costs = self.costs
        if costs is not None and not (costs.shape == (states, actions) and _are_costs(costs)):
            raise ValueError(f"costs must be numbers of at least 0, of shape {(states, actions)}")

    @property
    def states(self) -> int:
        """Number of robot states ``|X_r|``."""
        return len(self.moves)

    @property
    def actions(self) -> int:
        """Number of robot actions ``|A_r|``."""
        return self.moves.shape[1]

    @property
    def is_deterministic(self) -> bool:
        """Whether every action has one outcome."""
        return self.moves.ndim == 2

    @property
    def outcomes(self) -> IntArray:
        """``[X, A, N]`` the states each action may lead to, `NO_STATE` after the last one."""
        return self.moves[:, :, None] if self.is_deterministic else self.moves

    @cached_property
    def outcome_chances(self) -> FloatArray:
        """``[X, A, N]`` the probability of each outcome."""
        return np.ones(self.outcomes.shape) if self.chances is None else self.chances

    @property
    def start_chances(self) -> Mapping[int, float]:
        """The probability of each state in which the task may begin."""
        return {self.start: 1.0} if self.starts is None else self.starts

    @property
    def goal_states(self) -> tuple[int, ...]:
        """The states of all goals, those of the first goal first."""
        return tuple(state for goal in self.goals for state in goal.states)

    @cached_property
    def goal_of(self) -> IntArray:
        """``[X]`` index of the goal in each state, or `NO_GOAL`."""
        found = np.full(self.states, NO_GOAL)
        for g, goal in enumerate(self.goals):
            found[list(goal.states)] = g
        return found

    @cached_property
    def ends(self) -> BoolArray:
        """``[X]`` where the task ends."""
        return self.goal_of != NO_GOAL

    @property
    def optimal_goal(self) -> int:
        """Index of the goal with the largest reward (the first one, on a tie)."""
        return max(range(len(self.goals)), key=lambda g: self.goals[g].reward)

    def goal_place(self, goal: int) -> str:
        """The names of the states of ``goal``."""
        return " or ".join(self.state_names[state] for state in self.goals[goal].states)

    def goal_at(self, state: int) -> int | None:
        """Index of the goal in ``state``, or None."""
        goal = int(self.goal_of[state])
        return None if goal == NO_GOAL else goal

    def distance(self, goal: int) -> IntArray:
        """``[X]`` fewest moves in which goal ``goal`` may be reached past no other goal.

        `UNREACHABLE` where there is no such path.
        """
        arrivals: list[list[int]] = [[] for _ in range(self.states)]
        for state in map(int, np.flatnonzero(~self.ends)):
            for following in map(int, self.moves[state].flat):
                if following != NO_STATE:
                    arrivals[following].append(state)
        steps = np.full(self.states, UNREACHABLE, dtype=np.int64)
        steps[list(self.goals[goal].states)] = 0
        queue = deque(self.goals[goal].states)
        while queue:
            state = queue.popleft()
            for before in arrivals[state]:
                if steps[before] == UNREACHABLE:
                    steps[before] = steps[state] + 1
                    queue.append(before)
        return steps

    def nearness(self, goal: int, discount: float = NEARNESS_DISCOUNT) -> FloatArray:
        """``[X, A]`` the discounted probability of reaching ``goal``, from 0 to 1.

        It is ``E[discount^n]`` for ``n`` moves of the best policy that begins with the action.
        Where moves are certain it is the larger the shorter the path.
        """
        steps = self.distance(goal)
        near = np.where(steps == UNREACHABLE, 0.0, discount ** np.maximum(steps, 0))
        shares = discount * self.outcome_chances
        going = ~self.ends
        # The shortest path is the best that can happen: from there it falls to what to expect.
        while True:
            after = (shares * near[self.outcomes]).sum(axis=2)
            change = np.abs(near[going] - after[going].max(axis=1)).max(initial=0.0)
            if self.is_deterministic or change <= SETTLED:
                return after
            near[going] = after[going].max(axis=1)


def _require_moves(moves: IntArray, chances: FloatArray | None) -> None:
    states = len(moves)
    if moves.ndim not in (2, 3):
        raise ValueError(f"moves have shape {moves.shape}, expected [X, A] or [X, A, N]")
    missing = moves == NO_STATE if moves.ndim == 3 else np.zeros(moves.shape, dtype=np.bool_)
    if np.any(~missing & ((moves < 0) | (moves >= states))):
        raise ValueError(f"moves must lead to states 0 to {states - 1}")
    if moves.ndim == 2:
        if chances is not None:
            raise ValueError("chances need moves of shape [X, A, N]")
        return
    if chances is None or chances.shape != moves.shape:
        raise ValueError("moves of shape [X, A, N] need chances of the same shape")
    if np.any(chances[missing] != 0) or not _are_distributions(
        chances[~missing], sums=chances.sum(axis=2)
    ):
        raise ValueError("the chances of an action's outcomes must be positive and sum to 1")
    ordered = np.sort(moves, axis=2)
    if np.any((ordered[:, :, 1:] == ordered[:, :, :-1]) & (ordered[:, :, 1:] != NO_STATE)):
        raise ValueError("the outcomes of an action must be different states")


def _are_distributions(chances: FloatArray, sums: FloatArray | None = None) -> bool:
    totals = chances.sum() if sums is None else sums
    return bool(np.all(chances > 0) and np.allclose(totals, 1.0, rtol=0, atol=1e-9))


def _are_costs(costs: FloatArray) -> bool:
    return bool(np.all(np.isfinite(costs)) and np.all(costs >= 0))
