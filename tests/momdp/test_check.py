"""The check accepts what is right and says what is wrong, where, and what was expected."""

from __future__ import annotations

import pickle
import time
import tracemalloc
import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given

from coadapt.momdp import MOMDP, JumpTransition, Root, SparseTransition
from coadapt.momdp.check import MOMDPError, MOMDPWarning, check_momdp
from tests.momdp.problems import corridor, tiger
from tests.momdp.strategies import momdps


@given(momdps())
def test_random_problems_pass(problem: MOMDP) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MOMDPWarning)  # of states that no root leads to
        check_momdp(problem)


@pytest.mark.parametrize("problem", [tiger(), corridor(), corridor(jump=True)])
def test_known_problems_pass_without_a_warning(problem: MOMDP) -> None:
    check_momdp(problem)


def having(problem: MOMDP, name: str, index: object, value: object) -> MOMDP:
    """``problem`` with one entry of the array ``name`` replaced."""
    if name.startswith("transition."):
        part = name.removeprefix("transition.")
        array = getattr(problem.transition, part).copy()
        array[index] = value
        return replace(problem, transition=replace(problem.transition, **{part: array}))
    array = getattr(problem, name).copy()
    array[index] = value
    return replace(problem, **{name: array})


def mixed(mixing: list[list[float]], rate: float = 0.5) -> MOMDP:
    """The corridor with two blocks of one value."""
    return replace(
        corridor(),
        transition=JumpTransition(
            rate=np.full((2, 1), rate), target=np.ones((4, 1)), mixing=np.array(mixing)
        ),
    )


SPARSE, JUMP = corridor(), corridor(jump=True)
ROOT = SPARSE.roots[0]

