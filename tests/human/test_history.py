"""The windows of the last k steps against sets of tuples, and their number in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.arrays import BoolArray, IntArray
from coadapt.human import history
from coadapt.human.history import NO_ACTION, NO_WINDOW, Windows, count_windows
from coadapt.human.remembered import locate
from coadapt.worlds import table_clearing

Task = tuple[IntArray, int, BoolArray]
Past = tuple[int, tuple[int, ...]]
"""The first state of a window and the actions since."""


@st.composite
def tasks(draw: st.DrawFn, *, with_ends: bool = True) -> Task:
    """Random moves, a start and places where the task ends."""
    states, actions = draw(st.integers(1, 6)), draw(st.integers(1, 3))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    ends = rng.random(states) < 0.25 if with_ends else np.zeros(states, dtype=np.bool_)
    return rng.integers(states, size=(states, actions)), int(rng.integers(states)), ends


def after(moves: IntArray, past: Past) -> int:
    """The state in which a window ends."""
    state, actions = past
    for a in actions:
        state = int(moves[state, a])
    return state


def slid(moves: IntArray, past: Past, action: int, memory: int) -> Past:
    """The last ``memory - 1`` steps once ``action`` is taken."""
    first, actions = past[0], (*past[1], action)
    while len(actions) > memory - 1:
        first, actions = int(moves[first, actions[0]]), actions[1:]
    return first, actions


def reachable(task: Task, memory: int) -> set[Past]:
    moves, start, ends = task
    found: set[Past] = set()
    front: set[Past] = {(start, ())}
    while front:
        found |= front
        front = {
            slid(moves, past, a, memory)
            for past in front
            if not ends[after(moves, past)]
            for a in range(moves.shape[1])
        } - found
    return found


def pasts(windows: Windows) -> list[Past]:
    return [
        (int(first), tuple(a for a in actions if a != NO_ACTION))
        for first, actions in zip(windows.first, windows.actions.tolist(), strict=True)
    ]


@given(tasks(), st.integers(2, 4))
def test_windows_are_those_that_can_be_reached(task: Task, memory: int) -> None:
    moves, start, ends = task
    windows = Windows.of(moves, start, ends, memory)
    found = pasts(windows)
    assert len(found) == len(set(found)) == len(windows) == count_windows(*task, memory)
    assert set(found) == reachable(task, memory)
    # Shorter ones first, each filled up at its end.
    lengths = [len(actions) for _, actions in found]
    assert lengths == sorted(lengths)
    for row, (_, actions) in zip(windows.actions.tolist(), found, strict=True):
        assert row == [*actions, *[NO_ACTION] * (memory - 1 - len(actions))]
    assert windows.state.tolist() == [after(moves, past) for past in found]
    for w, past in enumerate(found):
        for a in range(moves.shape[1]):
            goes_on = not ends[windows.state[w]]
            assert found[windows.next[w, a, 0]] == (
                slid(moves, past, a, memory) if goes_on else past
            )
    # Only the start needs no past.
    expected = [found.index((x, ())) if x == start else NO_WINDOW for x in range(len(moves))]
    assert windows.beginning.tolist() == expected


@given(tasks())
def test_with_one_step_windows_are_states(task: Task) -> None:
    moves, _, ends = task
    windows = Windows.of(*task, 1)
    every = np.arange(len(moves))
    assert windows.actions.shape == (len(moves), 0)
    for states in (windows.first, windows.state, windows.beginning):
        assert states.tolist() == every.tolist()
    assert windows.next[:, :, 0].tolist() == np.where(ends[:, None], every[:, None], moves).tolist()
    assert count_windows(*task, 1) == len(moves)


@given(tasks(with_ends=False), st.integers(2, 4))
def test_their_number_where_nothing_ends_the_task(task: Task, memory: int) -> None:
    # A^i sequences of i actions: from the start for i < k - 1, from what can be reached for k - 1.
    moves, start, ends = task
    actions = moves.shape[1]
    states = len({after(moves, past) for past in reachable(task, 2)} | {start})
    expected = sum(actions**i for i in range(memory - 1)) + states * actions ** (memory - 1)
    assert len(Windows.of(moves, start, ends, memory)) == expected


@pytest.mark.parametrize(
    ("memory", "expected"),
    # 52 states of which 2 are goals; 3 actions. k = 2: the start and 50 * 3. k = 3: 1 + 3, and
    # 150 * 3 less the 3 actions after each step into a goal. Such steps are, at either goal, the
    # one from the side and the one from below.
    [(1, 52), (2, 1 + 150), (3, 1 + 3 + 450 - 2 * 2 * 3)],
)
def test_table_clearing(memory: int, expected: int) -> None:
    world = table_clearing()
    ends = np.isin(np.arange(world.states), world.goal_states)
    assert count_windows(world.moves, world.start, ends, memory) == expected
    assert len(Windows.of(world.moves, world.start, ends, memory)) == expected


@given(tasks(), st.integers(1, 4), st.integers(0, 2**32))
def test_the_steps_are_the_last_k(task: Task, memory: int, seed: int) -> None:
    moves, start, ends = task
    windows = Windows.of(moves, start, ends, memory)
    steps = list(windows.steps(moves))
    assert len(steps) == memory
    rng = np.random.default_rng(seed)
    state, window = start, int(windows.beginning[start])
    taken: list[tuple[int, int]] = []
    while not ends[state] and len(taken) < 7:
        a = int(rng.integers(moves.shape[1]))
        taken.append((state, a))
        shape = (len(windows), moves.shape[1])
        seen = [
            (int(np.broadcast_to(x, shape)[window, a]), int(np.broadcast_to(u, shape)[window, a]))
            for x, u in steps
        ]
        # Steps that were not yet taken stand between those of the window and the present one.
        assert [step for step in seen if step[1] != NO_ACTION] == taken[-memory:]
        state, window = int(moves[state, a]), int(windows.next[window, a, 0])
        assert windows.state[window] == state


def test_where_a_step_begins() -> None:
    # 0 - 1 - 2 - 3 in a row, actions back and on; the task begins in 1 and ends in 3.
    moves = np.array([[0, 1], [0, 2], [1, 3], [3, 3]])
    ends = np.array([False, False, False, True])
    windows = Windows.of(moves, 1, ends, 2)
    beginning = locate(windows, None, 1)
    after_on = int(windows.next[beginning, 1, 0])
    assert locate(windows, np.array([after_on]), 2) == after_on
    # Back in the start without a way there: nothing is remembered.
    assert locate(windows, np.array([after_on]), 1) == beginning
    with pytest.raises(ValueError, match="state 0 does not follow from the last action"):
        locate(windows, np.array([after_on]), 0)
    # With one step no past is needed anywhere.
    assert locate(Windows.of(moves, 1, ends, 1), np.array([2]), 0) == 0


@pytest.mark.parametrize("memory", [-1, 0, history.LONGEST_MEMORY + 1])
def test_memories_out_of_range_are_refused(memory: int) -> None:
    moves, ends = np.array([[0]]), np.array([False])
    with pytest.raises(ValueError, match=f"memory must be 1 to 100 steps, not {memory}"):
        Windows.of(moves, 0, ends, memory)


def test_too_many_windows_are_refused() -> None:
    # Two actions that stay: 2^20 + ... windows of 20 actions are about two millions.
    moves, ends = np.zeros((1, 2), dtype=np.int64), np.array([False])
    assert count_windows(moves, 0, ends, 21) == 2**21 - 1
    with pytest.raises(ValueError, match="21 steps makes more than 2,000,000 windows"):
        Windows.of(moves, 0, ends, 21)
    # One action: as many windows as steps.
    assert len(Windows.of(np.array([[0]]), 0, ends, 100)) == 100
