"""The table-clearing world of Sec. 6.3."""

from __future__ import annotations

import pytest

from coadapt.worlds import table_clearing


def test_it_has_the_sizes_of_the_paper() -> None:
    world = table_clearing()
    # Sec. 6.5: 52 robot states; Sec. 6.3: left, forward, right, and two bottles.
    assert (world.states, world.actions, len(world.goals)) == (52, 3, 2)
    assert world.action_names == ("left", "forward", "right")
    # R_opt = 11, R_sub = 10 (Sec. 6.5).
    assert [goal.reward for goal in world.goals] == [10.0, 11.0]
    assert world.optimal_goal == 1


def test_the_bottles_stand_symmetrically() -> None:
    world = table_clearing()
    assert world.positions[world.start].tolist() == [6, 0]
    assert [world.positions[g].tolist() for g in world.goal_states] == [[0, 3], [12, 3]]
    # Six columns sideways and three rows ahead to either.
    assert [int(world.distance(g)[world.start]) for g in range(2)] == [9, 9]


def test_sizes_and_rewards_are_parameters() -> None:
    world = table_clearing(5, 2, left_reward=3.0, right_reward=2.0)
    assert (world.states, world.start, world.goal_states) == (10, 2, (5, 9))
    assert [goal.reward for goal in world.goals] == [3.0, 2.0]
    assert world.optimal_goal == 0
    # One row: the bottles stand beside the hand.
    assert table_clearing(3, 1).goal_states == (0, 2)


@pytest.mark.parametrize(("columns", "rows"), [(2, 4), (13, 0), (0, 0)])
def test_too_small_tables_are_refused(columns: int, rows: int) -> None:
    with pytest.raises(ValueError, match="at least 3 columns and 1 row"):
        table_clearing(columns, rows)
