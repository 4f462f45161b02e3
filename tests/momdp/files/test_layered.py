"""Layered tables against plain arrays that are assigned to in the same order."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.errors import InputError
from coadapt.momdp.files import layered
from coadapt.momdp.files.layered import ENUM, WILD, LayeredTable


@st.composite
def entries(draw: st.DrawFn) -> tuple[tuple[int, ...], tuple[bool, ...], list[tuple[int, ...]]]:
    axes = draw(st.integers(1, 4))
    sizes = tuple(draw(st.lists(st.integers(1, 3), min_size=axes, max_size=axes)))
    outer = tuple(draw(st.lists(st.booleans(), min_size=axes, max_size=axes)))
    one = st.tuples(*(st.sampled_from((WILD, ENUM, *range(size))) for size in sizes))
    return sizes, outer, draw(st.lists(one, max_size=6))


@given(entries(), st.integers(0, 2**32))
def test_last_entry_wins(
    case: tuple[tuple[int, ...], tuple[bool, ...], list[tuple[int, ...]]], seed: int
) -> None:
    sizes, outer, chosen = case
    rng = np.random.default_rng(seed)
    table = LayeredTable("file", sizes, outer)
    dense = np.zeros(sizes)
    for line, selectors in enumerate(chosen, 1):
        listed = [i for i, s in enumerate(selectors) if s == ENUM]
        shape = [sizes[i] for i in listed]
        # Two in five values are 0, so that entries also delete.
        values = rng.integers(0, 5, size=shape) * (rng.random(shape) > 0.3) * 1.0
        last_inner = listed and not outer[listed[-1]] and rng.random() < 0.5
        if len(shape) == 2 and shape[0] == shape[1] and last_inner:
            values = np.eye(shape[0])
            table.set_identity(line, selectors)
        else:
            table.set(line, selectors, values.ravel())
        place = tuple(slice(None) if s < 0 else s for s in selectors)
        # Of the axes that remain after indexing, values vary along those listed.
        width = [sizes[i] if s == ENUM else 1 for i, s in enumerate(selectors) if s < 0]
        dense[place] = values.reshape(width)
    slices = table.slices()
    for index in itertools.product(*(range(size) for size in sizes)):
        cell, inner = linear(index, sizes, outer, True), linear(index, sizes, outer, False)
        number = int(slices.at(np.array([cell]))[0])
        part = slice(slices.start[number], slices.start[number + 1])
        found = slices.value[part][slices.index[part] == inner]
        assert found.tolist() == ([dense[index]] if dense[index] else [])


def linear(
    index: tuple[int, ...], sizes: tuple[int, ...], outer: tuple[bool, ...], which: bool
) -> int:
    """The place of ``index`` among the combinations of the outer, or of the inner axes."""
    place = 0
    for i, size, is_outer in zip(index, sizes, outer, strict=True):
        if is_outer == which:
            place = place * size + i
    return place


def test_equal_slices_are_kept_once() -> None:
    # Two of the three cells get the identity in different words.
    table = LayeredTable("file", (3, 2, 2), (True, False, False))
    table.set_identity(1, (0, ENUM, ENUM))
    table.set(2, (2, ENUM, ENUM), np.array([1.0, 0, 0, 1]))
    slices = table.slices()
    assert slices.at(np.arange(3)).tolist() == [1, 0, 1]
    assert slices.count == 2


def test_place_and_line_of_an_entry() -> None:
    table = LayeredTable("file", (2, 3, 2), (True, False, False))
    table.set(5, (WILD, 1, ENUM), np.array([0.5, 0.5]))
    table.set(9, (1, 1, 0), np.array([0.25]))
    assert table.place(1, 3) == (1, 1, 1)
    assert table.line_of((0, 1, WILD)) == 5
    assert table.line_of((1, 1, WILD)) == 9
    assert table.line_of((1, 0, WILD)) is None


def test_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(layered, "MAX_CELLS", 100)
    table = LayeredTable("file", (10, 9, 2), (True, True, False))
    table.set(1, (WILD, WILD, 0), np.array([0.5]))
    with pytest.raises(InputError, match="file:2: found wildcards"):
        table.set(2, (WILD, WILD, 1), np.array([0.5]))
    monkeypatch.setattr(layered, "MAX_ENTRIES", 20)
    table = LayeredTable("file", (2, 9, 2), (True, False, False))
    table.set(1, (0, WILD, ENUM), np.array([0.5, 0.5]))
    with pytest.raises(InputError, match="file:2: found a table"):
        table.set(2, (1, WILD, ENUM), np.array([0.25, 0.75]))
