"""Writing `.pomdpx`: the same problem comes back, and what is added changes values as stated."""

from __future__ import annotations

import tempfile
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import coadapt as ca
from coadapt.errors import InputError
from coadapt.momdp import MOMDP, MOMDPWarning, Root, check_momdp
from coadapt.momdp.exact import exact_value
from coadapt.momdp.files import read_pomdp, write_pomdpx
from coadapt.momdp.files.file_form import as_sparse, file_form
from coadapt.momdp.sarsop import SARSOP
from tests.momdp.files.helpers import assert_same, assert_same_moves
from tests.momdp.problems import corridor, dense_map, tiger
from tests.momdp.strategies import jump_momdps, momdps, sparse_momdps


def round_trip(problem: MOMDP) -> MOMDP:
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "problem.pomdpx"
        write_pomdpx(problem, path)
        return read_pomdp(path)


def check(problem: MOMDP) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MOMDPWarning)  # some states may not be reachable
        check_momdp(problem)


def value(problem: MOMDP) -> float:
    """The optimal value, averaged over the roots."""
    chances = [root.probability for root in problem.roots]
    return float(exact_value(problem, 1e-7).lower @ chances)


def test_tiger_comes_back(tmp_path: Path) -> None:
    write_pomdpx(tiger(), tmp_path / "tiger.pomdpx")
    assert_same(tiger(), read_pomdp(tmp_path / "tiger.pomdpx"), tolerance=0)
    assert [path.name for path in tmp_path.iterdir()] == ["tiger.pomdpx"]


@given(momdps())
def test_states_of_the_problem_come_back(problem: MOMDP) -> None:
    again = round_trip(problem)
    check(again)
    ends = np.diff(problem.edge_start).reshape(problem.shape[0], -1) == 0
    different = len({root.x for root in problem.roots}) == len(problem.roots)
    if not ends.any() and different:
        roots = sorted(problem.roots, key=lambda root: root.x)
        assert_same(replace(problem, roots=tuple(roots)), again)
        return
    own = problem.shape[0]
    assert again.observed_names[:own] == problem.observed_names
    np.testing.assert_array_equal(again.reward[:own], problem.reward)
    if not ends.any():
        assert_same_moves(problem, again)
        return
    sink = again.observed_names.index("end")
    for x, a in np.argwhere(ends):
        assert [again.edge_next[e] for e in again.edges(x, a)] == [sink]
    for a in range(again.shape[2]):
        assert [again.edge_next[e] for e in again.edges(sink, a)] == [sink]
    assert not again.reward[sink].any()


@given(sparse_momdps(sizes=2, discounts=(0.5,)))
def test_values_are_as_stated(problem: MOMDP) -> None:
    _, factor = file_form(problem)
    assert value(round_trip(problem)) == pytest.approx(factor * value(problem), abs=1e-6)


@given(sparse_momdps(sizes=2, discounts=(0.5,)), st.integers(0, 2**32))
def test_roots_told_apart_by_the_first_observation(problem: MOMDP, seed: int) -> None:
    """A start state is added, and costs one step."""
    rng = np.random.default_rng(seed)
    states, size, actions, _ = problem.shape
    # The observation on arrival in x is the same for all actions, as in shared autonomy.
    problem = replace(
        problem,
        observation_index=np.tile(np.arange(states), (actions, 1)),
        observation=np.ascontiguousarray(problem.observation[:states]),
    )
    x, prior = int(rng.integers(states)), rng.dirichlet(np.ones(size))
    joint = prior[:, None] * problem.observation[x]
    chance = joint.sum(axis=0)
    roots = [Root(x, joint[:, o] / chance[o], float(chance[o])) for o in np.flatnonzero(chance)]
    problem = replace(problem, roots=tuple(roots))
    closed, factor = file_form(problem)
    again = round_trip(problem)
    check(again)
    assert value(again) == pytest.approx(factor * value(problem), abs=1e-6)
    if len({tuple(root.belief) for root in roots}) > 1:
        assert factor == problem.discount
        assert closed.observed_names[-1] == "start"
        assert [root.x for root in again.roots] == [len(again.observed_names) - 1]
        np.testing.assert_allclose(again.roots[0].belief, prior, atol=1e-12)