# Entries 2 and 3 of transition.value are the row of tense people, 0.25 and 0.75, in the map of the
# first edge, near stay.
WRONG_NUMBERS: list[tuple[MOMDP, str]] = [
    (
        having(SPARSE, "reward", (1, 0, 1), np.nan),
        r"reward in x 1 \(far\), a 0 \(stay\), y 1 \(tense\) is nan, expected a finite number",
    ),
    (having(SPARSE, "reward", (0, 0, 0), np.inf), r"reward in x 0 \(near\).* is inf"),
    (having(SPARSE, "reward", (0, 0, 0), -np.inf), r"reward in x 0 \(near\).* is -inf"),
    (
        having(SPARSE, "edge_next", 1, 3),
        r"the successor in edge 1 of x 0 \(near\), a 1 \(go\) is 3, expected 0 to 2",
    ),
    (having(SPARSE, "edge_next", 1, -1), r"the successor in edge 1 .* is -1"),
    (
        having(SPARSE, "edge_map", 3, 4),
        r"the map in edge 3 of x 1 \(far\), a 1 \(go\) is 4, expected 0 to 3",
    ),
    (having(SPARSE, "edge_map", 3, -1), r"the map in edge 3 .* is -1"),
    (
        having(SPARSE, "observation_index", (1, 2), 6),
        r"observation_index in a 1 \(go\), x' 2 \(door\) is 6, expected 0 to 5",
    ),
    (having(SPARSE, "observation_index", (1, 2), -1), "observation_index in .* is -1"),
    (having(SPARSE, "transition.column", 2, 2), "transition.column in entry 2 is 2, .* 0 to 1"),
    (having(SPARSE, "transition.column", 2, -1), "transition.column in entry 2 is -1"),
    (having(SPARSE, "transition.value", 2, -0.75), "value in entry 2 is -0.75, expected 0 to 1"),
    (having(SPARSE, "transition.value", 2, np.nan), "value in entry 2 is nan"),
    (having(SPARSE, "transition.value", 2, 1.5), "value in entry 2 is 1.5"),
    (
        having(SPARSE, "transition.value", 2, 0.24),
        r"successors of x 0 \(near\), a 0 \(stay\), y 1 \(tense\) have total probability 0.99, "
        "expected 1",
    ),
    (
        having(SPARSE, "observation", (5, 1, 0), -0.25),
        r"observation in matrix 5, y' 1 \(tense\), o 0 \(smile\) is -0.25, expected 0 to 1",
    ),
    (having(SPARSE, "observation", (5, 1, 0), np.nan), "observation in matrix 5, .* is nan"),
    (
        having(SPARSE, "observation", (5, 1, 0), 0.3),
        r"observations in a 1 \(go\), x' 2 \(door\), y' 1 \(tense\) have total probability 1.1",
    ),
    (having(JUMP, "transition.rate", (0, 1), 1.5), "rate in block 0, value 1 is 1.5, .* 0 to 1"),
    (having(JUMP, "transition.rate", (0, 1), -0.5), "rate in block 0, value 1 is -0.5"),
    (having(JUMP, "transition.rate", (0, 1), np.nan), "rate in block 0, value 1 is nan"),
    (having(JUMP, "transition.target", (2, 1), -0.5), "target in map 2, value 1 is -0.5"),
    (having(JUMP, "transition.target", (2, 1), np.inf), "target in map 2, value 1 is inf"),
    (
        # 1.0 * 0.75 + 0.5 * 0.75 jumps out of a total of 1.
        having(having(JUMP, "transition.rate", (0, 0), 1.0), "transition.target", 2, 0.75),
        "probability of a jump in map 2, block 0 of the transition is 1.125, expected at most 1",
    ),
    (mixed([[0.5, 0.4], [0.0, 1.0]]), "row 0 of transition.mixing sums to 0.9, expected 1"),
    (mixed([[1.5, -0.5], [0.0, 1.0]]), "mixing in block 0, block' 0 is 1.5"),
    (mixed([[1.0, 0.0], [0.0, np.nan]]), "mixing in block 1, block' 1 is nan"),
    (
        replace(JUMP, edge_start=np.array([0, 2, 2, 3, 4, 4, 4])),
        r"successors of x 0 \(near\), a 0 \(stay\), y 0 \(calm\) have total probability 2",
    ),
    (
        replace(
            SPARSE, edge_start=np.array([0, 2, 2, 3, 4, 4, 4]), edge_next=np.array([1, 1, 1, 2])
        ),
        r"edge 1 of x 0 \(near\), a 0 \(stay\) leads to x 1 \(far\) as an edge before it does",
    ),
    (replace(SPARSE, discount=1.0), "discount is 1.0, expected at least 0 and below 1"),
    (replace(SPARSE, discount=-0.1), "discount is -0.1"),
    (replace(SPARSE, discount=float("nan")), "discount is nan"),
    (replace(SPARSE, roots=()), "there are no roots, expected at least one"),
    (
        replace(SPARSE, roots=(replace(ROOT, x=3), SPARSE.roots[1])),
        r"root 0 \(seen\) has x 3, expected 0 to 2",
    ),
    (replace(SPARSE, roots=(replace(ROOT, x=-1), SPARSE.roots[1])), "root 0 .* has x -1"),
    (
        replace(SPARSE, roots=(ROOT, replace(SPARSE.roots[1], belief=np.array([0.4, 0.4])))),
        "the belief of root 1 sums to 0.8, expected 1",
    ),
    (
        replace(SPARSE, roots=(replace(ROOT, belief=np.array([1.5, -0.5])), SPARSE.roots[1])),
        r"the belief of root 0 \(seen\) in y 1 \(tense\) is -0.5, expected 0 to 1",
    ),
    (replace(SPARSE, roots=(replace(ROOT, probability=0.5), SPARSE.roots[1])), "sum to 1.25"),
    (
        replace(SPARSE, roots=(replace(ROOT, probability=0.0), replace(ROOT, probability=1.0))),
        r"root 0 \(seen\) has probability 0.0, expected above 0 and at most 1",
    ),
    (
        replace(SPARSE, roots=(replace(ROOT, probability=float("nan")), SPARSE.roots[1])),
        r"root 0 \(seen\) has probability nan",
    ),
    (
        replace(SPARSE, action_names=("go", "go")),
        "a 1 is named 'go' as a 0 is, expected different names",
    ),
    (replace(SPARSE, hidden_names=("calm",)), "there are 1 names of y, expected 2"),
]


@pytest.mark.parametrize(("problem", "sentence"), WRONG_NUMBERS)
def test_a_wrong_number_is_named(problem: MOMDP, sentence: str) -> None:
    with pytest.raises(MOMDPError, match=sentence):
        check_momdp(problem)


def of_transition(problem: MOMDP, **parts: object) -> MOMDP:
    return replace(problem, transition=replace(problem.transition, **parts))


