"""Fills the table of one variable from the entries or the decision diagram of a `.pomdpx` file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from coadapt.errors import FileError, excerpt
from coadapt.momdp.files.layered import ENUM, WILD, LayeredTable, Selectors
from coadapt.momdp.files.limits import MAX_REWARDS, check_size
from coadapt.momdp.files.pomdpx_diagram import read_diagram
from coadapt.momdp.files.pomdpx_variables import ACTION, OBSERVED, Axis, Variables
from coadapt.momdp.files.pomdpx_xml import RawTable
from coadapt.momdp.files.values import numbers, pieces, probabilities, read_numbers


@dataclass(frozen=True)
class Factor:
    """A table with the meaning of its axes.

    Attributes:
        line: where it begins.
        name: what it is about.
        axes: in the file's order; for a distribution the last is what it is about.
        outer, inner: the axes without and with a place in the slices. What it is about is inner.
        table: the numbers.
        names: the file's name of each axis.
    """

    line: int
    name: str
    axes: tuple[Axis, ...]
    outer: tuple[Axis, ...]
    inner: tuple[Axis, ...]
    table: LayeredTable
    names: tuple[str, ...]

    def describe(self, at: Selectors) -> str:
        """Names the place ``at`` of the table."""
        parts = [
            f"{name} = {axis.variable.names[value]}"
            for name, axis, value in zip(self.names, self.axes, at, strict=True)
            if value >= 0 and name != self.name
        ]
        return f"{self.name} given {', '.join(parts)}" if parts else self.name


def read_factor(
    path: object, raw: RawTable, variables: Variables, *, about: bool, initial: bool
) -> Factor:
    """The table ``raw``.

    Args:
        path: the file, for error messages.
        raw: the table as written.
        variables: the file's variables.
        about: whether the table is a distribution of its variable; otherwise it is a function of
            its parents.
        initial: whether it belongs to the initial belief, where all axes are inner.

    Raises:
        FileError: if a word or number is not what was expected.
    """
    names = [*(raw.parents or ()), *([raw.variable] if about else ())]
    axes: list[Axis] = []
    for name in names:
        if name not in variables.axes or name in names[: len(axes)]:
            raise FileError(
                path, raw.line, f"found parent {excerpt(name)}, expected a variable, once"
            )
        axes.append(variables.axes[name])
    is_outer = [
        axis.variable.group in (OBSERVED, ACTION)
        and not initial
        and not (about and i == len(axes) - 1)
        for i, axis in enumerate(axes)
    ]
    table = LayeredTable(path, [axis.variable.size for axis in axes], is_outer)
    if raw.diagram:
        read_diagram(path, raw, names, axes, table, probability=about)
    elif raw.roots:
        raise FileError(path, raw.line, "found a decision diagram, expected type='DD'")
    for line, instance, text in raw.entries:
        _read_entry(path, line, instance, text, axes, table, probability=about)
    return Factor(
        raw.line,
        raw.variable,
        tuple(axes),
        tuple(axis for axis, out in zip(axes, is_outer, strict=True) if out),
        tuple(axis for axis, out in zip(axes, is_outer, strict=True) if not out),
        table,
        tuple(names),
    )


def _read_entry(
    path: object,
    line: int,
    instance: str,
    text: str,
    axes: Sequence[Axis],
    table: LayeredTable,
    *,
    probability: bool,
) -> None:
    selectors = _selectors(path, line, instance, axes)
    word = text.strip()
    listed = [i for i, s in enumerate(selectors) if s == ENUM]
    if probability and word == "uniform":
        if selectors[-1] >= 0:
            raise FileError(
                path,
                line,
                f"found {excerpt(instance.rsplit(maxsplit=1)[-1])} before uniform, expected '-'",
            )
        anywhere: Selectors = tuple(WILD if s == ENUM else s for s in selectors)
        table.set(line, anywhere, np.array([1.0 / axes[-1].variable.size]))
        return
    if probability and word == "identity":
        sizes = {axes[i].variable.size for i in listed}
        if len(listed) != 2 or len(sizes) != 1 or listed[-1] != len(axes) - 1:
            raise FileError(
                path,
                line,
                f"found identity for {excerpt(' '.join(instance.split()))}, expected two '-' of "
                "the same number of values, the second of them last",
            )
        table.set_identity(line, selectors)
        return
    count = math.prod(axes[i].variable.size for i in listed)
    check_size(path, line, "numbers", (count,), MAX_REWARDS)
    read = probabilities if probability else numbers
    table.set(line, selectors, read_numbers(path, line, text, count, read))


def _selectors(path: object, line: int, instance: str, axes: Sequence[Axis]) -> Selectors:
    words = instance.split(None, len(axes))
    if len(words) != len(axes):
        found = sum(len(some) for some in pieces(instance))
        raise FileError(path, line, f"found {found} words in the instance, expected {len(axes)}")
    chosen: list[int] = []
    for word, axis in zip(words, axes, strict=True):
        index = axis.variable.index.get(word)
        if index is None:
            if word not in ("*", "-"):
                raise FileError(
                    path,
                    line,
                    f"found {excerpt(word)}, expected '*', '-' or a value such as "
                    f"{excerpt(axis.variable.names[0])}",
                )
            index = WILD if word == "*" else ENUM
        chosen.append(index)
    return tuple(chosen)
