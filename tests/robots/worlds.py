"""A world small enough to follow by hand, and people and policies for it."""

from __future__ import annotations

import numpy as np

from coadapt import SharedAutonomy
from coadapt.momdp import AlphaVectorPolicy
from coadapt.worlds import Goal, World

# a - b - c - d in a row; the task begins in b and ends in a (worth 5) or d (worth 7).
A, B, C, D = range(4)
DOWN, UP = range(2)
LOW, HIGH = range(2)

ROW = World(
    name="row",
    moves=np.array([[A, B], [A, C], [B, D], [C, D]]),
    goals=(Goal("low", A, 5.0), Goal("high", D, 7.0)),
    start=B,
    state_names=("a", "b", "c", "d"),
    action_names=("down", "up"),
    positions=np.zeros((4, 2)),
    directions=np.zeros((2, 2)),
)

# Someone who wants low goes down from b 4 times of 5 and from c 9 of 10; someone who wants high
# goes up from b 3 times of 4 and from c 3 of 5.
POLICIES = np.array(
    [
        [[0.5, 0.5], [0.8, 0.2], [0.9, 0.1], [0.5, 0.5]],
        [[0.5, 0.5], [0.25, 0.75], [0.4, 0.6], [0.5, 0.5]],
    ]
)

MODEL = SharedAutonomy(
    ROW, adaptability=(0.0, 1.0), disagreement_cost=-1.0, discount=0.5, policies=POLICIES
)


def always(*actions: int, hidden: int = 4) -> AlphaVectorPolicy:
    """In each state the given action, whatever is believed."""
    count = len(actions)
    return AlphaVectorPolicy(np.arange(count + 1), np.zeros((count, hidden)), np.array(actions))


def towards_the_likelier(hidden: int = 4) -> AlphaVectorPolicy:
    """Down where low is the likelier mode, else up; ``hidden`` is 2 for each alpha."""
    modes = np.tile(np.eye(2), (1, hidden // 2))
    return AlphaVectorPolicy(np.arange(0, 9, 2), np.tile(modes, (4, 1)), np.array([DOWN, UP] * 4))
