"""Worlds: what they refuse, and how far their goals are."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given

from coadapt.human.history import NO_STATE
from coadapt.worlds import Goal, World
from coadapt.worlds.world import UNREACHABLE
from tests.worlds.strategies import worlds

# 0 - 1 - 2 - 3 in a row, with moves down and up.
ROW = World(
    name="row",
    moves=np.array([[0, 1], [0, 2], [1, 3], [2, 3]]),
    goals=(Goal("low", 0, 5.0), Goal("high", 3, 7.0)),
    start=1,
    state_names=("a", "b", "c", "d"),
    action_names=("down", "up"),
    positions=np.zeros((4, 2)),
    directions=np.zeros((2, 2)),
)

UNSURE = np.tile([2, 3], (4, 2, 1))  # every move of two outcomes leads to c or d


def steps_forward(world: World, start: int, goal: int) -> int:
    """Fewest moves from ``start`` to ``goal`` past no other goal, by widening a circle."""
    others = set(world.goal_states) - {world.goals[goal].at}
    circle, seen, steps = {start}, {start}, 0
    while circle:
        if world.goals[goal].at in circle:
            return steps
        circle = {int(n) for s in circle if s not in others for n in world.moves[s]} - seen
        seen |= circle
        steps += 1
    return UNREACHABLE


@given(worlds(general=True))
def test_distances_where_moves_are_uncertain_are_those_of_the_best_luck(world: World) -> None:
    # The same world in which the robot chooses the outcome too.
    states, actions, outcomes = world.outcomes.shape
    here = np.arange(states)[:, None, None]
    free = np.where(world.outcomes == NO_STATE, here, world.outcomes).reshape(states, -1)
    certain = replace(
        world,
        moves=free,
        chances=None,
        costs=None,
        action_names=tuple(f"a{a}" for a in range(actions * outcomes)),
    )
    for goal in range(len(world.goals)):
        assert world.distance(goal).tolist() == certain.distance(goal).tolist()


@given(worlds(general=True))
def test_nearness_is_the_value_of_the_best_policy(world: World) -> None:
    # Values of the best policy solve linear equations; no other action does better.
    for goal in range(len(world.goals)):
        near = world.nearness(goal, 0.9)
        best = near.argmax(axis=1)
        system = np.eye(world.states)
        reached = np.isin(np.arange(world.states), world.goals[goal].states).astype(np.float64)
        for x in np.flatnonzero(~world.ends):
            for y, chance in zip(
                world.outcomes[x, best[x]], world.outcome_chances[x, best[x]], strict=True
            ):
                system[x, y] -= 0.9 * chance
        value = np.linalg.solve(system, reached)
        np.testing.assert_allclose(
            near[np.arange(world.states), best][~world.ends], value[~world.ends], atol=1e-10
        )
        after = 0.9 * (world.outcome_chances * value[world.outcomes]).sum(axis=2)
        np.testing.assert_allclose(near, after, atol=1e-10)


@given(worlds())
def test_distances_are_those_of_a_search_from_every_state(world: World) -> None:
    for goal in range(len(world.goals)):
        expected = [steps_forward(world, state, goal) for state in range(world.states)]
        assert world.distance(goal).tolist() == expected


def test_a_row() -> None:
    assert (ROW.states, ROW.actions) == (4, 2)
    assert ROW.goal_states == (0, 3)
    assert ROW.optimal_goal == 1
    assert [ROW.goal_at(s) for s in range(4)] == [0, None, None, 1]
    # The other goal is 3 moves away, but the task is over there.
    assert ROW.distance(0).tolist() == [0, 1, 2, UNREACHABLE]
    assert ROW.distance(1).tolist() == [UNREACHABLE, 2, 1, 0]


def test_of_equal_goals_the_first_is_optimal() -> None:
    assert replace(ROW, goals=(Goal("low", 0, 7.0), Goal("high", 3, 7.0))).optimal_goal == 0


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        (dict(moves=np.array([[0, 1], [0, 2], [1, 4], [2, 3]])), "moves must lead"),
        (dict(moves=np.array([[0, 1], [0, 2], [1, -1], [2, 3]])), "moves must lead"),
        (dict(state_names=("a", "b", "c")), "one name for each"),
        (dict(action_names=("down", "up", "on")), "one name for each"),
        (dict(goals=()), "at least one goal"),
        (dict(goals=(Goal("low", 4, 5.0),)), "state 4 is not one of 0 to 3"),
        (dict(goals=(Goal("low", -1, 5.0),)), "state -1 is not"),
        (dict(start=4), "state 4 is not"),
        (dict(start=-1), "state -1 is not"),
        (dict(goals=(Goal("low", 0, 5.0), Goal("high", 0, 7.0))), "share a state"),
        (dict(start=3), "the start, d, is a goal"),
        (dict(goals=(Goal("low", (), 5.0),)), "goal low has no state"),
        (dict(goals=(Goal("low", (0, 3), 5.0), Goal("high", 3, 7.0))), "share a state"),
        (dict(starts={2: 1.0}), "the start among them"),
        (dict(starts={1: 0.5, 2: 0.4}), "sum to 1"),
        (dict(starts={1: 0.5, 3: 0.5}), "the start, d, is a goal"),
        (dict(starts={1: 0.5, 4: 0.5}), "state 4 is not one of 0 to 3"),
        (dict(costs=np.zeros((4, 3))), "of shape"),
        (dict(costs=np.full((4, 2), -1.0)), "at least 0"),
        (dict(chances=np.ones((4, 2))), "chances need moves of shape"),
        (dict(moves=UNSURE), "need chances of the same shape"),
        (dict(moves=UNSURE, chances=np.full((4, 2, 2), 0.4)), "sum to 1"),
        (dict(moves=UNSURE + 1, chances=np.full((4, 2, 2), 0.5)), "moves must lead"),
        (dict(moves=0 * UNSURE, chances=np.full((4, 2, 2), 0.5)), "different states"),
    ],
)
def test_bad_worlds_are_refused(parts: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(ROW, **parts)
