"""A world in which the robot alone moves: states, actions, deterministic moves, goals."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

import numpy as np

from coadapt.arrays import FloatArray, IntArray

UNREACHABLE = -1
"""Distance of a state from which a goal cannot be reached."""


@dataclass(frozen=True)
class Goal:
    """A state that ends the task.

    Attributes:
        name: what people call it, for example "left".
        state: index of the state.
        reward: what reaching it is worth, ``R_goal`` of Eq. 6.
    """

    name: str
    state: int
    reward: float


@dataclass(frozen=True, eq=False)
class World:
    """Robot states and the moves between them.

    Attributes:
        name: short identifier, used in files and reports.
        moves: ``[X, A]`` the state each action leads to (``T: X_r x A_r -> X_r``, Sec. 2.2); a
            blocked move leads to its own state.
        goals: one mode each, in the order of the modes.
        start: index of the first robot state.
        state_names: ``X`` labels.
        action_names: ``A`` labels.
        positions: ``[X, 2]`` where to draw each state: to the right, ahead (metres or cells).
        directions: ``[A, 2]`` where each action points on that drawing.
    """

    name: str
    moves: IntArray
    goals: tuple[Goal, ...]
    start: int
    state_names: tuple[str, ...] = field(repr=False)
    action_names: tuple[str, ...]
    positions: FloatArray = field(repr=False)
    directions: FloatArray = field(repr=False)

    def __post_init__(self) -> None:
        states, actions = self.moves.shape
        if self.moves.min(initial=0) < 0 or self.moves.max(initial=0) >= states:
            raise ValueError(f"moves must lead to states 0 to {states - 1}")
        if len(self.state_names) != states or len(self.action_names) != actions:
            raise ValueError("there must be one name for each state and action")
        if not self.goals:
            raise ValueError("a world needs at least one goal")
        goal_states = self.goal_states
        for where in (self.start, *goal_states):
            if not 0 <= where < states:
                raise ValueError(f"state {where} is not one of 0 to {states - 1}")
        if len(set(goal_states)) < len(goal_states):
            raise ValueError("two goals share a state")
        if len({goal.name for goal in self.goals}) < len(self.goals):
            raise ValueError("two goals share a name")
        if self.start in goal_states:
            raise ValueError(f"the start, {self.state_names[self.start]}, is a goal")

    @property
    def states(self) -> int:
        """Number of robot states ``|X_r|``."""
        return len(self.moves)

    @property
    def actions(self) -> int:
        """Number of robot actions ``|A_r|``."""
        return self.moves.shape[1]

    @property
    def goal_states(self) -> tuple[int, ...]:
        """The state of each goal."""
        return tuple(goal.state for goal in self.goals)

    @property
    def optimal_goal(self) -> int:
        """Index of the goal with the largest reward (the first one, on a tie)."""
        return max(range(len(self.goals)), key=lambda g: self.goals[g].reward)

    def goal_at(self, state: int) -> int | None:
        """Index of the goal in ``state``, or None."""
        return next((g for g, goal in enumerate(self.goals) if goal.state == state), None)

    def distance(self, goal: int) -> IntArray:
        """``[X]`` number of moves on a shortest path to goal ``goal`` past no other goal.

        `UNREACHABLE` where there is no such path.
        """
        arrivals: list[list[int]] = [[] for _ in range(self.states)]
        for state in range(self.states):
            if state not in self.goal_states:
                for following in map(int, self.moves[state]):
                    arrivals[following].append(state)
        steps = np.full(self.states, UNREACHABLE, dtype=np.int64)
        steps[self.goals[goal].state] = 0
        queue = deque([self.goals[goal].state])
        while queue:
            state = queue.popleft()
            for before in arrivals[state]:
                if steps[before] == UNREACHABLE:
                    steps[before] = steps[state] + 1
                    queue.append(before)
        return steps
