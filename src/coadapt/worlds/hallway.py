"""Hallway crossing: human and robot walk towards each other and have to agree on a side.

Each of them steps to their own left or right at every step. When both choose the same they pass;
otherwise they face each other on one side of the hallway and try again (IJRR 2017). The world is
where they are: two sides each, four states.
"""

from __future__ import annotations

import numpy as np

from coadapt.worlds.joint import JointWorld
from coadapt.worlds.world import Goal

SIDES = ("west", "east")
"""The human walks north and has the east on the right, the robot walks south."""


def hallway(*, worse_reward: float = 10.0, better_reward: float = 11.0) -> JointWorld:
    """The hallway-crossing world.

    Args:
        worse_reward: reward of passing each other on the left, ours.
        better_reward: reward of passing each other on the right, ours.

    Returns:
        A world with 4 states, of index ``2 * human side + robot side``, and actions left (0) and
        right (1) of both, each from their own point of view. It starts with both on the same
        side of the hallway, either as likely.
    """
    # Their own left is the west (0) for the human and the east (1) for the robot.
    human_side, robot_side = np.array([0, 1]), np.array([1, 0])
    reached = 2 * human_side[None, :] + robot_side[:, None]  # [A_r, A_h]
    return JointWorld(
        name="hallway",
        moves=np.repeat(reached[None], 4, axis=0),
        goals=(
            Goal("left", int(reached[0, 0]), worse_reward),
            Goal("right", int(reached[1, 1]), better_reward),
        ),
        starts={0: 0.5, 3: 0.5},
        state_names=tuple(f"human {human} robot {robot}" for human in SIDES for robot in SIDES),
        action_names=("left", "right"),
        human_action_names=("left", "right"),
        # The goals to the left and right, the places where they block each other between them.
        positions=np.array([[h - r, 0.6 * (h + r - 1)] for h in (0.0, 1.0) for r in (0.0, 1.0)]),
    )
