"""Grid worlds."""

from __future__ import annotations

import numpy as np
import pytest

from coadapt.worlds import grid

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
    assert [(g.name, g.state, g.reward) for g in SMALL.goals] == [
        ("left", 3, 1.0),
        ("right", 5, 2.0),
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
