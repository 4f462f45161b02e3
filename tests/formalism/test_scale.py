"""A large problem fits."""

from __future__ import annotations

import tracemalloc

import numpy as np

from coadapt import SharedAutonomy
from coadapt.worlds import FIVE_WAYS, grid

COLUMNS, ROWS = 200, 100
GOALS = [
    ("far left", (0, 99), 10.0),
    ("left", (60, 99), 10.2),
    ("right", (140, 99), 10.4),
    ("far right", (199, 99), 10.6),
    ("left side", (0, 50), 10.8),
    ("near left", (60, 50), 10.9),
    ("near right", (140, 50), 10.95),
    ("right side", (199, 50), 11.0),
]


def test_a_problem_of_nearly_two_million_states_takes_little_memory() -> None:
    tracemalloc.start()
    world = grid(COLUMNS, ROWS, (100, 0), GOALS, actions=FIVE_WAYS)
    model = SharedAutonomy(world, adaptability=np.linspace(0, 1, 11).tolist())
    problem = model.to_momdp()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # 200 * 100 cells, 8 goals, 11 values of alpha.
    assert problem.states == 1_760_000
    assert problem.shape == (20_000, 88, 5, 5)
    # Rewards [X, A, Y] and inputs [X, Y, O] take 70 MB each, all else about as much as one of them.
    assert peak < 300e6
    # However far the goal is, the likeliest action is one towards it.
    for g in range(len(GOALS)):
        steps = world.distance(g)
        likeliest = world.moves[np.arange(world.states), model.modal_policies[g].argmax(axis=1)]
        free = ~np.isin(np.arange(world.states), world.goal_states)
        assert np.all(steps[likeliest[free]] == steps[free] - 1)
