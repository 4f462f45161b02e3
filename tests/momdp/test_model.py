"""Problems from plain arrays."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.momdp import MOMDP, Root
from tests.momdp.problems import corridor, joint, observations, tiger
from tests.momdp.strategies import random_rows


@given(
    st.tuples(*(st.integers(1, 3) for _ in range(4))),
    st.booleans(),
    st.booleans(),
    st.integers(0, 2**32),
)
def test_from_arrays_multiplies_the_factors(
    sizes: tuple[int, int, int, int], x_by_y: bool, y_by_x: bool, seed: int
) -> None:
    x, y, a, o = sizes
    rng = np.random.default_rng(seed)
    terminal = [i for i in range(x) if rng.random() < 0.2]
    t_x = random_rows(rng, (x, a, y, x) if x_by_y else (x, a, x), 0.4)
    t_y = random_rows(rng, (x, a, x, y, y) if y_by_x else (x, a, y, y), 0.4)
    observation = random_rows(rng, (a, x, y, o), 0.4)
    reward = rng.random((x, a, y))
    problem = MOMDP.from_arrays(
        t_x, t_y, observation, reward, 0.9, [Root(0, np.full(y, 1 / y))], terminal=terminal
    )
    # P(x', y' | x, y, a) = P(x' | x, a, y) P(y' | x, a, x', y), written out.
    expected = np.zeros((x, a, y, x, y))
    for i, j, k, u, v in np.ndindex(expected.shape):
        if i not in terminal:
            chance = t_x[i, j, k, u] if x_by_y else t_x[i, j, u]
            expected[i, j, k, u, v] = chance * (t_y[i, j, u, k, v] if y_by_x else t_y[i, j, k, v])
    np.testing.assert_allclose(joint(problem), expected, atol=1e-15)
    np.testing.assert_array_equal(observations(problem), observation)
    np.testing.assert_array_equal(problem.reward, reward)
    assert problem.shape == (x, y, a, o)
    assert problem.states == x * y
    # Only successors with some probability are edges.
    assert len(problem.edge_next) == np.count_nonzero(expected.sum(axis=(2, 4)))
    assert problem.terminal.tolist() == [i in terminal for i in range(x)]


def test_names_are_numbered_unless_given() -> None:
    arrays = dict(
        transition_x=np.ones((1, 2, 1)),
        transition_y=np.ones((1, 2, 1, 1)),
        observation=np.ones((2, 1, 1, 1)),
        reward=np.zeros((1, 2, 1)),
        discount=0.5,
        roots=[Root(0, np.ones(1))],
    )
    problem = MOMDP.from_arrays(**arrays)
    assert problem.action_names == ("a0", "a1")
    assert problem.observed_names == ("x0",)
    assert problem.hidden_names == ("y0",)
    assert problem.observation_names == ("o0",)
    assert MOMDP.from_arrays(**arrays, action_names=["up", "down"]).action_names == ("up", "down")
    with pytest.raises(ValueError, match="3 names for 2"):
        MOMDP.from_arrays(**arrays, action_names=["up", "down", "left"])


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("transition_x", (2, 3, 3)),  # one successor too many
        ("transition_x", (2, 3, 4, 2)),  # wrong number of hidden states
        ("transition_x", (2, 2, 2)),  # one action missing
        ("transition_y", (2, 3, 2, 3)),
        ("transition_y", (2, 3, 4, 2, 2)),  # wrong number of successors
        ("transition_y", (3, 2, 2, 2)),
        ("observation", (3, 2, 1, 5)),
        ("observation", (2, 3, 2, 5)),
        ("observation", (2, 2, 5)),  # an axis too few
    ],
)
def test_from_arrays_refuses_shapes_that_do_not_fit(name: str, shape: tuple[int, ...]) -> None:
    arrays: dict[str, Any] = dict(
        transition_x=np.full((2, 3, 2), 0.5),
        transition_y=np.full((2, 3, 2, 2), 0.5),
        observation=np.full((3, 2, 2, 5), 0.2),
        reward=np.zeros((2, 3, 2)),
        discount=0.5,
        roots=[Root(0, np.array([0.5, 0.5]))],
    )
    MOMDP.from_arrays(**arrays)
    arrays[name] = np.zeros(shape)
    with pytest.raises(ValueError, match=name):
        MOMDP.from_arrays(**arrays)


def test_every_state_may_end_the_task() -> None:
    problem = MOMDP.from_arrays(
        np.ones((2, 1, 2)),
        np.ones((2, 1, 1, 1)),
        np.ones((1, 2, 1, 1)),
        np.zeros((2, 1, 1)),
        0.5,
        [Root(0, np.ones(1))],
        terminal=[0, 1],
    )
    assert problem.terminal.all()
    assert problem.transition.count == len(problem.edge_next) == 0


def test_edges_lists_the_successors_of_a_state_and_action() -> None:
    problem = corridor()
    successors = {
        (x, a): [int(problem.edge_next[e]) for e in problem.edges(x, a)]
        for x in range(3)
        for a in range(2)
    }
    # stay keeps near and far in place, go leads from near to far to the door, which ends.
    assert successors == {
        (0, 0): [0],
        (0, 1): [1],
        (1, 0): [1],
        (1, 1): [2],
        (2, 0): [],
        (2, 1): [],
    }


def test_repr_says_the_sizes() -> None:
    assert repr(tiger()) == (
        "MOMDP(1 observed x 2 hidden states, 3 actions, 2 observations, discount 0.95, 1 roots)"
    )


def test_a_state_is_terminal_where_every_action_ends() -> None:
    # Near ends the task by staying, far by both actions, the door by none.
    problem = replace(corridor(), edge_start=np.array([0, 0, 1, 1, 1, 2, 4]))
    assert problem.terminal.tolist() == [False, True, False]