def test_roots_that_no_observation_tells_apart_get_copies() -> None:
    problem = corridor()
    roots = (
        Root(0, np.array([1.0, 0.0]), 0.25),
        Root(0, np.array([0.5, 0.5]), 0.5),
        Root(1, np.array([0.0, 1.0]), 0.125),
        Root(0, np.array([1.0, 0.0]), 0.125),  # equal to the first
    )
    problem = replace(problem, roots=roots)
    closed, factor = file_form(problem)
    assert factor == 1
    assert closed.observed_names == ("near", "far", "door", "end", "near~2")
    assert [(root.x, root.probability) for root in closed.roots] == [
        (0, 0.375), (4, 0.5), (1, 0.125),
    ]  # fmt: skip
    again = round_trip(problem)
    check(again)
    np.testing.assert_array_equal(again.reward[4], again.reward[0])
    assert value(again) == pytest.approx(value(problem), abs=1e-6)


@given(jump_momdps())
def test_jumps_as_sparse_maps(problem: MOMDP) -> None:
    found = as_sparse(problem.transition)
    assert found.count == problem.transition.count
    for k in range(found.count):
        np.testing.assert_allclose(
            dense_map(found, k), dense_map(problem.transition, k), rtol=0, atol=1e-15
        )


def test_shared_autonomy_has_its_value() -> None:
    """The first input is the first observation; the start state costs one step."""
    model = ca.SharedAutonomy(ca.worlds.table_clearing()).to_momdp()
    again = round_trip(model)
    check_momdp(again)
    assert again.observed_names[-2:] == ("end", "start")
    expected = SARSOP(gap=1e-3).solve(model)
    found = SARSOP(gap=1e-3).solve(again)
    assert found.lower <= model.discount * expected.upper + 1e-9
    assert found.upper >= model.discount * expected.lower - 1e-9


def test_names_are_made_words() -> None:
    problem = replace(
        tiger(),
        hidden_names=("a b", "a_b"),
        action_names=("*", "<&>", "\x00\u2028"),
        observation_names=("", "-"),
        observed_names=("only one",),
    )
    again = round_trip(problem)
    assert again.hidden_names == ("a_b", "a_b~1")
    assert again.action_names == ("_", "<&>", "__")
    assert again.observation_names == ("_", "_~1")
    assert again.observed_names == ("only_one",)


def test_impossible_observations_become_uniform() -> None:
    # Both actions of the corridor lead to near and far; nothing leads to `door` by staying.
    problem = corridor()
    observation = problem.observation.copy()
    observation[problem.observation_index[0, 2]] = 7.0
    again = round_trip(replace(problem, observation=observation))
    np.testing.assert_array_equal(again.observation[again.observation_index[0, 2]], 0.5)


def test_errors_leave_nothing_behind(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be written"):
        write_pomdpx(tiger(), tmp_path / "missing" / "a.pomdpx")
    (tmp_path / "a.pomdpx").mkdir()
    with pytest.raises(InputError, match="cannot be written"):
        write_pomdpx(tiger(), tmp_path / "a.pomdpx")
    assert [path.name for path in tmp_path.iterdir()] == ["a.pomdpx"]


def test_an_existing_file_is_kept_when_writing_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "tiger.pomdpx"
    path.write_text("before")

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("coadapt.momdp.files.pomdpx_text.Writer.entry", fail)
    with pytest.raises(InputError, match="No space left"):
        write_pomdpx(tiger(), path)
    assert path.read_text() == "before"
    assert len(list(tmp_path.iterdir())) == 1
