"""Grid worlds."""

from __future__ import annotations

import numpy as np
import pytest

from coadapt.human.history import NO_STATE
from coadapt.worlds import FIVE_WAYS, grid

# 3 columns and 2 rows, numbered row by row:  3 4 5
#                                             0 1 2
SMALL = grid(3, 2, (1, 0), [("left", (0, 1), 1.0), ("right", (2, 1), 2.0)])


def test_moves_are_to_neighbours_and_blocked_at_the_edge() -> None:
    # Columns: left, forward, right.
    expected = [[0, 3, 1], [0, 4, 2], [1, 5, 2], [3, 3, 4], [3, 4, 5], [4, 5, 5]]
    assert SMALL.moves.tolist() == expected
    assert SMALL.moves.dtype == np.int64


def test_names_places_and_goals() -> None:
    assert SMALL.action_names == ("left", "forward", "right")
    assert SMALL.state_names[5] == "column 2 row 1"
    assert SMALL.positions[5].tolist() == [2.0, 1.0]
    assert SMALL.directions.tolist() == [[-1, 0], [0, 1], [1, 0]]
    assert SMALL.start == 1
    assert [(g.name, g.states, g.reward) for g in SMALL.goals] == [
        ("left", (3,), 1.0),
        ("right", (5,), 2.0),
    ]


def test_other_actions() -> None:
    back = {"forward": (0, 1), "back": (0, -1), "jump": (2, 0)}
    world = grid(3, 2, (0, 0), [("goal", (2, 1), 1.0)], actions=back, name="other")
    assert world.name == "other"
    assert world.action_names == ("forward", "back", "jump")
    # A jump of two columns leaves the grid from the second one on.
    assert world.moves.tolist() == [
        [3, 0, 2],
        [4, 1, 1],
        [5, 2, 2],
        [3, 0, 5],
        [4, 1, 4],
        [5, 2, 5],
    ]


def test_obstacles_are_no_states_and_block_the_way() -> None:
    # With numbers for names:  2 # 3
    #                          0 # 1   joined by a third row  4 5 6
    world = grid(
        3,
        3,
        (0, 0),
        [("goal", (2, 0), 1.0)],
        actions=FIVE_WAYS,
        obstacles=[(1, 0), (1, 1)],
    )
    assert world.states == 7
    assert (world.start, world.goal_states) == (0, (1,))
    assert world.positions.tolist() == [[0, 0], [2, 0], [0, 1], [2, 1], [0, 2], [1, 2], [2, 2]]
    assert world.action_names == ("left", "forward", "right", "back", "stay")
    # Left, forward, right, back, stay.
    assert world.moves.tolist() == [
        [0, 2, 0, 0, 0],
        [1, 3, 1, 1, 1],
        [2, 4, 2, 0, 2],
        [3, 6, 3, 1, 3],
        [4, 4, 5, 2, 4],
        [4, 5, 6, 5, 5],
        [5, 6, 6, 3, 6],
    ]
    # Two rows up, two columns over, two rows down.
    assert world.distance(0)[world.start] == 6


@pytest.mark.parametrize(
    ("obstacle", "message"),
    [
        ((1, 0), "start at column 1, row 0 is an obstacle"),
        ((0, 1), "goal g at column 0, row 1 is an obstacle"),
        ((3, 0), "obstacle at column 3, row 0 is off the 3 x 2 grid"),
        ((0, -1), "obstacle at column 0, row -1 is off the 3 x 2 grid"),
    ],
)
def test_obstacles_in_the_wrong_place_are_refused(obstacle: tuple[int, int], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        grid(3, 2, (1, 0), [("g", (0, 1), 1.0)], obstacles=[obstacle])


@pytest.mark.parametrize(
    ("start", "goal", "message"),
    [
        ((3, 0), (0, 1), "start at column 3, row 0 is off the 3 x 2 grid"),
        ((0, 2), (0, 1), "start at column 0, row 2 is off"),
        ((-1, 0), (0, 1), "start at column -1, row 0 is off"),
        ((1, 0), (0, -1), "goal g at column 0, row -1 is off"),
        ((1, 0), (1, 0), "is a goal"),
    ],
)
def test_cells_off_the_grid_are_refused(
    start: tuple[int, int], goal: tuple[int, int], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        grid(3, 2, start, [("g", goal, 1.0)])


def test_a_robot_that_slips_does_another_action_now_and_then() -> None:
    # The start of a 3 x 2 grid: left, forward and right lead to three different cells.
    world = grid(3, 2, (1, 0), [("far", (1, 1), 1.0)], slip=0.2)
    assert not world.is_deterministic
    found = dict(zip(world.moves[1, 0].tolist(), world.chances[1, 0].tolist(), strict=True))
    assert found == pytest.approx({0: 0.8, 4: 0.1, 2: 0.1})
    # In the near left corner left is blocked: it stays there with the 0.8 of left.
    found = {
        x: p
        for x, p in zip(world.moves[0, 2].tolist(), world.chances[0, 2].tolist(), strict=True)
        if x != NO_STATE
    }
    assert found == pytest.approx({1: 0.8, 0: 0.1, 3: 0.1})


def test_where_two_actions_lead_to_the_same_cell_their_chances_add_up() -> None:
    # One row: forward is blocked everywhere, at the left end left is too.
    world = grid(3, 1, (1, 0), [("right", (2, 0), 1.0)], slip=0.2)
    found = {
        x: p
        for x, p in zip(world.moves[0, 0].tolist(), world.chances[0, 0].tolist(), strict=True)
        if x != NO_STATE
    }
    assert found == pytest.approx({0: 0.9, 1: 0.1})


def test_regions_starts_and_costs() -> None:
    world = grid(
        3,
        3,
        {(1, 0): 0.75, (0, 0): 0.25},
        [("far", [(0, 2), (1, 2)], 1.0), ("corner", (2, 2), 2.0)],
        move_cost=0.1,
    )
    assert [goal.states for goal in world.goals] == [(6, 7), (8,)]
    assert world.goal_states == (6, 7, 8)
    assert world.start == 1
    assert world.start_chances == {1: 0.75, 0: 0.25}
    assert world.goal_place(0) == "column 0 row 2 or column 1 row 2"
    assert world.distance(0).tolist() == [2, 2, 3, 1, 1, 2, 0, 0, -1]
    np.testing.assert_array_equal(world.costs, np.full((9, 3), 0.1))


@pytest.mark.parametrize("slip", [-0.1, 1.0])
def test_slips_out_of_range_are_refused(slip: float) -> None:
    with pytest.raises(ValueError, match="slip must lie in"):
        grid(3, 1, (1, 0), [("right", (2, 0), 1.0)], slip=slip)
