"""Each rule of the `.pomdp` grammar on a file small enough to work out by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from coadapt.momdp import MOMDP, check_momdp
from tests.momdp.files.helpers import problem_from

HEAD = """
discount: 0.5
values: reward
states: left right
actions: stay swap
observations: dark light glare
"""

BODY = """
T: stay identity
T: swap
0 1
1 0
O: * uniform
"""


def matrices(problem: MOMDP) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """``T[a, s, s']``, ``O[a, s', o]``, ``R[a, s]``."""
    check_momdp(problem)
    moves = np.stack([problem.transition.matrix(int(k)) for k in problem.edge_map])
    return moves, problem.observation[problem.observation_index[:, 0]], problem.reward[0]


def test_names_and_shape(tmp_path: Path) -> None:
    problem = problem_from(tmp_path, HEAD + BODY)
    assert problem.shape == (1, 2, 2, 3)
    assert problem.observed_names == ("x0",)
    assert problem.hidden_names == ("left", "right")
    assert problem.action_names == ("stay", "swap")
    assert problem.observation_names == ("dark", "light", "glare")
    assert problem.discount == 0.5
    assert [root.x for root in problem.roots] == [0]


def test_numbered_symbols_are_named_and_referred_to_by_number(tmp_path: Path) -> None:
    problem = problem_from(
        tmp_path,
        "discount: 0.9\nstates: 3\nactions: 1\nobservations: 2\n"
        "T: 0 : 0 : 2 1.0\nT: 0 : 1 : 0 1.0\nT: 0 : 2 : 1 1\nO: 0 : * : 1 1.0\n",
    )
    moves, seen, _ = matrices(problem)
    assert problem.hidden_names == ("s0", "s1", "s2")
    assert problem.action_names == ("a0",)
    assert problem.observation_names == ("o0", "o1")
    assert moves.tolist() == [[[0, 0, 1], [1, 0, 0], [0, 1, 0]]]
    assert seen.tolist() == [[[0, 1]] * 3]


def test_names_may_be_referred_to_by_number(tmp_path: Path) -> None:
    moves, _, _ = matrices(problem_from(tmp_path, HEAD + BODY + "T: 0 : 1\n1 0\n"))
    assert moves[0].tolist() == [[1, 0], [1, 0]]


@pytest.mark.parametrize(
    ("entries", "expected"),
    [
        ("T: * identity", [[[1, 0], [0, 1]], [[1, 0], [0, 1]]]),
        ("T: * uniform", [[[0.5, 0.5]] * 2] * 2),
        ("T: *\n.25 .75\n1e0 0", [[[0.25, 0.75], [1, 0]]] * 2),
        ("T: * : * uniform", [[[0.5, 0.5]] * 2] * 2),
        ("T: * : *\n0.25 0.75", [[[0.25, 0.75]] * 2] * 2),
        ("T: * : * : right 1.0", [[[0, 1]] * 2] * 2),
        ("T: * identity\nT: swap : left : left 0\nT: swap : left : right +1",
         [[[1, 0], [0, 1]], [[0, 1], [0, 1]]]),
        # A later entry wins, by wildcard too; an earlier one does not come back.
        ("T: swap : left\n0 1\nT: * identity", [[[1, 0], [0, 1]]] * 2),
        ("T: * uniform\nT: swap : *\n1 0\nT: * : right : left 0.5\nT: * : right : right 0.5",
         [[[0.5, 0.5], [0.5, 0.5]], [[1, 0], [0.5, 0.5]]]),
        # The row becomes the start belief: uniform when the file gives none.
        ("T: * identity\nT: stay : right reset", [[[1, 0], [0.5, 0.5]], [[1, 0], [0, 1]]]),
        ("T:*identity".replace("*i", "* i"), [[[1, 0], [0, 1]]] * 2),
    ],
)  # fmt: skip
def test_transitions(tmp_path: Path, entries: str, expected: list[object]) -> None:
    moves, _, _ = matrices(problem_from(tmp_path, f"{HEAD}{entries}\nO: * uniform\n"))
    np.testing.assert_array_equal(moves, expected)


@pytest.mark.parametrize(
    ("entries", "expected"),
    [
        ("O: *\n1 0 0\n0 .5 .5", [[[1, 0, 0], [0, 0.5, 0.5]]] * 2),
        ("O: * : left\n0 0 1\nO : * : right uniform", [[[0, 0, 1], [1 / 3] * 3]] * 2),
        ("O: stay uniform\nO: swap : * : glare 1.0", [[[1 / 3] * 3] * 2, [[0, 0, 1]] * 2]),
        ("O: * uniform\nO: swap : 0\n0.5 0.25 0.25",
         [[[1 / 3] * 3] * 2, [[0.5, 0.25, 0.25], [1 / 3] * 3]]),
    ],
)  # fmt: skip
def test_observations(tmp_path: Path, entries: str, expected: list[object]) -> None:
    _, seen, _ = matrices(problem_from(tmp_path, f"{HEAD}T: * identity\n{entries}\n"))
    np.testing.assert_array_equal(seen, expected)


# Below, stay leads to (1/4 left, 3/4 right), swap to the other state, and the observations are
# dark 1 in left; light 1/2, glare 1/2 in right.
MIXED = "T: stay : *\n0.25 0.75\nT: swap\n0 1\n1 0\nO: *\n1 0 0\n0 0.5 0.5\n"


@pytest.mark.parametrize(
    ("entries", "expected"),
    [
        ("R: * : * : * : * 2", [[2, 2], [2, 2]]),
        ("R: stay : left : * : * -1.5", [[-1.5, 0], [0, 0]]),
        # stay: 3/4 of 4; swap from left: all of 4.
        ("R: * : * : right : * 4", [[3, 3], [4, 0]]),
        # stay: 3/4 x 1/2 of 8; swap from left: 1/2 of 8.
        ("R: * : * : * : glare 8", [[3, 3], [4, 0]]),
        # A row over observations. stay: 1/4 x 1 + 3/4 x (1/2 x 2 + 1/2 x 4) for each entry
        # only where the row is given, here for the successor right: 3/4 x 3; swap: 3.
        ("R: * : left : right\n1 2 4", [[2.25, 0], [3, 0]]),
        # A matrix, successors by observations: 1/4 x 1 + 3/4 x (5/2 + 6/2).
        ("R: stay : left\n1 2 3\n4 5 6", [[4.375, 0], [0, 0]]),
        # All of an action: from left as before, from right all 0.
        ("R: stay\n1 2 3\n4 5 6\n0 0 0\n0 0 0", [[4.375, 0], [0, 0]]),
        # The last entry that fits wins: 1/4 x 7 + 3/4 x (7/2 + 1/2).
        ("R: stay : * : * : * 7\nR: stay : left : right : glare 1", [[4.75, 7], [0, 0]]),
        ("R: stay : left : right : glare 1\nR: stay : * : * : * 7", [[7, 7], [0, 0]]),
        ("R: * : * : right : * 4\nR: * : left : * : * 1\nR: * : left : * : dark 5",
         [[0.25 * 5 + 0.75, 3], [1, 0]]),
    ],
)  # fmt: skip
def test_rewards(tmp_path: Path, entries: str, expected: list[object]) -> None:
    _, _, reward = matrices(problem_from(tmp_path, f"{HEAD}{MIXED}{entries}\n"))
    np.testing.assert_allclose(reward, expected, rtol=0, atol=1e-15)


def test_costs_are_negative_rewards(tmp_path: Path) -> None:
    text = HEAD.replace("reward", "cost") + BODY + "R: stay : * : * : * 3\n"
    assert matrices(problem_from(tmp_path, text))[2].tolist() == [[-3, -3], [0, 0]]


@pytest.mark.parametrize(
    ("start", "expected"),
    [
        ("", [0.5, 0.5]),
        ("start: uniform", [0.5, 0.5]),
        ("start: 0.25 0.75", [0.25, 0.75]),
        ("start: 1 0", [1, 0]),
        ("start: right", [0, 1]),
        ("start: 1", [0, 1]),
        ("start include: right", [0, 1]),
        ("start include: left 1", [0.5, 0.5]),
        ("start exclude: right", [1, 0]),
        ("start exclude : 0", [0, 1]),
    ],
)
def test_start(tmp_path: Path, start: str, expected: list[float]) -> None:
    problem = problem_from(tmp_path, f"{HEAD}{start}\n{BODY}")
    assert problem.roots[0].belief.tolist() == expected


@pytest.mark.parametrize(("start", "state"), [("start: 0", 0), ("start: 1.0", 0), ("start: 1", 0)])
def test_start_of_a_single_state(tmp_path: Path, start: str, state: int) -> None:
    text = "discount: 0\nstates: 1\nactions: 1\nobservations: 1\n"
    problem = problem_from(tmp_path, f"{text}{start}\nT: 0 uniform\nO: 0 uniform\n")
    assert problem.roots[0].belief[state] == 1


def test_start_may_stand_among_the_declarations(tmp_path: Path) -> None:
    text = "states: a b\nstart: b\ndiscount: 0\nactions: 1\nobservations: 1\n"
    problem = problem_from(tmp_path, f"{text}T: 0 identity\nO: 0 uniform\n")
    assert problem.roots[0].belief.tolist() == [0, 1]


def test_comments_blank_lines_and_order(tmp_path: Path) -> None:
    plain = problem_from(tmp_path, HEAD + BODY)
    decorated = problem_from(
        tmp_path,
        "# T: nothing\r\n\tobservations:dark # the first\nlight\nglare\nactions : stay swap#\n"
        "states:\n\tleft\n\n\tright\nvalues:reward discount:.5\n"
        "O:*uniform\n".replace("*u", "* u")
        + "T:swap 0 1 1 0\nT\n:\nstay\nidentity # end",
    )
    for one, other in zip(matrices(plain), matrices(decorated), strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_name_may_be_a_keyword_where_no_colon_follows(tmp_path: Path) -> None:
    text = "discount: 0\nstates: T O\nactions: R\nobservations: start\n"
    problem = problem_from(tmp_path, f"{text}T: R : T : O 1\nT: R : O : T 1\nO: R uniform\n")
    assert problem.hidden_names == ("T", "O")
    assert problem.transition.matrix(0).tolist() == [[0, 1], [1, 0]]


def test_names_after_a_byte_order_mark_and_comments_in_latin_1(tmp_path: Path) -> None:
    data = b"\xef\xbb\xbf# caf\xe9\n" + (HEAD + BODY).encode()
    assert problem_from(tmp_path, data).hidden_names == ("left", "right")


def test_equal_matrices_are_kept_once(tmp_path: Path) -> None:
    text = HEAD + "T: stay\n1 0 0 1\nT: swap identity\nO: * uniform\n"
    problem = problem_from(tmp_path, text)
    assert problem.transition.count == 1
    assert problem.observation.shape == (1, 2, 3)
    assert problem.edge_map.tolist() == [0, 0]


def test_few_digits_are_normalised(tmp_path: Path) -> None:
    # 0.33333 + 0.33333 + 0.33333 = 0.99999.
    text = HEAD + "T: * identity\nO: *\n.33333 .33333 .33333\n1 0 0\n"
    _, seen, _ = matrices(problem_from(tmp_path, text))
    np.testing.assert_allclose(seen[0, 0], [1 / 3] * 3, rtol=0, atol=1e-16)
    np.testing.assert_array_equal(seen[0, 1], [1, 0, 0])


def test_observations_of_what_cannot_be_reached_may_be_left_out(tmp_path: Path) -> None:
    # stay and swap lead to left only. The row of right is uniform: any distribution would do.
    text = HEAD + "T: * : * : left 1\nO: * : left : light 1\n"
    _, seen, _ = matrices(problem_from(tmp_path, text))
    np.testing.assert_array_equal(seen, [[[0, 1, 0], [1 / 3] * 3]] * 2)
