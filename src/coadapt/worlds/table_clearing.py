"""Table clearing (Sec. 6.3): two bottles placed symmetrically, a robot hand between them.

The paper gives 52 robot states, three actions and two goals, not the layout. Ours is a grid of
13 columns and 4 rows: the hand starts in the middle of the first row and the bottles stand in the
two far corners. A move off the grid is a no-op.
"""

from __future__ import annotations

from coadapt.worlds.grid import grid
from coadapt.worlds.world import World


def table_clearing(
    columns: int = 13,
    rows: int = 4,
    *,
    left_reward: float = 10.0,
    right_reward: float = 11.0,
) -> World:
    """The table-clearing world.

    Args:
        columns: width of the grid, at least 3.
        rows: depth of the grid, at least 1.
        left_reward: reward of the left bottle, by default ``R_sub`` of Sec. 6.5.
        right_reward: reward of the right bottle, by default ``R_opt`` of Sec. 6.5.

    Returns:
        A world with ``columns * rows`` states, actions left (0), forward (1), right (2) and
        goals left (0) and right (1).

    Raises:
        ValueError: if the grid is too small.
    """
    if columns < 3 or rows < 1:
        raise ValueError(
            f"table clearing needs at least 3 columns and 1 row, not {columns} and {rows}"
        )
    far = rows - 1
    return grid(
        columns,
        rows,
        start=((columns - 1) // 2, 0),
        goals=[("left", (0, far), left_reward), ("right", (columns - 1, far), right_reward)],
        name="table_clearing",
    )
