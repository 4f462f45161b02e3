"""Measures of each trial and participant (Sec. 7.1).

Team performance is the mean reward over all trials of the protocol. Who lacks one has no
performance.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import msgspec
import numpy as np

from coadapt.analysis.data import Person, StudyData, Trial
from coadapt.analysis.scales import Reliability, reliability, scores, turned
from coadapt.arrays import FloatArray

PAPER_COST = -0.32
"""``C`` of Eq. 8 (Sec. 6.5), taken where the data do not say that of the robots."""

LIKELIER = 0.5
"""Belief above which a goal is the likelier of two."""


class TrialMeasures(msgspec.Struct, frozen=True, kw_only=True):
    """A trial in numbers; None where the data do not say.

    Attributes:
        participant, condition, trial: which.
        goal, optimal, reward, switched, steps, seconds, inputs, disagreements, matched: see
        `Trial`. switch_step: the step, from 0, from which on the robot held that the participant
        wanted the goal
            it holds to be better, in trials in which they switched.
        expected_disagreement: sum over the steps of the probability that both wanted different
            goals. cost: that times `disagreement_cost`. alpha: mean of the robot's belief over
            adaptability at the end; None of robots that infer none.
    """

    participant: str
    condition: str
    trial: int
    goal: str | None
    optimal: bool | None
    reward: float | None
    switched: bool | None
    switch_step: int | None
    steps: int | None
    seconds: float | None
    inputs: int | None
    disagreements: int | None
    matched: int | None
    expected_disagreement: float | None
    cost: float | None
    alpha: float | None


class PersonMeasures(msgspec.Struct, frozen=True, kw_only=True):
    """A participant in numbers; None where the data do not say.

    Attributes:
        participant, condition: who.
        trials: number of trials finished.
        performance: mean reward of all trials.
        optimal_trials: how many ended at the optimal goal.
        switched, switch_trial: whether they went for the other goal in any trial, and in which
        first. steps, seconds, inputs, disagreements, cost: means over the trials. alpha: mean of
        the robot's belief over adaptability at the end of the last trial. scores: of the scales.
        checks_failed: attention checks answered otherwise than asked for.
    """

    participant: str
    condition: str
    trials: int
    performance: float | None
    optimal_trials: int | None
    switched: bool | None
    switch_trial: int | None
    steps: float | None
    seconds: float | None
    inputs: float | None
    disagreements: float | None
    cost: float | None
    alpha: float | None
    scores: dict[str, float | None]
    checks_failed: int


def disagreement_cost(data: StudyData) -> float:
    """``C`` of Eq. 8, which makes the expected disagreement of a trial a cost."""
    return PAPER_COST if data.disagreement_cost is None else data.disagreement_cost


def trial_measures(data: StudyData) -> tuple[TrialMeasures, ...]:
    """Every finished trial in numbers."""
    return tuple(
        _trial(person, trial, data.adaptability, disagreement_cost(data))
        for person in data.people
        for trial in person.trials
    )


def person_measures(data: StudyData, trials: Sequence[TrialMeasures]) -> tuple[PersonMeasures, ...]:
    """Every participant in numbers.

    Args:
        data: of the study.
        trials: of `trial_measures`.
    """
    by_person: dict[str, list[TrialMeasures]] = {person.name: [] for person in data.people}
    for trial in trials:
        by_person[trial.participant].append(trial)
    scored = scale_scores(data)
    return tuple(
        _person(person, by_person[person.name], data.declared.trials, scored[person.name])
        for person in data.people
    )


def rating_matrices(data: StudyData) -> dict[str, FloatArray]:
    """By scale, all ratings, reversed items turned round.  # [participants, items]"""
    found: dict[str, FloatArray] = {}
    for scale in data.declared.scales:
        rows = [
            [float(person.ratings.get(item.name, np.nan)) for item in scale.rated]
            for person in data.people
        ]
        is_reversed = [item.reversed for item in scale.rated]
        matrix = np.array(rows, dtype=np.float64).reshape(len(rows), len(scale.rated))
        if matrix.size and np.isfinite(matrix).any():
            found[scale.name] = turned(matrix, is_reversed, len(scale.points))
    return found