WRONG_ARRAYS: list[tuple[MOMDP, str]] = [
    (
        replace(SPARSE, reward=np.zeros((3, 2, 2), dtype=np.float32)),
        r"reward is a float32 array of shape \(3, 2, 2\), expected a contiguous float64 array with "
        "3 axes",
    ),
    (replace(SPARSE, reward=np.zeros((3, 4))), r"reward is a float64 array of shape \(3, 4\)"),
    (replace(SPARSE, reward=np.zeros((3, 2, 2)).T), "reward is a non-contiguous float64 array"),
    (replace(SPARSE, reward=np.zeros((3, 2, 3))), "second axis of observation is 2, expected 3"),
    (replace(SPARSE, reward=np.zeros((0, 2, 2))), "expected at least 1 of each"),
    (replace(SPARSE, edge_next=[0, 1, 1, 2]), "edge_next is a list, expected a contiguous int64"),
    (replace(SPARSE, edge_next=np.array([0.0, 1, 1, 2])), "edge_next is a float64 array"),
    (replace(SPARSE, edge_map=np.arange(3)), "length of edge_map is 3, expected 4"),
    (replace(SPARSE, edge_start=np.array([0, 1, 2, 3, 4, 4])), "of edge_start is 6, expected 7"),
    (
        replace(SPARSE, edge_start=np.array([0, 1, 2, 1, 4, 4, 4])),
        r"edge_start\[3\] is 1, expected at least the 2 before it",
    ),
    (
        replace(SPARSE, edge_start=np.array([0, 1, 2, 3, 4, 4, 5])),
        r"edge_start goes from \[0\] to \[5\], expected from 0 to 4",
    ),
    (replace(SPARSE, edge_start=np.array([1, 1, 2, 3, 4, 4, 4])), r"edge_start goes from \[1\]"),
    (replace(SPARSE, observation=np.zeros((6, 3, 2))), "second axis of observation is 3"),
    (replace(SPARSE, observation=np.zeros((6, 2, 0))), "expected at least 1 of each"),
    (
        replace(SPARSE, observation_index=np.zeros((3, 2), dtype=np.int64)),
        r"shape of observation_index is \(3, 2\), expected \(2, 3\)",
    ),
    (
        replace(SPARSE, roots=(replace(ROOT, belief=np.ones(3)), SPARSE.roots[1])),
        "length of the belief of root 0 is 3, expected 2",
    ),
    (
        replace(SPARSE, roots=(replace(ROOT, belief=[0.5, 0.5]), SPARSE.roots[1])),
        "belief of root 0 is a list",
    ),
    (of_transition(SPARSE, hidden=4), "hidden states of the transition is 4, expected 2"),
    (of_transition(SPARSE, value=np.ones(15)), "length of transition.value is 15, expected 16"),
    (of_transition(SPARSE, row_start=np.array([0, 16, 16, 16])), "row_start, less 1, modulo 2"),
    (of_transition(SPARSE, row_start=np.array([0, 4, 2, 16, 16])), r"row_start\[2\] is 2"),
    (of_transition(SPARSE, row_start=np.array([0, 4, 8])), r"row_start goes from \[0\] to \[8\]"),
    (of_transition(SPARSE, row_start=np.zeros(0, dtype=np.int64)), "row_start"),
    (of_transition(JUMP, target=np.ones((4, 3))), "axis of transition.target is 3, expected 2"),
    (of_transition(JUMP, rate=np.ones((2, 2))), "hidden states of the transition is 4"),
    (of_transition(JUMP, mixing=np.eye(2)), r"shape of transition.mixing is \(2, 2\), .* \(1, 1\)"),
    (of_transition(JUMP, rate=np.ones((1, 2), dtype=np.int64)), "transition.rate is a int64 array"),
]


@pytest.mark.parametrize(("problem", "sentence"), WRONG_ARRAYS)
def test_a_wrong_array_is_named(problem: MOMDP, sentence: str) -> None:
    with pytest.raises(MOMDPError, match=sentence):
        check_momdp(problem)


def test_observations_count_only_where_they_can_be_made() -> None:
    # From far one goes to the door alone, and only tense: what calm people do there is left open.
    always_tense = np.tile(np.array([[0.0, 1.0], [0.0, 1.0]]), (4, 1, 1))
    problem = replace(SPARSE, transition=SparseTransition.from_dense(always_tense))
    check_momdp(having(problem, "observation", (5, 0), [0.0, 0.0]))
    with pytest.raises(MOMDPError, match="total probability 0"):
        check_momdp(having(problem, "observation", (5, 1), [0.0, 0.0]))
    # Nor does staying lead to the door.
    check_momdp(having(SPARSE, "observation", 2, 0.0))


