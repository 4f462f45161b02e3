"""A world as arrays, for compiled episodes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.formalism import Collaboration, Model
from coadapt.robots.tables import as_floats, as_ints


class WorldTables(NamedTuple):
    """What happens whoever steers. Sizes: W windows, X states, A actions, G goals, S starts,
    H human actions that move the world (1 where they do not), N outcomes of each pair."""

    starts: IntArray  # [S] states
    start_chance: FloatArray  # [S]
    beginning: IntArray  # [X] the window without a past
    state: IntArray  # [W] in which a window ends
    next: IntArray  # [W, A, H * N] the window after each outcome
    chance: FloatArray  # [X, A, H, N] of each outcome
    goal: IntArray  # [X] or NO_GOAL
    worth: FloatArray  # [G] reward of each goal
    reward: FloatArray  # [W, A, M] (Eq. 6)
    mode_prior: FloatArray  # [M] what the robot believes of a mode chosen anew
    discount: float


def world_tables(model: Model) -> WorldTables:
    """The arrays of ``model``."""
    world = model.world
    chance = world.outcome_chances
    if not isinstance(model, Collaboration):
        chance = chance[:, :, None]
    starts = world.start_chances
    return WorldTables(
        starts=np.array(list(starts), dtype=np.int64),
        start_chance=np.array(list(starts.values()), dtype=np.float64),
        beginning=as_ints(model.windows.beginning),
        state=as_ints(model.windows.state),
        next=as_ints(model.windows.next),
        chance=as_floats(chance),
        goal=as_ints(world.goal_of),
        worth=np.array([goal.reward for goal in world.goals], dtype=np.float64),
        reward=as_floats(model.reward),
        mode_prior=as_floats(model.prior.sum(axis=0)),
        discount=float(model.discount),
    )
