"""Random small worlds."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from coadapt.worlds import Goal, World


@st.composite
def worlds(draw: st.DrawFn, *, states: int = 6, goals: int = 4) -> World:
    """A world of random moves with one to ``goals`` goals, which may be out of reach."""
    goal_count = draw(st.integers(1, goals), label="goals")
    count = draw(st.integers(goal_count + 1, max(states, goal_count + 1)), label="states")
    actions = draw(st.integers(1, 3), label="actions")
    rng = np.random.default_rng(draw(st.integers(0, 2**32), label="seed"))
    start, *places = (int(s) for s in rng.permutation(count)[: goal_count + 1])
    return World(
        name="random",
        moves=rng.integers(count, size=(count, actions)),
        goals=tuple(
            Goal(f"goal {g}", state, float(rng.uniform(1, 12))) for g, state in enumerate(places)
        ),
        start=start,
        state_names=tuple(f"s{s}" for s in range(count)),
        action_names=tuple(f"a{a}" for a in range(actions)),
        positions=np.zeros((count, 2)),
        directions=np.zeros((actions, 2)),
    )
