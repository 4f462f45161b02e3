"""Random small worlds that two move."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from coadapt.human.history import NO_STATE
from coadapt.worlds import Goal
from coadapt.worlds.joint import JointWorld


@st.composite
def joint_worlds(draw: st.DrawFn, *, states: int = 5, goals: int = 3) -> JointWorld:
    """One to ``goals`` goals and at least as many human actions, one or two starts."""
    goal_count = draw(st.integers(1, goals), label="goals")
    starts = draw(st.integers(1, 2), label="starts")
    count = draw(st.integers(goal_count + starts, max(states, goal_count + starts)), label="states")
    actions = draw(st.integers(1, 3), label="robot actions")
    human_actions = draw(st.integers(goal_count, 3), label="human actions")
    uncertain = draw(st.booleans(), label="uncertain moves")
    rng = np.random.default_rng(draw(st.integers(0, 2**32), label="seed"))
    shape = (count, actions, human_actions)
    moves, chances = rng.integers(count, size=shape), None
    if uncertain:
        # Each pair of actions has one outcome or two.
        first = rng.uniform(0.1, 0.9, size=shape)
        first[rng.random(shape) < 0.5] = 1.0
        second = np.where(
            first == 1, NO_STATE, (moves + rng.integers(1, count, size=shape)) % count
        )
        moves, chances = np.stack([moves, second], axis=3), np.stack([first, 1 - first], axis=3)
    places = [int(s) for s in rng.permutation(count)]
    return JointWorld(
        name="random",
        moves=moves,
        goals=tuple(
            Goal(f"goal {g}", places[g], float(rng.uniform(1, 12))) for g in range(goal_count)
        ),
        starts={place: 1 / starts for place in places[goal_count : goal_count + starts]},
        state_names=tuple(f"s{s}" for s in range(count)),
        action_names=tuple(f"r{a}" for a in range(actions)),
        human_action_names=tuple(f"h{a}" for a in range(human_actions)),
        positions=np.zeros((count, 2)),
        chances=chances,
    )
