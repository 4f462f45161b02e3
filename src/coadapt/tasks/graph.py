"""The part of a task that describes its place as a graph: states and moves, one by one."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.errors import excerpt
from coadapt.human.history import NO_STATE
from coadapt.requirements import (
    LARGEST_REWARD,
    MOST_ACTIONS,
    MOST_STATES,
    FieldError,
    Key,
    require,
    require_chance,
    require_known,
    require_names,
)
from coadapt.tasks.goal import TaskGoal
from coadapt.tasks.map import DIRECTIONS
from coadapt.worlds import Goal, World


class TaskGraph(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """States and the moves between them, one by one.

    Attributes:
        states: their names.
        actions: the robot's actions.
        start: the first state, or several with their probabilities.
        moves: for a state and an action the state it leads to, or several with their
            probabilities. What is left out leads nowhere: the robot stays.
        positions: where to draw a state: to the right, ahead; by default by its distance from the
            start.
        directions: where actions point; by default as their names say, if they are of `DIRECTIONS`.
        move_cost: what each move costs the robot, in units of reward, at least 0.
    """

    states: tuple[str, ...]
    actions: tuple[str, ...]
    start: str | dict[str, float]
    moves: dict[str, dict[str, str | dict[str, float]]]
    positions: dict[str, tuple[float, float]] = {}
    directions: dict[str, tuple[float, float]] = {}
    move_cost: float = 0.0

    def __post_init__(self) -> None:
        require_names(("states",), self.states, MOST_STATES)
        require_names(("actions",), self.actions, MOST_ACTIONS)
        require_chance(("move_cost",), self.move_cost, LARGEST_REWARD, most_included=True)
        known_states, known_actions = set(self.states), set(self.actions)
        self._require_chances(("start",), self.start, known_states)
        for state, steps in self.moves.items():
            require_known(("moves", state), state, known_states, "states")
            for action, outcome in steps.items():
                key = ("moves", state, action)
                require_known(key, action, known_actions, "actions")
                self._require_chances(key, outcome, known_states)
        for name, known in (("positions", known_states), ("directions", known_actions)):
            points: dict[str, tuple[float, float]] = getattr(self, name)
            for place, point in points.items():
                where = "states" if name == "positions" else "actions"
                require_known((name, place), place, known, where)
                small = all(abs(x) <= LARGEST_REWARD for x in point)
                require((name, place), small, "two numbers", point)
        if self.positions and len(self.positions) < len(self.states):
            missing = next(state for state in self.states if state not in self.positions)
            raise FieldError(("positions",), f"lacks {excerpt(missing)}, expected all or none")

    def _require_chances(self, key: Key, given: str | dict[str, float], known: set[str]) -> None:
        outcomes = {given: 1.0} if isinstance(given, str) else given
        for state, chance in outcomes.items():
            require_known(key, state, known, "states")
            require(key, 0 < chance <= 1, "positive probabilities", chance)
        total = sum(outcomes.values())
        require(key, abs(total - 1) <= 1e-9, "probabilities that sum to 1", f"a sum of {total:g}")

    def build(self, name: str, goals: Sequence[TaskGoal]) -> World:
        """The world.

        Raises:
            FieldError: if the states and the goals do not fit together.
        """
        number = {state: i for i, state in enumerate(self.states)}
        placed: list[Goal] = []
        for i, goal in enumerate(goals):
            if goal.symbol is not None:
                raise FieldError(("goals", i, "symbol"), "is for maps; a graph has states")
            states = (goal.name,) if goal.states is None else goal.states
            key = ("goals", i, "name" if goal.states is None else "states")
            require(key, bool(states), "at least one state", "none")
            for state in states:
                require_known(key, state, number.keys(), "states")
            placed.append(Goal(goal.name, [number[s] for s in states], goal.reward))
        starts = {self.start: 1.0} if isinstance(self.start, str) else self.start
        chances = {number[state]: chance for state, chance in starts.items()}
        moves, shares = self._outcomes(number)
        default = self._layers(moves, list(chances))
        return World(
            name=name,
            moves=moves,
            chances=shares,
            goals=tuple(placed),
            start=next(iter(chances)),
            starts=chances if len(chances) > 1 else None,
            state_names=self.states,
            action_names=self.actions,
            positions=np.array([self.positions.get(s, default[s]) for s in self.states]),
            directions=np.array(
                [self.directions.get(a, DIRECTIONS.get(a, (0, 0))) for a in self.actions],
                dtype=np.float64,
            ),
            costs=np.full((len(self.states), len(self.actions)), self.move_cost)
            if self.move_cost > 0
            else None,
        )

    def _outcomes(self, number: dict[str, int]) -> tuple[IntArray, FloatArray | None]:
        """Moves, and the chances where one of them is uncertain."""
        listed = [
            [
                {found: 1.0} if isinstance(found := self.moves.get(s, {}).get(a, s), str) else found
                for a in self.actions
            ]
            for s in self.states
        ]
        width = max(len(outcome) for row in listed for outcome in row)
        moves = np.full((len(listed), len(self.actions), width), NO_STATE)
        chances = np.zeros(moves.shape)
        for x, row in enumerate(listed):
            for a, outcome in enumerate(row):
                for n, (state, chance) in enumerate(outcome.items()):
                    moves[x, a, n], chances[x, a, n] = number[state], chance
        return (moves[:, :, 0], None) if width == 1 else (moves, chances)

    def _layers(self, moves: IntArray, starts: Sequence[int]) -> dict[str, tuple[float, float]]:
        """Positions by the number of moves from the start; what cannot be reached comes last."""
        places: dict[str, tuple[float, float]] = {}
        layer, ahead = list(starts), 0
        while layer:
            for i, x in enumerate(layer):
                places[self.states[x]] = (float(i), float(ahead))
            following = np.unique(moves[layer])
            layer = [
                x for x in following.tolist() if x != NO_STATE and self.states[x] not in places
            ]
            ahead += 1
        for i, state in enumerate(s for s in self.states if s not in places):
            places[state] = (float(i), float(ahead))
        return places
