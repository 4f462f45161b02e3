"""The samples that a test compares, and when they are too little to compare."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import msgspec
import numpy as np

from coadapt.arrays import FloatArray
from coadapt.errors import InputError


class CannotTest(InputError):
    """A test says nothing about these samples; the message says why."""


class Group(msgspec.Struct, frozen=True):
    """A sample in numbers.

    Attributes:
        name: of the group.
        n: number of values.
        mean, sd, median: of the values; ``sd`` is None of a single value.
    """

    name: str
    n: int
    mean: float
    sd: float | None
    median: float


class Samples:
    """Named samples of numbers.

    Args:
        values: by its name, each sample.
        fewest: number of values that each must have.

    Raises:
        CannotTest: if there are fewer than two samples, one is smaller than ``fewest``, or a value
            is no finite number.
    """

    def __init__(self, values: Mapping[str, Sequence[float]], fewest: int = 2) -> None:
        if len(values) < 2:
            raise CannotTest(f"needs at least 2 groups, found {len(values)}")
        self.names = tuple(values)
        self.arrays: tuple[FloatArray, ...] = tuple(
            np.asarray(sample, dtype=np.float64) for sample in values.values()
        )
        for name, array in zip(self.names, self.arrays, strict=True):
            if len(array) < fewest:
                raise CannotTest(f"needs at least {fewest} values a group, {name} has {len(array)}")
            if not np.isfinite(array).all():
                raise CannotTest(f"needs finite numbers, {name} has others")

    @property
    def total(self) -> int:
        """Number of all values."""
        return sum(len(array) for array in self.arrays)

    @property
    def pooled(self) -> FloatArray:
        """All values, sample after sample."""
        return np.concatenate(self.arrays)

    @property
    def groups(self) -> tuple[Group, ...]:
        """Each sample in numbers."""
        return tuple(map(describe, self.names, self.arrays))

    @property
    def constant(self) -> tuple[str, ...]:
        """Names of the samples whose values are all the same."""
        pairs = zip(self.names, self.arrays, strict=True)
        return tuple(name for name, array in pairs if np.ptp(array) == 0)

    def require_spread(self) -> None:
        """Raise CannotTest if all values are the same."""
        if np.ptp(self.pooled) == 0:
            raise CannotTest(f"all {self.total} values are {self.pooled[0]:g}: nothing differs")

    def require_spread_within(self) -> None:
        """Raise CannotTest if values differ in no sample."""
        if len(self.constant) == len(self.names):
            raise CannotTest("values differ in no group: there is no variance to compare with")

    def require_spread_in_each(self) -> None:
        """Raise CannotTest if values are the same in any sample."""
        if self.constant:
            raise CannotTest(
                f"all values of {', '.join(self.constant)} are the same: "
                "the variance of each group is needed, and is 0 there"
            )


def describe(name: str, values: FloatArray) -> Group:
    """A sample in numbers."""
    sd = float(np.std(values, ddof=1)) if len(values) > 1 else None
    return Group(name, len(values), float(np.mean(values)), sd, float(np.median(values)))


def standard_error(group: Group) -> float | None:
    """Of the mean; None of a single value."""
    return None if group.sd is None else group.sd / math.sqrt(group.n)
