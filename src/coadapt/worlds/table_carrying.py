"""Table carrying: human and robot rotate a table so that it passes a door.

One of them walks backwards through the door, and the direction of rotation decides who. The table
turns by one step when both push in the same direction; when they push against each other it stays
(HRI 2016, IJRR 2017). The orientations are ours: twelve, and the two goals beyond the first and the
last. As twelve is even, a table that is almost in the middle is tilted towards one goal, and it
starts tilted towards the worse.
"""

from __future__ import annotations

import numpy as np

from coadapt.worlds.joint import JointWorld
from coadapt.worlds.world import Goal


def table_carrying(
    orientations: int = 12,
    *,
    worse_reward: float = 10.0,
    better_reward: float = 11.0,
) -> JointWorld:
    """The table-carrying world.

    Args:
        orientations: number of orientations between the goals, at least 1.
        worse_reward: reward of the goal to the left, ours.
        better_reward: reward of the goal to the right, ours.

    Returns:
        A world with ``orientations + 2`` states, numbered from the left goal to the right, and
        actions left (0) and right (1) of both. The start is the middle; for an even number of
        orientations the one of the two that is nearer to the left goal.

    Raises:
        ValueError: if there is no orientation between the goals.
    """
    if orientations < 1:
        raise ValueError(f"table carrying needs at least 1 orientation, not {orientations}")
    last = orientations + 1
    orientation = np.arange(last + 1)
    moves = np.repeat(orientation[:, None, None], 2, axis=1).repeat(2, axis=2)
    moves[:, 0, 0] = np.maximum(orientation - 1, 0)
    moves[:, 1, 1] = np.minimum(orientation + 1, last)
    angle = np.pi * orientation / last
    return JointWorld(
        name="table_carrying",
        moves=moves,
        goals=(Goal("left", 0, worse_reward), Goal("right", last, better_reward)),
        starts={last // 2: 1.0},
        state_names=tuple(f"orientation {i}" for i in range(last + 1)),
        action_names=("left", "right"),
        human_action_names=("left", "right"),
        positions=np.stack([-np.cos(angle), np.sin(angle)], axis=1),
    )
