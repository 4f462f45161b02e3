"""Declared hypotheses put to their tests."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations
from typing import Literal

import msgspec

from coadapt.analysis import tests
from coadapt.analysis.measures import PersonMeasures
from coadapt.analysis.tests import CannotTest, Found, NotTested, TestResult
from coadapt.hypotheses import HOLDS_FAMILY, PERFORMANCE, SWITCHED, Hypothesis

Direction = Literal["as expected", "against it", "equal", "unknown"]

Verdict = Literal["supported", "partly supported", "not supported", "not tested"]

Values = Mapping[str, Sequence[float]]

NAMES = {
    "kruskal_wallis": "Kruskal-Wallis",
    "anova": "one-way ANOVA",
    "welch": "Welch's ANOVA",
    "proportions": "test of proportions",
    "mann_whitney": "Mann-Whitney",
    "tukey": "Tukey's HSD",
    "games_howell": "Games-Howell",
    "fisher": "Fisher's exact test",
}


class Pair(msgspec.Struct, frozen=True, kw_only=True):
    """Two conditions compared.

    Attributes:
        higher, lower: which is expected to be higher than which.
        declared: whether the hypothesis is about this pair.
        direction: of the difference found.
        found: the test.
        holds: whether the difference is significant and as expected.
        equivalence: the test of equivalence, where one was declared and there is no significant
            difference.
    """

    higher: str
    lower: str
    declared: bool
    direction: Direction
    found: Found
    holds: bool
    equivalence: Found | None = None


class Tested(msgspec.Struct, frozen=True, kw_only=True):
    """A hypothesis put to its test on one outcome.

    Attributes:
        hypothesis: its name.
        outcome: which.
        overall: the test of all conditions.
        pairs: those compared.
        sensitivity: other tests of the same question, by what they do not assume.
        missing: by condition, how many participants have no value.
        verdict: what became of the hypothesis; "supported" takes a significant test of all
            conditions
            and every declared pair significant and as expected.
    """

    hypothesis: str
    outcome: str
    overall: Found
    pairs: tuple[Pair, ...]
    sensitivity: tuple[Found, ...]
    missing: dict[str, int]
    verdict: Verdict


def put_to_test(hypothesis: Hypothesis, people: Sequence[PersonMeasures]) -> tuple[Tested, ...]:
    """The declared tests of a hypothesis, an entry for each outcome."""
    return tuple(_tested(hypothesis, outcome, people) for outcome in hypothesis.outcomes)


def value_of(person: PersonMeasures, outcome: str) -> float | None:
    """A participant's outcome; None if they have none."""
    if outcome == PERFORMANCE:
        return person.performance
    if outcome == SWITCHED:
        return None if person.switched is None else float(person.switched)
    return person.scores.get(outcome)


def _tested(hypothesis: Hypothesis, outcome: str, people: Sequence[PersonMeasures]) -> Tested:
    values: dict[str, list[float]] = {}
    missing: dict[str, int] = {}
    for condition in hypothesis.order:
        given = [value_of(p, outcome) for p in people if p.condition == condition]
        values[condition] = [value for value in given if value is not None]
        missing[condition] = len(given) - len(values[condition])
    overall = _overall(hypothesis, values)
    pairs = _pairs(hypothesis, values)
    return Tested(
        hypothesis=hypothesis.name,
        outcome=outcome,
        overall=overall,
        pairs=pairs,
        sensitivity=_sensitivity(hypothesis, outcome, values),
        missing={name: count for name, count in missing.items() if count},
        verdict=_verdict(hypothesis, overall, pairs),
    )


def run(name: str, groups: Sequence[str], test: Callable[[], TestResult]) -> Found:
    """The result of a test, or why there is none."""
    try:
        return test()
    except CannotTest as reason:
        return NotTested(test=name, groups=tuple(groups), reason=f"{reason}")


def _counts(values: Values) -> dict[str, tuple[int, int]]:
    return {name: (int(sum(given)), len(given)) for name, given in values.items()}