def scale_scores(data: StudyData) -> dict[str, dict[str, float | None]]:
    """By participant and scale, the score; None if too few items were answered."""
    found: dict[str, dict[str, float | None]] = {person.name: {} for person in data.people}
    for name, matrix in rating_matrices(data).items():
        for person, score in zip(data.people, scores(matrix), strict=True):
            found[person.name][name] = float(score) if np.isfinite(score) else None
    return found


def reliabilities(data: StudyData) -> tuple[Reliability, ...]:
    """How well the items of each scale go together, over all conditions."""
    matrices = rating_matrices(data)
    return tuple(
        reliability(
            scale.name,
            [item.name for item in scale.rated],
            matrices[scale.name],
            len(scale.points),
        )
        for scale in data.declared.scales
        if scale.name in matrices
    )


def _trial(
    person: Person, trial: Trial, alphas: Sequence[float], unit_cost: float
) -> TrialMeasures:
    disagreement = [s.disagreement for s in trial.course if s.disagreement is not None]
    expected = sum(disagreement) if trial.course and disagreement else None
    return TrialMeasures(
        participant=person.name,
        condition=person.condition,
        trial=trial.number,
        goal=trial.goal,
        optimal=trial.optimal,
        reward=trial.reward,
        switched=trial.switched,
        switch_step=_switch_step(trial),
        steps=trial.steps,
        seconds=trial.seconds,
        inputs=trial.inputs,
        disagreements=trial.disagreements,
        matched=trial.matched,
        expected_disagreement=expected,
        cost=None if expected is None else unit_cost * expected,
        alpha=_alpha(trial, alphas),
    )


def _switch_step(trial: Trial) -> int | None:
    likelier = [step.towards > LIKELIER for step in trial.course]
    if not trial.switched or not likelier or likelier[0] or not likelier[-1]:
        return None
    return max(i for i, (a, b) in enumerate(pairwise(likelier), start=1) if b and not a)


def _alpha(trial: Trial, alphas: Sequence[float]) -> float | None:
    """The mean of the last belief; None of a robot whose belief never moves, or is about one α."""
    belief = trial.belief
    if belief is None or len(belief) != len(alphas) or len(alphas) < 2:
        return None
    first = trial.course[0].belief if trial.course else (1 / len(alphas),) * len(alphas)
    if np.allclose(first, belief, atol=1e-12):
        return None
    return float(np.dot(belief, alphas))


def _person(
    person: Person,
    trials: Sequence[TrialMeasures],
    wanted: int,
    scored: dict[str, float | None],
) -> PersonMeasures:
    rewards = [t.reward for t in trials if t.reward is not None]
    complete = len(rewards) == wanted
    performance = sum(rewards) / wanted if complete else person.performance
    optimal = [t.optimal for t in trials if t.optimal is not None]
    told = [t for t in trials if t.switched is not None]
    switched = person.switched
    if told and (len(told) == wanted or any(t.switched for t in told)):
        switched = any(t.switched for t in told)

    def mean(of: Callable[[TrialMeasures], float | None]) -> float | None:
        values = [value for value in map(of, trials) if value is not None]
        return sum(values) / len(values) if values else None

    return PersonMeasures(
        participant=person.name,
        condition=person.condition,
        trials=len(trials),
        performance=performance,
        optimal_trials=sum(optimal) if len(optimal) == wanted else None,
        switched=switched,
        switch_trial=next((t.trial for t in told if t.switched), None),
        steps=mean(lambda t: t.steps),
        seconds=mean(lambda t: t.seconds),
        inputs=mean(lambda t: t.inputs),
        disagreements=mean(lambda t: t.disagreements),
        cost=mean(lambda t: t.cost),
        alpha=trials[-1].alpha if trials else None,
        scores=scored,
        checks_failed=person.checks_failed,
    )
