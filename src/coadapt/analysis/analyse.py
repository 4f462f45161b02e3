"""A whole analysis: measures, scales, the declared tests, and whether they are the declared
ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

import msgspec
import numpy as np

from coadapt.analysis.data import StudyData
from coadapt.analysis.measures import (
    PersonMeasures,
    TrialMeasures,
    person_measures,
    reliabilities,
    trial_measures,
)
from coadapt.analysis.scales import Reliability
from coadapt.analysis.tests import CannotTest, Found, Group, NotTested, proportions, versions
from coadapt.analysis.tests.power import smallest_effect
from coadapt.analysis.tests.samples import describe
from coadapt.analysis.verdicts import Tested, put_to_test, run
from coadapt.hypotheses import Hypothesis, published

PAPER_CONDITIONS = ("no_adaptation", "mutual_adaptation", "one_way_adaptation")

FORMAT = 1
"""Version of the JSON form of an analysis."""


class Plan(msgspec.Struct, frozen=True, kw_only=True):
    """The hypotheses tested, and whether they are those declared before data existed.

    Attributes:
        status: "declared": they come from the study's file, whose hash is the one stored with the
            data; "changed": that hash is another; "unchecked": no hash is stored with the data;
            "published": nothing was declared, H1 and H2 of the paper are tested; "none": there is
            nothing to test.
        text: the same as a sentence.
        file, sha256: of the declaration.
        stored_sha256: of the protocol that is stored with the data.
        hypotheses: what is tested.
    """

    status: Literal["declared", "changed", "unchecked", "published", "none"]
    text: str
    file: str
    sha256: str
    stored_sha256: str
    hypotheses: tuple[Hypothesis, ...]


class Summary(msgspec.Struct, frozen=True, kw_only=True):
    """A measure by condition.

    Attributes:
        measure: its name.
        groups: for each condition in which anybody has a value.
    """

    measure: str
    groups: tuple[Group, ...]


class Exploratory(msgspec.Struct, frozen=True, kw_only=True):
    """A test that nobody declared."""

    question: str
    found: Found


class Analysis(msgspec.Struct, frozen=True, kw_only=True):
    """What the data of a study say.

    Attributes:
        data: they.
        plan: what is tested, and whether it was declared.
        trials, people: measures.
        summaries: measures by condition.
        scales: how well their items go together.
        tested: the hypotheses.
        exploratory: tests beyond them.
        detectable: smallest η² that these group sizes find with a power of 80 %; None if unknown.
        deviations: from what was planned.
        versions: of the programs.
    """

    data: StudyData
    plan: Plan
    trials: tuple[TrialMeasures, ...]
    people: tuple[PersonMeasures, ...]
    summaries: tuple[Summary, ...]
    scales: tuple[Reliability, ...]
    tested: tuple[Tested, ...]
    exploratory: tuple[Exploratory, ...]
    detectable: float | None
    deviations: tuple[str, ...]
    versions: dict[str, str]


def analyse(data: StudyData) -> Analysis:
    """Analyse the data of a study."""
    trials = trial_measures(data)
    people = person_measures(data, trials)
    plan = plan_of(data)
    tested = tuple(t for h in plan.hypotheses for t in put_to_test(h, people))
    return Analysis(
        data=data,
        plan=plan,
        trials=trials,
        people=people,
        summaries=_summaries(data, people),
        scales=reliabilities(data),
        tested=tested,
        exploratory=_exploratory(data, people),
        detectable=_detectable(data),
        deviations=deviations_of(data, plan, tested),
        versions=dict(versions()),
    )


def plan_of(data: StudyData) -> Plan:
    """What is tested, and whether it is what was declared."""
    hypotheses = data.declared.hypotheses
    if hypotheses and not data.stored_sha256:
        status = "unchecked"
        text = (
            f"The hypotheses are those of {data.declared_in}. No hash of a protocol is stored with "
            "these data, so whether they were declared before data existed cannot be checked."
        )
    elif hypotheses and data.declared_sha256 == data.stored_sha256:
        status = "declared"
        text = (
            "The analysis is the declared one: hypotheses and tests come from the study’s "
            "protocol, and its SHA-256 is the one stored with the data."
        )
    elif hypotheses:
        status = "changed"
        text = (
            f"The analysis is not the declared one: the SHA-256 of {data.declared_in} is another "
            "than that of the protocol stored with the data."
        )
    elif set(PAPER_CONDITIONS) <= set(data.conditions):
        status = "published"
        hypotheses = tuple(h for h in published(*PAPER_CONDITIONS) if _has_data(data, h))
        names = " and ".join(h.name for h in hypotheses)
        text = (
            f"No hypotheses were declared with these data. Tested: {names} of Nikolaidis et al. "
            "(2017), as in the paper."
        )
    else:
        status = "none"
        text = "No hypotheses were declared with these data, and the conditions are others."
    return Plan(
        status=status,
        text=text,
        file=data.declared_in,
        sha256=data.declared_sha256,
        stored_sha256=data.stored_sha256,
        hypotheses=hypotheses,
    )


def _has_data(data: StudyData, hypothesis: Hypothesis) -> bool:
    """Whether the data have any outcome of a published hypothesis."""
    scales = {scale.name for scale in data.declared.scales}
    return bool(set(hypothesis.outcomes) & ({"performance", "switched"} | scales))


MEASURES: dict[str, Callable[[PersonMeasures], float | None]] = {
    "performance": lambda p: p.performance,
    "optimal trials": lambda p: p.optimal_trials,
    "steps per trial": lambda p: p.steps,
    "seconds per trial": lambda p: p.seconds,
    "inputs per trial": lambda p: p.inputs,
    "disagreements per trial": lambda p: p.disagreements,
    "disagreement cost per trial": lambda p: p.cost,
    "posterior adaptability": lambda p: p.alpha,
}
"""What is summarised by condition, beside the scales."""


def _summaries(data: StudyData, people: Sequence[PersonMeasures]) -> tuple[Summary, ...]:
    measures = dict(MEASURES)
    for scale in data.declared.scales:
        measures[scale.name] = lambda p, name=scale.name: p.scores.get(name)
    found: list[Summary] = []
    for name, of in measures.items():
        groups: list[Group] = []
        for condition in data.conditions:
            values = [of(person) for person in people if person.condition == condition]
            given = [value for value in values if value is not None]
            if given:
                groups.append(describe(condition, np.array(given, dtype=np.float64)))
        if groups:
            found.append(Summary(measure=name, groups=tuple(groups)))
    return tuple(found)


def _exploratory(data: StudyData, people: Sequence[PersonMeasures]) -> tuple[Exploratory, ...]:
    questions: dict[str, Callable[[PersonMeasures], bool | None]] = {
        "How many reached the optimal goal at least once": lambda p: (
            None if p.optimal_trials is None else p.optimal_trials > 0
        ),
        "How many switched to another goal than the one chosen at first": lambda p: p.switched,
    }
    found: list[Exploratory] = []
    for question, of in questions.items():
        counts: dict[str, tuple[int, int]] = {}
        for condition in data.conditions:
            values = [of(person) for person in people if person.condition == condition]
            given = [value for value in values if value is not None]
            if given:
                counts[condition] = sum(given), len(given)
        if len(counts) > 1:
            tested = run("test of proportions", tuple(counts), lambda c=counts: proportions(c))
            found.append(Exploratory(question=question, found=tested))
    return tuple(found)


def _detectable(data: StudyData) -> float | None:
    try:
        return smallest_effect([len(data.of(name)) for name in data.conditions])
    except CannotTest:
        return None


def deviations_of(data: StudyData, plan: Plan, tested: Sequence[Tested]) -> tuple[str, ...]:
    """Where the analysis is another than planned, a sentence each."""
    found: list[str] = []
    if plan.status in ("changed", "published"):
        found.append(plan.text)
    dropped = [h for h in published(*PAPER_CONDITIONS) if h not in plan.hypotheses]
    for hypothesis in dropped if plan.status == "published" else ():
        outcomes = " and ".join(hypothesis.outcomes)
        found.append(f"{hypothesis.name} is not tested: the data hold no {outcomes}.")
    for condition in data.declared.conditions:
        have = data.flow.analysed.get(condition.name, 0)
        if condition.quota is not None and have != condition.quota:
            found.append(f"{condition.name}: {condition.quota} planned, {have} analysed.")
    for t in tested:
        for one in (t.overall, *(pair.found for pair in t.pairs)):
            if isinstance(one, NotTested):
                found.append(f"{t.hypothesis}, {t.outcome}: {one.sentence}")
        if t.missing:
            counts = ", ".join(f"{count} in {name}" for name, count in t.missing.items())
            found.append(f"{t.hypothesis}, {t.outcome}: without a value and left out: {counts}.")
    if data.flow.simulated:
        found.append(
            f"{data.flow.simulated} of the participants analysed are programs, not people."
        )
    return tuple(found)
