"""Values of a grid: one, a list of them, or a range."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import cast

import msgspec

from coadapt.requirements import FieldError

MOST_VALUES = 100_000

DIGITS = 12
"""Significant digits of the values of a range, so that they are those one would write by hand."""


class Range(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Numbers at equal distances, both ends among them.

    Attributes:
        first: the first (``from`` in files).
        to: the last.
        count: how many, at least 2.

    Raises:
        FieldError: if there are too few or too many.
    """

    first: float = msgspec.field(name="from")
    to: float
    count: int

    def __post_init__(self) -> None:
        if not 2 <= self.count <= MOST_VALUES:
            raise FieldError(("count",), f"must be from 2 to {MOST_VALUES:,}, not {self.count:,}")

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers, each rounded to `DIGITS` significant digits."""
        step = (self.to - self.first) / (self.count - 1)
        inner = [self.first + i * step for i in range(1, self.count - 1)]
        return tuple(plain(x) for x in (self.first, *inner, self.to))


Numbers = float | tuple[float, ...] | Range
"""What a grid may give for a number."""

Counts = int | tuple[int, ...]
"""What a grid may give for a whole number."""


def plain(x: float) -> float:
    """``x`` to `DIGITS` significant digits; 0 without a sign."""
    return float(f"{x:.{DIGITS}g}") + 0.0


def alternatives(given: object) -> tuple[object, ...]:
    """The values that a grid gives for one parameter, as a tuple.

    A list holds one value each, a table with ``from``, ``to`` and ``count`` is a `Range`, any other
    table all combinations of what it holds.

    Raises:
        FieldError: if there is none.
    """
    if isinstance(given, Range):
        return given.values
    if isinstance(given, Mapping):
        table = cast("Mapping[str, object]", given)
        if set(table) == {"from", "to", "count"}:
            return msgspec.convert(table, Range).values
        return tuple(combinations(table))
    found = tuple(given) if isinstance(given, list | tuple) else (given,)  # pyright: ignore
    if not found:
        raise FieldError((), "is an empty list, expected at least one value")
    return found  # pyright: ignore[reportUnknownVariableType]


def combinations(given: Mapping[str, object]) -> list[dict[str, object]]:
    """Every combination of the values of a mapping; the last key varies fastest.

    Raises:
        FieldError: if one of the keys has no value.
    """
    axes: list[tuple[object, ...]] = []
    for name, value in given.items():
        try:
            axes.append(alternatives(value))
        except FieldError as error:
            raise FieldError((name, *error.key), error.problem) from error
    return [dict(zip(given, values, strict=True)) for values in product(*axes)]
