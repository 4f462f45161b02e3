"""Worlds that two move: the checks, the distances, and the two published tasks."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given

from coadapt.worlds import Goal
from coadapt.worlds.hallway import hallway
from coadapt.worlds.joint import JointWorld
from coadapt.worlds.table_carrying import table_carrying
from coadapt.worlds.world import UNREACHABLE
from tests.worlds.joint_strategies import joint_worlds

LEFT, RIGHT = 0, 1


@given(joint_worlds())
def test_distances_are_those_of_paths_past_no_other_goal(world: JointWorld) -> None:
    for g, goal in enumerate(world.goals):
        # Fewest steps by Bellman's equation, swept until it holds.
        steps = np.where(np.arange(world.states) == goal.at, 0.0, np.inf)
        for _ in range(world.states):
            for x in range(world.states):
                if x not in world.goal_states:
                    steps[x] = 1 + min(steps[y] for y in world.moves[x].ravel())
        expected = np.where(np.isinf(steps), UNREACHABLE, steps)
        np.testing.assert_array_equal(world.distance(g), expected)


def test_a_table_turns_when_both_push_the_same_way() -> None:
    world = table_carrying()
    here = world.start
    assert world.moves[here, LEFT, LEFT] == here - 1
    assert world.moves[here, RIGHT, RIGHT] == here + 1
    assert world.moves[here, LEFT, RIGHT] == world.moves[here, RIGHT, LEFT] == here
    # It starts tilted towards the worse goal.
    assert [goal.name for goal in world.goals] == ["left", "right"]
    assert world.optimal_goal == RIGHT
    assert world.distance(LEFT)[here] == 6
    assert world.distance(RIGHT)[here] == 7
    assert np.linalg.norm(world.positions, axis=1) == pytest.approx(1.0)


@pytest.mark.parametrize("start", list(hallway().starts))
def test_they_pass_where_both_go_to_their_own_left_or_right(start: int) -> None:
    world = hallway()
    for side in (LEFT, RIGHT):
        assert world.goal_at(int(world.moves[start, side, side])) == side
    for robot, human in ((LEFT, RIGHT), (RIGHT, LEFT)):
        reached = int(world.moves[start, robot, human])
        assert world.goal_at(reached) is None
        human_side, robot_side = divmod(reached, 2)
        assert human_side == robot_side


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (dict(moves=np.zeros((14, 2), dtype=np.int64)), "expected .X, A_r, A_h."),
        (dict(moves=np.full((14, 2, 2), 14)), "states 0 to 13"),
        (dict(action_names=("left",)), "names for"),
        (dict(positions=np.zeros((2, 2))), "positions have shape"),
        (dict(goals=()), "at least one goal"),
        (dict(starts={}), "sum to 1"),
        (dict(starts={3: 0.5}), "sum to 1"),
        (dict(starts={20: 1.0}), "state 20 is not one of 0 to 13"),
        (dict(starts={0: 1.0}), "the start, orientation 0, is a goal"),
        (dict(goals=(Goal("a", (), 1.0),)), "goal a has no state"),
        (dict(goals=(Goal("a", 0, 1.0), Goal("b", 0, 2.0))), "share a state"),
        (dict(goals=(Goal("a", 0, 1.0), Goal("a", 1, 2.0))), "share a name"),
    ],
)
def test_bad_worlds_are_refused(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(table_carrying(), **changed)


def test_too_few_orientations_are_refused() -> None:
    with pytest.raises(ValueError, match="at least 1 orientation"):
        table_carrying(0)
