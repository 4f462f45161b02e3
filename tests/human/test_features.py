"""Windows by their features against all windows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import comb

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import coadapt as ca
from coadapt import SharedAutonomy
from coadapt.human.features import PerceivedMode, action_counts, feature_windows
from coadapt.human.history import NO_ACTION, NO_WINDOW
from coadapt.momdp.check import MOMDPWarning, check_momdp
from tests.formalism.strategies import models


def everything(states: Sequence[int], actions: Sequence[int]) -> object:
    """Leaves nothing out."""
    return tuple(states), tuple(actions)


@given(models(memory=4, general=True))
def test_where_everything_counts_nothing_is_lost(model: SharedAutonomy) -> None:
    # The windows that can be reached are the same, in another order.
    whole, found = model.windows, replace(model, features=everything).windows
    starts = list(model.world.start_chances)
    other = {int(whole.beginning[x]): int(found.beginning[x]) for x in starts}
    front = list(other)
    while front:
        w = front.pop()
        v = other[w]
        assert whole.state[w] == found.state[v]
        np.testing.assert_allclose(
            model.perceived[w], replace(model, features=everything).perceived[v], atol=1e-12
        )
        if model.world.ends[whole.state[w]]:
            continue
        for after, followed in zip(whole.next[w].flat, found.next[v].flat, strict=True):
            assert (after == NO_WINDOW) == (followed == NO_WINDOW)
            if after == NO_WINDOW:
                continue
            if int(after) not in other:
                other[int(after)] = int(followed)
                front.append(int(after))
            assert other[int(after)] == followed
    assert len(set(other.values())) == len(other) == len(found)


@given(models(memory=4, general=True), st.integers(1, 6))
@pytest.mark.filterwarnings(f"ignore::{MOMDPWarning.__module__}.{MOMDPWarning.__name__}")
def test_problems_by_features_pass_the_check(model: SharedAutonomy, levels: int) -> None:
    for features in (action_counts, PerceivedMode(model.modal_policies, levels)):
        fewer = replace(model, features=features)
        check_momdp(fewer.to_momdp())
        np.testing.assert_allclose(fewer.perceived.sum(axis=2), 1.0, atol=1e-12)


def test_one_window_for_each_state_and_features() -> None:
    world = ca.worlds.table_clearing(7, 3)
    model = SharedAutonomy(world, memory=6, features=action_counts)
    windows = model.windows
    # Five actions of three kinds in any numbers: C(5 + 2, 2) = 21 at most in each state.
    assert len(windows) <= world.states * sum(comb(n + 2, 2) for n in range(6))
    assert len(windows) < len(SharedAutonomy(world, memory=6).windows) / 10
    counts = [tuple(sorted(a for a in row if a != NO_ACTION)) for row in windows.actions.tolist()]
    assert len(set(zip(windows.state.tolist(), counts, strict=True))) == len(windows)
    # Of one step nothing is past: the features are empty.
    assert len(SharedAutonomy(world, memory=1, features=action_counts).windows) == world.states


def test_what_the_past_looked_like_is_rounded() -> None:
    # Two modes, one state, two actions: likelihoods 0.8 ** 2 and 0.3 ** 2 of two first actions.
    policies = np.array([[[0.8, 0.2]], [[0.3, 0.7]]])
    share = 0.64 / (0.64 + 0.09)
    assert PerceivedMode(policies, 100)((0, 0, 0), (0, 0)) == (round(100 * share), 12)
    assert PerceivedMode(policies, 2)((0,), ()) == (1, 1)
    # Impossible in either mode: it says nothing.
    assert PerceivedMode(np.zeros((2, 1, 2)), 10)((0, 0), (1,)) == (5, 5)


@pytest.mark.parametrize("memory", [0, 101])
def test_memories_out_of_range_are_refused(memory: int) -> None:
    with pytest.raises(ValueError, match="memory must be 1 to 100"):
        feature_windows(np.array([[0]]), [0], np.array([False]), memory, action_counts)


def test_too_many_windows_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    moves, ends = np.zeros((1, 2), dtype=np.int64), np.array([False])
    # Up to three of two actions, everything remembered: 1 + 2 + 4 + 8.
    assert len(feature_windows(moves, [0], ends, 4, everything)) == 15
    monkeypatch.setattr("coadapt.human.enumeration.MOST_WINDOWS", 10)
    with pytest.raises(ValueError, match="more than 10 windows"):
        feature_windows(moves, [0], ends, 20, everything)
