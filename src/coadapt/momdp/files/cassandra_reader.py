"""Reads `.pomdp` files, in the grammar of Cassandra's pomdp-solve.

A problem has one observed state; the states of the file are the hidden ones. The hidden
transition of an action is its matrix ``T``; actions with equal matrices share one. The reward is
the expectation of the file's over successor and observation.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.errors import FileError
from coadapt.momdp.files.cassandra_head import Head, Names, read_head
from coadapt.momdp.files.cassandra_rewards import RewardRules
from coadapt.momdp.files.cassandra_tokens import Tokens
from coadapt.momdp.files.layered import ENUM, WILD, LayeredTable, Selectors
from coadapt.momdp.files.limits import (
    MAX_ENTRIES,
    MAX_OBSERVATIONS,
    MAX_REWARDS,
    check_size,
)
from coadapt.momdp.files.rows import normalised
from coadapt.momdp.files.slices import Slices
from coadapt.momdp.files.sparse_rows import SparseRows, different_rows
from coadapt.momdp.files.values import PROBABILITY_TOLERANCE, one_number
from coadapt.momdp.model import MOMDP, Root
from coadapt.momdp.transition import SparseTransition


def read_cassandra(path: object, lines: Iterator[str]) -> MOMDP:
    """The problem in a `.pomdp` file.

    Args:
        path: the file, for error messages.
        lines: its lines.

    Raises:
        FileError: naming the line, what was found and what was expected.
    """
    tokens = Tokens(path, lines)
    head = read_head(tokens)
    states, actions, seen = len(head.states), len(head.actions), len(head.observations)
    check_size(path, None, "states and actions", (states, actions), min(MAX_REWARDS, MAX_ENTRIES))
    check_size(path, None, "states and observations", (states, seen), MAX_OBSERVATIONS)
    moves = LayeredTable(path, (actions, states, states), (True, True, False))
    sights = LayeredTable(path, (actions, states, seen), (True, True, False))
    rules = RewardRules(path, (actions, states, states, seen))
    while (word := tokens.peek()) is not None:
        if word not in ("T", "O", "R"):
            raise tokens.error("T, O or R")
        line = tokens.line
        tokens.next(word)
        tokens.expect(":")
        if word == "T":
            _read_entry(tokens, line, moves, (head.actions, head.states, head.states), head)
        elif word == "O":
            _read_entry(tokens, line, sights, (head.actions, head.states, head.observations), head)
        else:
            _read_reward(tokens, line, rules, head)
    return _build(path, tokens.line, head, moves, sights, rules)


def _read_selectors(tokens: Tokens, axes: tuple[Names, ...]) -> list[int]:
    given = [axes[0].read(tokens)]
    while len(given) < len(axes) and tokens.accept(":"):
        given.append(axes[len(given)].read(tokens))
    return given


def _read_entry(
    tokens: Tokens, line: int, table: LayeredTable, axes: tuple[Names, Names, Names], head: Head
) -> None:
    """One entry of T or O: a number, a row or a matrix."""
    given = _read_selectors(tokens, axes)
    rest = len(axes) - len(given)
    word = tokens.peek()
    if word == "uniform" and rest:
        tokens.next(word)
        table.set(line, (*given, *(WILD,) * rest), np.array([1.0 / len(axes[-1])]))
        return
    listed: Selectors = (*given, *(ENUM,) * rest)
    if word == "identity" and rest == 2 and len(axes[1]) == len(axes[2]):
        tokens.next(word)
        table.set_identity(line, listed)
        return
    if word == "reset" and rest == 1 and axes[2] is head.states:
        tokens.next(word)
        table.set(line, listed, head.start)
        return
    if rest == 0:
        expected = "a probability from 0 to 1"
        value = one_number(tokens.path, tokens.line, tokens.next(expected), expected)
        if not 0 <= value <= 1 + PROBABILITY_TOLERANCE:
            raise FileError(tokens.path, line, f"found {value:g}, expected {expected}")
        table.set(line, listed, np.array([value]))
        return
    count = math.prod(len(axis) for axis in axes[len(given) :])
    check_size(tokens.path, line, "probabilities", (count,), MAX_REWARDS)
    if rest == 1:
        expected = f"{count} probabilities or 'uniform'"
    else:
        expected = f"{count} probabilities, 'uniform' or 'identity'"
    values = tokens.numbers(count, expected)
    wrong = (values < 0) | (values > 1 + PROBABILITY_TOLERANCE)
    if wrong.any():
        raise FileError(
            tokens.path,
            line,
            f"found {values[np.argmax(wrong)]:g}, expected a probability from 0 to 1",
        )
    table.set(line, listed, values)


def _read_reward(tokens: Tokens, line: int, rules: RewardRules, head: Head) -> None:
    axes = (head.actions, head.states, head.states, head.observations)
    given = _read_selectors(tokens, axes)
    count = math.prod(len(axis) for axis in axes[len(given) :])
    check_size(tokens.path, line, "rewards", (count,), MAX_REWARDS)
    kind = "reward" if head.sign > 0 else "cost"
    expected = f"a {kind}" if count == 1 else f"{count} {kind}s"
    rules.add(line, given, head.sign * tokens.numbers(count, expected))


def _build(
    path: object,
    end: int,
    head: Head,
    moves: LayeredTable,
    sights: LayeredTable,
    rules: RewardRules,
) -> MOMDP:
    states, actions, seen = len(head.states), len(head.actions), len(head.observations)

    def move(at: Selectors) -> str:
        return f"T for {head.actions.name(at[0])}, {head.states.name(at[1])}"

    def sight(at: Selectors) -> str:
        return f"O for {head.actions.name(at[0])}, {head.states.name(at[1])}"

    row = np.arange(actions * states).reshape(actions, states)
    slices = normalised(path, moves, move)
    rows = slices.at(row)  # [A, S]
    empty = np.diff(slices.start)[rows] == 0
    if empty.any():
        a, s = _first(empty)
        line = moves.line_of((a, s, WILD)) or end
        raise FileError(
            path, line, f"found no probabilities of {move((a, s, WILD))}, expected a sum of 1"
        )
    different, edge_map = different_rows(rows)  # [K, S], [A]
    _check_entries(path, slices, different)
    maps = _gather(slices, different.ravel())
    observed = normalised(path, sights, sight)
    shown = observed.at(row)
    reached = np.zeros((actions, states), dtype=np.bool_)
    arrives = np.zeros((len(different), states), dtype=np.bool_)
    arrives[maps.owner() // states, maps.index] = True
    reached[:] = arrives[edge_map]
    unseen = np.diff(observed.start)[shown] == 0
    if (unseen & reached).any():
        a, s = _first(unseen & reached)
        line = sights.line_of((a, s, WILD)) or end
        raise FileError(
            path, line, f"found no probabilities of {sight((a, s, WILD))}, expected a sum of 1"
        )
    kinds, observation_index = different_rows(shown)
    check_size(path, None, "observation matrices", (len(kinds), states, seen), MAX_OBSERVATIONS)
    observation = _dense(observed, kinds, seen)
    reward = rules.expectation(
        lambda a: _gather(slices, rows[a]), lambda a: _gather(observed, shown[a])
    )
    return MOMDP(
        edge_start=np.arange(actions + 1, dtype=np.int64),
        edge_next=np.zeros(actions, dtype=np.int64),
        edge_map=edge_map,
        transition=SparseTransition(
            hidden=states, row_start=maps.start, column=maps.index, value=maps.value
        ),
        observation=observation,
        observation_index=observation_index.reshape(actions, 1),
        reward=reward.reshape(1, actions, states),
        discount=head.discount,
        roots=(Root(0, head.start),),
        observed_names=("x0",),
        hidden_names=head.states.labels,
        action_names=head.actions.labels,
        observation_names=head.observations.labels,
    )


def _first(wrong: BoolArray) -> tuple[int, int]:
    """The first place ``[A, S]`` where ``wrong`` holds."""
    return divmod(int(np.argmax(wrong)), wrong.shape[1])


def _check_entries(path: object, slices: Slices, rows: IntArray) -> None:
    total = int(np.diff(slices.start)[rows].sum())
    check_size(path, None, "transitions with a probability above 0", (total,), MAX_ENTRIES)


def _gather(slices: Slices, rows: IntArray) -> SparseRows:
    """The slices ``rows``, one after the other."""
    return SparseRows(slices.start, slices.index, slices.value).take(rows)


def _dense(slices: Slices, kinds: IntArray, seen: int) -> FloatArray:
    """``[K, S, O]``; rows that nothing reaches and the file leaves out are uniform."""
    rows = _gather(slices, kinds.ravel())
    dense = np.zeros((kinds.size, seen))
    dense[rows.owner(), rows.index] = rows.value
    dense[np.diff(rows.start) == 0] = 1.0 / seen
    return dense.reshape(*kinds.shape, seen)
