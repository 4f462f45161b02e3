"""When one solver has reached the bounds of the other, and what follows for their speeds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

DIGITS = 6
"""Significant digits that the reference prints."""

CLOCK = 0.01
"""Seconds between two readings of the reference's clock."""


@dataclass(frozen=True)
class Point:
    """Bounds at a time.

    Attributes:
        seconds: since the search, with its initial bounds, began.
        lower, upper: bounds of the value.
    """

    seconds: float
    lower: float
    upper: float


@dataclass(frozen=True)
class Run:
    """What a solver did with a problem.

    Attributes:
        trace: bounds over time, at least one.
        finished: whether the gap came down to the one asked for.
        seconds: of solving, without reading the problem.
        load_seconds: of reading the problem.
        vectors: alpha vectors at the end.
        backups: backups at the end.
        memory_mb: most memory of the process, in MB of 2**20 bytes.
        status: why it stopped, in a word.
        cpu_seconds: of the whole process, reading and writing included.
        wall_seconds: from its beginning to its end.
    """

    trace: tuple[Point, ...]
    finished: bool
    seconds: float
    load_seconds: float
    vectors: int
    backups: int
    memory_mb: float | None
    status: str
    cpu_seconds: float
    wall_seconds: float

    @property
    def share(self) -> float:
        """Part of a processor that it had; clearly below 1 the machine was busy with others."""
        return self.cpu_seconds / self.wall_seconds


@dataclass(frozen=True)
class Time:
    """A time in seconds, or a limit to one.

    Attributes:
        seconds: the time.
        sign: ``""`` if it is that, ``">"`` if it is more, ``"<"`` if it is at most that.
    """

    seconds: float
    sign: str = ""

    def __str__(self) -> str:
        return f"{self.sign}{self.seconds:.3g}"


@dataclass(frozen=True)
class Ratio:
    """How many times as long the reference took, or with sign ``"<"`` the most it can be."""

    value: float
    sign: str = ""

    def __str__(self) -> str:
        return f"{self.sign}{self.value:.3g}"


@dataclass(frozen=True)
class Comparison:
    """Times to the same bounds.

    Attributes:
        lower, upper: the bounds to reach: the reference's last ones within its limit.
        reference: seconds the reference was given, or took where it finished.
        reference_lower, reference_upper: seconds until the reference had each bound first.
        ours_lower, ours_upper, ours: our seconds to each bound, and to both.
        ratio_lower, ratio_upper: reference's seconds to a bound by ours.
        ratio: ``reference`` by ``ours``.
        agree: whether the intervals of both solvers overlap, as they must.
    """

    lower: float
    upper: float
    reference: Time
    reference_lower: Time
    reference_upper: Time
    ours_lower: Time
    ours_upper: Time
    ours: Time
    ratio_lower: Ratio
    ratio_upper: Ratio
    ratio: Ratio
    agree: bool


def rounding(value: float) -> float:
    """How far a number printed with `DIGITS` digits may be from the number meant."""
    if value == 0.0 or not math.isfinite(value):
        return 0.0
    return 0.5 * 10.0 ** (math.floor(math.log10(abs(value))) - DIGITS + 1)


def within(trace: Sequence[Point], seconds: float) -> Point:
    """The last point of ``trace`` up to ``seconds``; the first of all if it is later."""
    return [point for point in trace if point.seconds <= seconds or point is trace[0]][-1]


def first(trace: Sequence[Point], *, lower: float | None, upper: float | None) -> float | None:
    """Seconds until ``trace`` has at least ``lower`` and at most ``upper``; None if never."""
    for point in trace:
        high_enough = lower is None or point.lower >= lower - rounding(lower)
        low_enough = upper is None or point.upper <= upper + rounding(upper)
        if high_enough and low_enough:
            return point.seconds
    return None


def compare(reference: Run, ours: Run, limit: float, our_limit: float) -> Comparison:
    """Set ``ours`` beside ``reference``.

    Args:
        reference: the run whose bounds are to be reached.
        ours: the run that is to reach them.
        limit: seconds the reference counts for; what it does after them is left out.
        our_limit: seconds we were given.
    """
    last = within(reference.trace, limit)
    finished = reference.finished and last.seconds == reference.seconds
    theirs = _at_clock(last.seconds if finished else max(last.seconds, limit), reference)
    end = ours.seconds if ours.finished else None

    def reference_time(**bounds: float | None) -> Time:
        return _at_clock(first(reference.trace, **bounds) or 0.0, reference)

    def our_time(**bounds: float | None) -> Time:
        reached = first(ours.trace, **bounds)
        if reached is None and finished:
            reached = end  # nobody was asked for more than the gap
        return Time(our_limit, ">") if reached is None else Time(reached)

    both = our_time(lower=last.lower, upper=last.upper)
    if finished:
        both = Time(our_limit, ">") if end is None else Time(end)
    lower = {"lower": last.lower, "upper": None}
    upper = {"lower": None, "upper": last.upper}
    final = ours.trace[-1]
    return Comparison(
        lower=last.lower,
        upper=last.upper,
        reference=theirs,
        reference_lower=reference_time(**lower),
        reference_upper=reference_time(**upper),
        ours_lower=our_time(**lower),
        ours_upper=our_time(**upper),
        ours=both,
        ratio_lower=_ratio(reference_time(**lower), our_time(**lower)),
        ratio_upper=_ratio(reference_time(**upper), our_time(**upper)),
        ratio=_ratio(theirs, both),
        agree=final.lower <= last.upper + rounding(last.upper)
        and last.lower - rounding(last.lower) <= final.upper,
    )


def geometric_mean(ratios: Iterable[Ratio]) -> Ratio:
    """The geometric mean; with the sign ``"<"`` if one of ``ratios`` has it."""
    known = list(ratios)
    mean = math.exp(sum(math.log(ratio.value) for ratio in known) / len(known))
    return Ratio(mean, "<" if any(ratio.sign for ratio in known) else "")


def _at_clock(seconds: float, run: Run) -> Time:
    """``seconds`` by the reference's clock, which cannot tell times below its step."""
    if seconds >= CLOCK:
        return Time(seconds)
    return Time(min(CLOCK, run.cpu_seconds), "<")


def _ratio(theirs: Time, ours: Time) -> Ratio:
    value = theirs.seconds / max(ours.seconds, 1e-6)
    return Ratio(value, "<" if theirs.sign == "<" or ours.sign == ">" else "")
