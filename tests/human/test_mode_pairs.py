"""The mode seen most often, and the windows of mode pairs."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.human.history import NO_WINDOW
from coadapt.human.mode_pairs import NO_MODE, TIES, PairWindows, Ties, most_frequent


@given(
    st.lists(st.integers(NO_MODE, 3), min_size=1, max_size=7),
    st.sampled_from(TIES),
)
def test_the_most_frequent_mode_is_that_of_counting(seen: list[int], ties: Ties) -> None:
    found = most_frequent(np.array(seen), 4, ties)
    known = [m for m in seen if m != NO_MODE]
    if not known:
        assert not found.any()
        return
    count = Counter(known)
    leaders = [m for m in known if count[m] == max(count.values())]
    expected = np.zeros(4)
    if ties == "even":
        expected[sorted(set(leaders))] = 1 / len(set(leaders))
    else:
        expected[leaders[-1 if ties == "latest" else 0]] = 1
    np.testing.assert_allclose(found, expected, atol=1e-15)


@given(st.integers(1, 4), st.integers(1, 3), st.integers(0, 2**32))
def test_many_windows_at_once_are_those_one_by_one(memory: int, modes: int, seed: int) -> None:
    seen = np.random.default_rng(seed).integers(NO_MODE, modes, size=(5, memory))
    for ties in TIES:
        together = most_frequent(seen, modes, ties)
        for row, found in zip(seen, together, strict=True):
            np.testing.assert_array_equal(found, most_frequent(row, modes, ties))


def test_windows_grow_slide_and_end() -> None:
    # Two states, of which 1 ends the task; both actions equal lead there. Actions show modes,
    # but the robot's second shows none.
    moves = np.array([[[1, 0], [0, 1]], [[1, 1], [1, 1]]])
    windows = PairWindows.of(
        moves,
        (0,),
        np.array([False, True]),
        2,
        np.array([[0, NO_MODE]] * 2),
        np.array([[0, 1]] * 2),
    )
    start = int(windows.beginning[0])
    assert windows.length[start] == 0
    assert windows.beginning[1] == NO_WINDOW
    one = int(windows.next[start, 0, 1])
    assert (windows.state[one], windows.length[one]) == (0, 1)
    assert windows.human_modes[one].tolist() == [1, NO_MODE]
    assert windows.robot_modes[one].tolist() == [0, NO_MODE]
    two = int(windows.next[one, 1, 0])
    assert windows.human_modes[two].tolist() == [1, 0]
    assert windows.robot_modes[two].tolist() == [0, NO_MODE]
    three = int(windows.next[two, 1, 1])
    assert windows.state[three] == 1
    assert windows.human_modes[three].tolist() == [0, 1]
    assert windows.next[three].tolist() == [[three] * 2] * 2


def test_human_actions_without_a_mode_lead_nowhere() -> None:
    moves = np.zeros((1, 1, 2), dtype=np.int64)
    windows = PairWindows.of(
        moves, (0,), np.array([False]), 1, np.array([[0]]), np.array([[0, NO_MODE]])
    )
    assert windows.next[:, 0, 1].tolist() == [NO_WINDOW] * len(windows)


@pytest.mark.parametrize("memory", [0, 101])
def test_the_memory_is_limited(memory: int) -> None:
    moves, mode = np.zeros((1, 1, 1), dtype=np.int64), np.zeros((1, 1), dtype=np.int64)
    with pytest.raises(ValueError, match="memory must be 1 to 100 steps"):
        PairWindows.of(moves, (0,), np.array([False]), memory, mode, mode)
