"""Published problems: every file loads, is valid, and is written and read back the same."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

from coadapt.momdp import check_momdp
from coadapt.momdp.files import read_pomdp, write_pomdpx
from coadapt.momdp.sarsop import SARSOP
from tests.momdp.files.helpers import assert_same

# From the files themselves: |X|, |Y|, |A|, |O|.
SHAPES = {
    "1d.pomdp": (1, 4, 2, 2),
    "4x3.95.pomdp": (1, 11, 4, 6),
    "4x5x2.95.pomdp": (1, 39, 4, 4),
    "Hallway.pomdp": (1, 60, 5, 21),
    "Hallway.pomdpx": (1, 60, 5, 21),
    "RockSample_11_11.pomdpx": (122, 2048, 16, 2),
    "RockSample_4_4.pomdpx": (17, 16, 9, 2),
    "RockSample_7_8.pomdpx": (50, 256, 13, 2),
    "TagAvoid.pomdp": (1, 870, 5, 30),
    "TagAvoid.pomdpx": (29, 30, 5, 30),
    "Tiger.pomdp": (1, 2, 3, 2),
    "Tiger.pomdpx": (1, 2, 3, 2),
    "aloha.10.pomdp": (1, 30, 9, 3),
    "boettiger_example.pomdpx": (1, 24, 24, 24),
    "bridge-repair.pomdp": (1, 5, 12, 5),
    "cheese.95.pomdp": (1, 11, 4, 7),
    "ejs1.pomdp": (1, 3, 4, 2),
    "hanks.95.pomdp": (1, 4, 4, 2),
    "learning.c2.pomdp": (1, 12, 8, 3),
    "mcc-example1.pomdp": (1, 4, 3, 3),
    "network.pomdp": (1, 7, 4, 2),
    "query.s3.pomdp": (1, 27, 3, 3),
    "shuttle.95.pomdp": (1, 8, 3, 5),
    "tiger-grid.pomdp": (1, 36, 5, 17),
    "tiger.aaai.pomdp": (1, 2, 3, 2),
    "web-ad.pomdp": (1, 4, 3, 5),
}


def test_no_file_is_forgotten(shared: Path) -> None:
    assert sorted(path.name for path in (shared / "problems").iterdir()) == sorted(SHAPES)


@pytest.mark.parametrize("name", SHAPES)
def test_loads_and_reads_back_the_same(shared: Path, name: str, tmp_path: Path) -> None:
    problem = read_pomdp(shared / "problems" / name)
    assert problem.shape == SHAPES[name]
    check_momdp(problem)
    write_pomdpx(problem, tmp_path / "again.pomdpx")
    again = read_pomdp(tmp_path / "again.pomdpx")
    check_momdp(again)
    assert_same(problem, again)


def test_a_large_file_has_few_maps(shared: Path) -> None:
    problem = read_pomdp(shared / "problems" / "RockSample_11_11.pomdpx")
    # Identity, and one map for each of the 11 rocks that sampling turns bad.
    assert problem.transition.count == 12


@pytest.mark.parametrize("name", ["Tiger", "Hallway"])
def test_both_forms_are_the_same_problem(shared: Path, name: str) -> None:
    one, other = (
        read_pomdp(shared / "problems" / f"{name}{suffix}") for suffix in (".pomdp", ".pomdpx")
    )
    for a in range(one.shape[2]):
        maps = [problem.transition.matrix(int(problem.edge_map[a])) for problem in (one, other)]
        # The files have six digits.
        np.testing.assert_allclose(*maps, rtol=0, atol=2e-6)
        seen = [p.observation[p.observation_index[a, 0]] for p in (one, other)]
        np.testing.assert_allclose(*seen, rtol=0, atol=2e-6)


@pytest.mark.parametrize("suffix", [".pomdp", ".pomdpx"])
def test_tiger_has_its_known_value(shared: Path, suffix: str) -> None:
    # 19.371: the C++ reference solver, and Tiger's value in the literature.
    solution = SARSOP(gap=1e-3).solve(read_pomdp(shared / "problems" / f"Tiger{suffix}"))
    assert solution.lower <= 19.372
    assert solution.upper >= 19.371
    assert solution.upper - solution.lower <= 1e-3


def test_tag_is_the_same_flat_and_factored(shared: Path) -> None:
    """The flat file's 870 states are robot x target in the factored file's order."""
    flat = read_pomdp(shared / "problems" / "TagAvoid.pomdp")
    factored = read_pomdp(shared / "problems" / "TagAvoid.pomdpx")
    states, size, actions, _ = factored.shape
    start = np.zeros((states, size))
    for root in factored.roots:
        start[root.x] = root.probability * root.belief
    np.testing.assert_allclose(flat.roots[0].belief, start.ravel(), atol=1e-6)
    # Where the two files were given different moves of the target; every other row is the same.
    different = {
        ("Srv3rh9", "Ttv3th9"),
        ("Srv1rh7", "Ttv1th5"),
        ("Srv0rh6", "Ttv1th6"),
        ("Srv0rh6", "Ttv0th6"),
    }
    names = list(itertools.product(factored.observed_names, factored.hidden_names))
    same = np.array([name not in different for name in names])
    for a in range(actions):
        joint = np.zeros((states, size, states, size))
        for x in range(states):
            for e in factored.edges(x, a):
                joint[x, :, factored.edge_next[e]] = factored.transition.matrix(
                    int(factored.edge_map[e])
                )
        expected = flat.transition.matrix(int(flat.edge_map[a]))
        found = joint.reshape(states * size, -1)
        np.testing.assert_allclose(found[same], expected[same], rtol=0, atol=2e-6)
        np.testing.assert_allclose(
            factored.reward[:, a].ravel(), flat.reward[0, a], rtol=0, atol=1e-6
        )