def _overall(hypothesis: Hypothesis, values: Values) -> Found:
    by_name: dict[str, Callable[[], TestResult]] = {
        "kruskal_wallis": lambda: tests.kruskal_wallis(values),
        "anova": lambda: tests.one_way_anova(values),
        "welch": lambda: tests.welch_anova(values),
        "proportions": lambda: tests.proportions(_counts(values)),
    }
    return run(NAMES[hypothesis.test], hypothesis.order, by_name[hypothesis.test])


def _pairs(hypothesis: Hypothesis, values: Values) -> tuple[Pair, ...]:
    declared = set(hypothesis.compared)
    if hypothesis.pairs in HOLDS_FAMILY:
        compared = list(combinations(hypothesis.order, 2))
        found = _family(hypothesis, values, compared)
    else:
        compared = list(hypothesis.compared)
        single = tests.mann_whitney if hypothesis.pairs == "mann_whitney" else _fisher
        results = [_single(hypothesis, {n: values[n] for n in pair}, single) for pair in compared]
        found = tests.correct(results, hypothesis.correction)
    return tuple(
        _pair(hypothesis, values, pair, result, declared=pair in declared)
        for pair, result in zip(compared, found, strict=True)
    )


def _single(hypothesis: Hypothesis, two: Values, test: Callable[[Values], TestResult]) -> Found:
    return run(NAMES[hypothesis.pairs], tuple(two), lambda: test(two))


def _fisher(two: Values) -> TestResult:
    return tests.proportions(_counts(two))


def _family(
    hypothesis: Hypothesis, values: Values, compared: Sequence[tuple[str, str]]
) -> tuple[Found, ...]:
    test = tests.tukey if hypothesis.pairs == "tukey" else tests.games_howell
    try:
        return test(values)
    except CannotTest as reason:
        name = NAMES[hypothesis.pairs]
        return tuple(NotTested(test=name, groups=pair, reason=f"{reason}") for pair in compared)


def _pair(
    hypothesis: Hypothesis,
    values: Values,
    pair: tuple[str, str],
    found: Found,
    *,
    declared: bool,
) -> Pair:
    higher, lower = pair
    significant = isinstance(found, TestResult) and found.adjusted < hypothesis.level
    direction = _direction(found)
    equivalence, bound = None, hypothesis.equivalence
    if bound is not None and not significant and hypothesis.test != "proportions":
        two = {name: values[name] for name in pair}
        equivalence = run("equivalence", pair, lambda: tests.equivalence(two, bound))
    return Pair(
        higher=higher,
        lower=lower,
        declared=declared,
        direction=direction,
        found=found,
        holds=significant and direction == "as expected",
        equivalence=equivalence,
    )


def _direction(found: Found) -> Direction:
    """Of the main effect, which is first minus second in every test of pairs."""
    if isinstance(found, NotTested):
        return "unknown"
    apart = found.effects[0].value
    return "equal" if apart == 0 else "as expected" if apart > 0 else "against it"


def _sensitivity(hypothesis: Hypothesis, outcome: str, values: Values) -> tuple[Found, ...]:
    """Tests of the same question that assume other things than the declared one."""
    if hypothesis.test == "proportions":
        return ()
    by_name: dict[str, Callable[[], TestResult]] = {
        "Kruskal-Wallis": lambda: tests.kruskal_wallis(values),
        "one-way ANOVA": lambda: tests.one_way_anova(values),
        "Welch's ANOVA": lambda: tests.welch_anova(values),
    }
    if outcome != PERFORMANCE:
        by_name["cumulative logit"] = lambda: tests.cumulative_logit(values)
    return tuple(
        run(name, hypothesis.order, test)
        for name, test in by_name.items()
        if name != NAMES[hypothesis.test]
    )


def _verdict(hypothesis: Hypothesis, overall: Found, pairs: Sequence[Pair]) -> Verdict:
    declared = [pair for pair in pairs if pair.declared]
    if isinstance(overall, NotTested):
        return "not tested"
    if overall.p >= hypothesis.level:
        return "not supported"
    if all(pair.holds for pair in declared):
        return "supported"
    return "partly supported" if any(pair.holds for pair in declared) else "not supported"
