"""Random small worlds."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from coadapt.arrays import FloatArray, IntArray
from coadapt.human.history import NO_STATE
from coadapt.worlds import Goal, World


@st.composite
def worlds(draw: st.DrawFn, *, states: int = 6, goals: int = 4, general: bool = False) -> World:
    """A world of random moves with one to ``goals`` goals, which may be out of reach.

    With ``general`` moves are uncertain, goals may be regions, there may be several starts, and
    moves cost something.
    """
    goal_count = draw(st.integers(1, goals), label="goals")
    count = draw(st.integers(goal_count + 1, max(states, goal_count + 1)), label="states")
    actions = draw(st.integers(1, 3), label="actions")
    rng = np.random.default_rng(draw(st.integers(0, 2**32), label="seed"))
    start, *places = (int(s) for s in rng.permutation(count)[: goal_count + 1])
    moves, chances = rng.integers(count, size=(count, actions)), None
    regions = [[state] for state in places]
    starts = None
    if general:
        moves, chances = random_outcomes(rng, count, actions)
        left = [s for s in range(count) if s not in (start, *places)]
        for state in left:
            if rng.random() < 0.3:
                regions[int(rng.integers(goal_count))].append(state)
        others = [s for s in left if not any(s in region for region in regions)]
        among = [start, *others[: int(rng.integers(3))]]
        shares = rng.dirichlet(np.ones(len(among))) + 0.1
        starts = dict(zip(among, (shares / shares.sum()).tolist(), strict=True))
    return World(
        name="random",
        moves=moves,
        chances=chances,
        starts=starts,
        costs=rng.random((count, actions)) if general else None,
        goals=tuple(
            Goal(f"goal {g}", tuple(region) if len(region) > 1 else region[0], reward)
            for g, region in enumerate(regions)
            for reward in [float(rng.uniform(1, 12))]
        ),
        start=start,
        state_names=tuple(f"s{s}" for s in range(count)),
        action_names=tuple(f"a{a}" for a in range(actions)),
        positions=np.zeros((count, 2)),
        directions=np.zeros((actions, 2)),
    )


def random_outcomes(
    rng: np.random.Generator, states: int, actions: int
) -> tuple[IntArray, FloatArray]:
    """``[X, A, N]`` one to three outcomes of each action, in any places, and their chances."""
    most = min(3, states)
    moves = np.full((states, actions, most), NO_STATE)
    chances = np.zeros((states, actions, most))
    for x, a in np.ndindex(states, actions):
        places = rng.permutation(most)[: int(rng.integers(1, most + 1))]
        moves[x, a, places] = rng.permutation(states)[: len(places)]
        shares = rng.random(len(places)) + 0.05
        chances[x, a, places] = shares / shares.sum()
    return moves, chances
