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
from tests.worlds.joint_strategies import joint_worlds

LEFT, RIGHT = 0, 1


@given(joint_worlds())
def test_moves_are_those_of_one_who_chooses_both_actions(world: JointWorld) -> None:
    together = world.together
    human_actions = len(world.human_action_names)
    for x, a, h in np.ndindex(world.moves.shape[:3]):
        found = dict(
            zip(
                together.outcomes[x, a * human_actions + h].tolist(),
                together.outcome_chances[x, a * human_actions + h].tolist(),
                strict=True,
            )
        )
        here = world.outcomes.reshape(*world.moves.shape[:3], -1)[x, a, h].tolist()
        assert found == dict(zip(here, world.outcome_chances[x, a, h].tolist(), strict=True))
        if world.chances is None:
            assert found == {int(world.moves[x, a, h]): 1.0}
        else:
            moves, chances = world.moves[x, a, h].tolist(), world.chances[x, a, h].tolist()
            assert found == dict(zip(moves, chances, strict=True))


def test_a_table_turns_when_both_push_the_same_way() -> None:
    world = table_carrying()
    here = world.start
    assert world.moves[here, LEFT, LEFT] == here - 1
    assert world.moves[here, RIGHT, RIGHT] == here + 1
    assert world.moves[here, LEFT, RIGHT] == world.moves[here, RIGHT, LEFT] == here
    # It starts tilted towards the worse goal.
    assert [goal.name for goal in world.goals] == ["left", "right"]
    assert world.optimal_goal == RIGHT
    assert world.together.distance(LEFT)[here] == 6
    assert world.together.distance(RIGHT)[here] == 7
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
        (dict(chances=np.ones((14, 2, 2))), "chances need moves of shape"),
        (dict(starts={}), "at least one start"),
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