def test_observations_after_certain_jumps() -> None:
    # Everybody jumps to the second value, so the first one is never observed.
    certain = JumpTransition(rate=np.ones((1, 2)), target=np.tile([0.0, 1.0], (4, 1)))
    problem = replace(SPARSE, transition=certain)
    check_momdp(having(problem, "observation", (slice(None), 0), 0.0))
    with pytest.raises(MOMDPError, match=r"y' 1 \(tense\) have total probability 0"):
        check_momdp(having(problem, "observation", (slice(None), 1), 0.0))
    # Unless they stay with some probability, or the mixing carries them there.
    hesitant = replace(certain, rate=np.full((1, 2), 0.9))
    with pytest.raises(MOMDPError, match=r"y' 0 \(calm\) have total probability 0"):
        check_momdp(
            having(replace(problem, transition=hesitant), "observation", (slice(None), 0), 0.0)
        )
    swap = mixed([[0.0, 1.0], [0.0, 1.0]])
    check_momdp(having(swap, "observation", (slice(None), 0), 0.0))
    with pytest.raises(MOMDPError, match=r"y' 1 \(tense\) have total probability 0"):
        check_momdp(having(swap, "observation", (slice(None), 1), 0.0))


def test_small_deviations_pass_and_the_tolerance_is_a_parameter() -> None:
    problem = having(SPARSE, "transition.value", 2, 0.25 - 1e-4)
    check_momdp(having(SPARSE, "transition.value", 2, 0.25 - 1e-8))
    check_momdp(problem, tolerance=1e-3)
    with pytest.raises(MOMDPError, match="total probability"):
        check_momdp(problem)


def test_states_that_no_root_leads_to_are_a_warning() -> None:
    problem = replace(SPARSE, roots=(Root(1, np.array([0.5, 0.5])),))
    with pytest.warns(MOMDPWarning, match=r"no root leads to 1 of 3 observed states: x 0 \(near\)"):
        check_momdp(problem)
    # An edge of probability 0 leads nowhere.
    closed = replace(
        having(SPARSE, "transition.value", slice(4, 8), 0.0),
        edge_start=np.array([0, 2, 2, 3, 4, 4, 4]),
        roots=(replace(ROOT, probability=1.0),),
    )
    with pytest.warns(MOMDPWarning, match=r"2 of 3 observed states: x 1 \(far\), x 2 \(door\)"):
        check_momdp(closed)


def test_many_mistakes_are_counted() -> None:
    problem = replace(
        SPARSE, reward=np.full((3, 2, 2), np.nan), discount=2.0, hidden_names=("calm", "calm")
    )
    with pytest.raises(MOMDPError) as caught:
        check_momdp(problem)
    # 1 discount, 5 of the 12 rewards, 1 name.
    assert len(caught.value.problems) == 7
    assert caught.value.omitted == 7
    assert str(caught.value).endswith("and 7 more")
    with pytest.raises(MOMDPError) as short:
        check_momdp(problem, limit=2)
    assert len(short.value.problems) == 2
    assert short.value.omitted == 12
    again = pickle.loads(pickle.dumps(short.value))
    assert (str(again), again.omitted) == (str(short.value), 12)
    assert isinstance(short.value, ValueError)


def big(edges: int, hidden: int, transition: Callable[[int], Any]) -> MOMDP:
    """A ring of observed states with one action."""
    return MOMDP(
        edge_start=np.arange(edges + 1),
        edge_next=(np.arange(edges) + 1) % edges,
        edge_map=np.zeros(edges, dtype=np.int64),
        transition=transition(hidden),
        observation=np.ones((1, hidden, 1)),
        observation_index=np.zeros((1, edges), dtype=np.int64),
        reward=np.zeros((edges, 1, hidden)),
        discount=0.9,
        roots=(Root(0, np.full(hidden, 1 / hidden)),),
        observed_names=tuple(map(str, range(edges))),
        hidden_names=tuple(map(str, range(hidden))),
        action_names=("on",),
        observation_names=("o",),
    )


def test_jumps_are_not_expanded_to_matrices() -> None:
    hidden = 4000  # a dense map has 16 million entries, 128 MB
    problem = big(
        3, hidden, lambda y: JumpTransition(np.full((y // 2, 2), 0.5), np.full((1, 2), 0.5))
    )
    tracemalloc.start()
    check_momdp(problem)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 16e6


def test_many_edges_take_seconds() -> None:
    problem = big(300_000, 2, lambda y: SparseTransition.from_dense(np.full((1, y, y), 1 / y)))
    start = time.process_time()
    check_momdp(problem)
    # 0.4 s where this was written. A loop over the edges in Python would take twenty.
    assert time.process_time() - start < 5
