"""What a test found: numbers, what they rest on, and a sentence for the paper."""

from __future__ import annotations

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version

import msgspec

from coadapt.analysis.tests.samples import Group

LEVEL = 0.95
"""Confidence level of intervals."""


class Effect(msgspec.Struct, frozen=True, kw_only=True):
    """The size of an effect.

    Attributes:
        name: what it is called, for example "ε²".
        value: the estimate.
        low, high: its confidence interval.
        level: of the interval.
        method: how the interval was found.
    """

    name: str
    value: float
    low: float
    high: float
    level: float = LEVEL
    method: str


class Check(msgspec.Struct, frozen=True, kw_only=True):
    """An assumption that was looked at.

    Attributes:
        assumption: what is assumed.
        method: how it was looked at.
        statistic, p: of a test of it, if there was one.
        holds: whether nothing speaks against it; None where that cannot be said.
        note: what else there is to say.
    """

    assumption: str
    method: str
    statistic: float | None = None
    p: float | None = None
    holds: bool | None = None
    note: str = ""


class TestResult(msgspec.Struct, frozen=True, kw_only=True):
    """What a test found.

    Attributes:
        test: its name.
        groups: the samples compared.
        symbol: of the statistic, for example "H".
        statistic: its value.
        df: its degrees of freedom, none where there are none.
        p: without any correction.
        comparisons: how many comparisons ``adjusted`` counts, 1 for none.
        correction: for several comparisons: "none", "bonferroni", "holm" or "studentised range".
        adjusted: p after the correction.
        effects: sizes of the effect, the main one first.
        assumptions: what was looked at.
        details: other numbers by their names.
        notes: what a reader must know.
        versions: of the programs that computed it.
        sentence: in the style of the APA.
    """

    test: str
    groups: tuple[Group, ...]
    symbol: str
    statistic: float
    df: tuple[float, ...] = ()
    p: float
    comparisons: int = 1
    correction: str = "none"
    adjusted: float
    effects: tuple[Effect, ...] = ()
    assumptions: tuple[Check, ...] = ()
    details: dict[str, float] = {}
    notes: tuple[str, ...] = ()
    versions: dict[str, str] = msgspec.field(default_factory=lambda: dict(versions()))
    sentence: str

    __test__ = False  # pytest collects classes by this name

    @property
    def names(self) -> tuple[str, ...]:
        """The groups compared."""
        return tuple(group.name for group in self.groups)


class NotTested(msgspec.Struct, frozen=True, kw_only=True):
    """A test that says nothing about the data at hand.

    Attributes:
        test: its name.
        groups: names of the samples.
        reason: why.
    """

    test: str
    groups: tuple[str, ...]
    reason: str

    @property
    def sentence(self) -> str:
        """What is said instead of a result."""
        return f"{self.test} of {', '.join(self.groups)}: not computed, {self.reason}."


Found = TestResult | NotTested
"""What became of a test."""


@cache
def versions() -> tuple[tuple[str, str], ...]:
    """The programs that numbers may depend on, with their versions."""
    found = [("python", platform.python_version())]
    for name in ("coadapt", "numpy", "scipy", "statsmodels"):
        try:
            found.append((name, version(name)))
        except PackageNotFoundError:
            found.append((name, "not installed"))
    return tuple(found)
