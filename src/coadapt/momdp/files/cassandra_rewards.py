"""The rewards of a `.pomdp` file: ``R(a, s, s', o)``, and its expectation ``R(a, s)``.

The expectation is ``R(a, s) = sum_{s', o} T(s' | s, a) O(o | a, s') R(a, s, s', o)``. Only what can
happen is looked at. Entries are kept by which of their axes are fixed; for each combination the
latest entry is found by its key, and the latest of those found holds.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.errors import FileError
from coadapt.momdp.files.layered import WILD, steps
from coadapt.momdp.files.limits import MAX_ENTRIES
from coadapt.momdp.files.sparse_rows import SparseRows, expanded

MAX_CASES = 20_000_000
"""Combinations of state, successor and observation that the expectation is summed over, times the
kinds of entries that are looked up for each."""

CHUNK = 500_000
"""Combinations that are looked at together."""

NO_ENTRY = -1
"""Sequence number where no entry holds."""


@dataclass(frozen=True)
class _Layer:
    """Entries with the same fixed axes, by key in ascending order; the latest of equal keys."""

    axes: tuple[int, ...]
    key: IntArray
    order: IntArray
    value: FloatArray


@final
class _Single:
    """Entries of one number each, in the file's order."""

    def __init__(self) -> None:
        self.key, self.order, self.value = array("q"), array("q"), array("d")

    def add(self, key: int, order: int, value: float) -> None:
        """One more entry."""
        self.key.append(key)
        self.order.append(order)
        self.value.append(value)


