"""Worlds: what they refuse, and how far their goals are."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given

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
    ],
)
def test_bad_worlds_are_refused(parts: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(ROW, **parts)
