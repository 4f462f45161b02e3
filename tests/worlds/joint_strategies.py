"""Random small worlds that two move."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

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
    rng = np.random.default_rng(draw(st.integers(0, 2**32), label="seed"))
    places = [int(s) for s in rng.permutation(count)]
    return JointWorld(
        name="random",
        moves=rng.integers(count, size=(count, actions, human_actions)),
        goals=tuple(
            Goal(f"goal {g}", places[g], float(rng.uniform(1, 12))) for g in range(goal_count)
        ),
        starts={place: 1 / starts for place in places[goal_count : goal_count + starts]},
        state_names=tuple(f"s{s}" for s in range(count)),
        action_names=tuple(f"r{a}" for a in range(actions)),
        human_action_names=tuple(f"h{a}" for a in range(human_actions)),
        positions=np.zeros((count, 2)),
    )