@final
class RewardRules:
    """The entries of R.

    Args:
        path: the file, for error messages.
        sizes: numbers of actions, states, states, observations.
    """

    def __init__(self, path: object, sizes: tuple[int, int, int, int]) -> None:
        self._path = path
        self._sizes = sizes
        self._steps = steps(sizes)
        self._added: dict[tuple[int, ...], list[tuple[IntArray, int, FloatArray]]] = {}
        self._single: dict[tuple[int, ...], _Single] = {}
        self._count = 0
        self._cells = 0
        self._cases = 0
        if math.prod(sizes) > 2**62:
            raise FileError(path, None, f"found rewards for {sizes} cases, expected fewer")

    def add(self, line: int, given: list[int], values: FloatArray) -> None:
        """An entry: ``values`` along the axes after those ``given``.

        Raises:
            FileError: if there are too many.
        """
        axes = (*(i for i, s in enumerate(given) if s != WILD), *range(len(given), 4))
        base = sum(s * k for s, k in zip(given, self._steps, strict=False) if s != WILD)
        order = self._count
        self._count += 1
        self._cells += len(values)
        if self._cells > MAX_ENTRIES:
            raise FileError(
                self._path, line, f"found more than {MAX_ENTRIES:,} rewards, expected fewer"
            )
        if len(values) == 1 and len(given) == 4:
            self._single.setdefault(axes, _Single()).add(base, order, float(values[0]))
            return
        # The axes after those given are the last, so their linear index counts up by one.
        keys = base + np.arange(len(values), dtype=np.int64)
        self._added.setdefault(axes, []).append((keys, order, values))

    def expectation(
        self, moves: Callable[[int], SparseRows], sights: Callable[[int], SparseRows]
    ) -> FloatArray:
        """``[A, S]`` the expected reward.

        Args:
            moves: gives for each action the rows ``T(. | s, a)`` over s'.
            sights: gives for each action the rows ``O(. | a, s')`` over o.

        Raises:
            FileError: if there are too many cases, or the sum is too large for a number.
        """
        actions, states, _, _ = self._sizes
        layers = self._layers()
        common = [layer for layer in layers if 0 not in layer.axes]
        has_own = self._with_entries_of_their_own(layers)
        place = np.arange(states)
        with np.errstate(over="ignore", invalid="ignore"):
            # What there may be many of are actions of which nothing is said but of all together.
            reward = np.tile(self._lookup(common, (0, place, 0, 0), states), (actions, 1))
            if {2, 3}.isdisjoint(axis for layer in common for axis in layer.axes):
                special = np.flatnonzero(has_own)
            else:
                special = np.arange(actions)
            for a in map(int, special):
                own = [layer for layer in layers if self._has_action(layer, a)]
                needed = {axis for layer in own for axis in layer.axes}
                if 3 in needed:
                    reward[a] = self._by_observation(own, a, moves(a), sights(a))
                elif 2 in needed:
                    reward[a] = self._by_successor(own, a, moves(a))
                else:
                    reward[a] = self._lookup(own, (a, place, 0, 0), states)
        if not np.isfinite(reward).all():
            raise FileError(
                self._path, None, f"found rewards that sum to {reward.max()}, expected smaller ones"
            )
        return reward + 0.0  # no negative zeros

    def _by_successor(self, layers: list[_Layer], a: int, moves: SparseRows) -> FloatArray:
        self._spend(len(moves.index) * len(layers))
        total = np.zeros(self._sizes[1])
        source = moves.owner()
        for first in range(0, len(source), CHUNK):
            block = slice(first, first + CHUNK)
            s, s_next = source[block], moves.index[block]
            values = self._lookup(layers, (a, s, s_next, 0), len(s))
            total += np.bincount(s, weights=moves.value[block] * values, minlength=len(total))
        return total

    def _by_observation(
        self, layers: list[_Layer], a: int, moves: SparseRows, sights: SparseRows
    ) -> FloatArray:
        total = np.zeros(self._sizes[1])
        source = moves.owner()
        ends = np.cumsum(np.diff(sights.start)[moves.index])  # observations of the transitions
        self._spend(int(ends[-1]) * len(layers))
        first = 0
        while first < len(source):
            before = ends[first - 1] if first else 0
            last = max(first + 1, int(np.searchsorted(ends, before + CHUNK, side="right")))
            block = slice(first, last)
            which, place = expanded(sights.start, moves.index[block])
            s, s_next = source[block][which], moves.index[block][which]
            values = self._lookup(layers, (a, s, s_next, sights.index[place]), len(s))
            weight = moves.value[block][which] * sights.value[place]
            total += np.bincount(s, weights=weight * values, minlength=len(total))
            first = last
        return total

    def _spend(self, cases: int) -> None:
        self._cases += cases
        if self._cases > MAX_CASES:
            raise FileError(
                self._path,
                None,
                f"found rewards that differ in {self._cases:,} cases, "
                f"expected at most {MAX_CASES:,}",
            )

    def _lookup(
        self, layers: list[_Layer], place: tuple[int | IntArray, ...], count: int
    ) -> FloatArray:
        """``[count]`` the rewards at ``place``: action, state, successor, observation."""
        latest = np.full(count, NO_ENTRY, dtype=np.int64)
        value = np.zeros(count)
        for layer in layers:
            key = np.zeros(count, dtype=np.int64)
            for axis in layer.axes:
                key += self._steps[axis] * np.asarray(place[axis], dtype=np.int64)
            at = np.minimum(np.searchsorted(layer.key, key), len(layer.key) - 1)
            later = (layer.key[at] == key) & (layer.order[at] > latest)
            latest = np.where(later, layer.order[at], latest)
            value = np.where(later, layer.value[at], value)
        return value

    def _layers(self) -> list[_Layer]:
        layers: list[_Layer] = []
        for axes in {**self._added, **self._single}:
            single = self._single.get(axes, _Single())
            blocks = self._added.get(axes, [])
            key = np.concatenate(
                [np.array(single.key, dtype=np.int64), *(block[0] for block in blocks)]
            )
            order = np.concatenate(
                [
                    np.array(single.order, dtype=np.int64),
                    *(np.full(len(block[0]), block[1], dtype=np.int64) for block in blocks),
                ]
            )
            value = np.concatenate(
                [np.array(single.value, dtype=np.float64), *(block[2] for block in blocks)]
            )
            sequence = np.lexsort((order, key))
            key, order, value = key[sequence], order[sequence], value[sequence]
            kept = np.r_[key[1:] != key[:-1], True]
            layers.append(_Layer(axes, key[kept], order[kept], value[kept]))
        return layers

    def _with_entries_of_their_own(self, layers: list[_Layer]) -> BoolArray:
        """``[A]`` whether an entry names the action."""
        named = np.zeros(self._sizes[0], dtype=np.bool_)
        for layer in layers:
            if 0 in layer.axes:
                named[layer.key // self._steps[0]] = True
        return named

    def _has_action(self, layer: _Layer, a: int) -> bool:
        if 0 not in layer.axes:
            return True
        first, last = np.searchsorted(layer.key, [a * self._steps[0], (a + 1) * self._steps[0]])
        return bool(first < last)
