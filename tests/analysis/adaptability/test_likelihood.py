"""The hidden Markov model against all courses of modes, one by one."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt import SharedAutonomy
from coadapt.analysis.adaptability import (
    Evidence,
    PersonModel,
    Posterior,
    RecordedTrial,
    Recordings,
    modes_over_time,
)
from coadapt.analysis.adaptability.likelihood import log_likelihoods
from coadapt.arrays import FloatArray
from coadapt.human.adaptation import mode_transition
from coadapt.robots import NO_INPUT
from tests.analysis.adaptability.people import participants, recordings_of
from tests.momdp.apart import run_apart
from tests.robots.worlds import DOWN, MODEL, POLICIES, ROW, UP, B, C


def by_enumeration(
    person: PersonModel, recordings: Recordings, p: int, alpha: float
) -> tuple[float, FloatArray]:
    """``P(inputs of p | alpha)`` and ``[S, M]`` the joint with the mode at each of their steps."""
    trials = range(recordings.first_trial[p], recordings.first_trial[p + 1])
    course = [
        (s, s == recordings.first_step[t])
        for t in trials
        for s in range(recordings.first_step[t], recordings.first_step[t + 1])
    ]
    joint = np.zeros((len(course), 2))
    for modes in product(range(2), repeat=len(course)):
        chance = 1.0
        for i, (s, begins) in enumerate(course):
            x, given, action = recordings.state[s], recordings.human_input[s], recordings.action[s]
            if i == 0 or (begins and not person.mode_lasts):
                chance *= person.prior[modes[i]]
            else:
                before, _ = course[i - 1]
                seen = MODEL.perceived[recordings.state[before], recordings.action[before]]
                chance *= mode_transition(alpha, seen)[modes[i - 1], modes[i]]
            if given != NO_INPUT:
                wish = POLICIES[modes[i], x, given]
                chance *= (1 - person.lapse) * wish + person.lapse / 2
            del action
        joint[range(len(course)), modes] += chance
    return float(joint[0].sum()), joint


@given(
    participants,
    st.booleans(),
    st.sampled_from((None, 0, 1)),
    st.sampled_from((0.0, 0.2)),
    st.floats(0, 1),
)
def test_likelihood_and_modes_are_those_of_all_courses(
    people: list[list[list[tuple[int, int, int]]]],
    mode_lasts: bool,
    first_mode: int | None,
    lapse: float,
    alpha: float,
) -> None:
    recordings = recordings_of(people)
    person = PersonModel(MODEL, mode_lasts, first_mode, lapse)
    values = np.array([0.0, alpha, 1.0])
    found = log_likelihoods(person, recordings, values)
    weight = np.tile([0.2, 0.3, 0.5], (len(recordings), 1))
    known = Posterior(values, weight, weight[0], np.zeros(len(recordings)))
    modes = modes_over_time(person, recordings, known)
    for p in range(len(recordings)):
        expected = np.zeros((recordings.steps[p], 2))
        for j, value in enumerate(values):
            total, joint = by_enumeration(person, recordings, p, float(value))
            np.testing.assert_allclose(np.exp(found[p, j]), total, rtol=1e-10)
            expected += weight[p, j] * joint / total
        mine = slice(*recordings.first_step[recordings.first_trial[[p, p + 1]]])
        np.testing.assert_allclose(modes.probability[mine], expected, atol=1e-10)


def test_disagreements_are_expected_ones() -> None:
    # In b an action down is of low with 0.8 / 1.05, Eq. 2, so somebody who surely wants high sees
    # the robot in low with that probability.
    recordings = Recordings.of({"a": [RecordedTrial([B], [UP], [DOWN])]})
    person = PersonModel(MODEL, first_mode=1)
    known = Posterior(np.array([0.5]), np.ones((1, 1)), np.ones(1), np.zeros(1))
    found = modes_over_time(person, recordings, known)
    assert found.disagreements == pytest.approx([0.8 / 1.05])


def test_a_longer_memory_is_that_of_the_windows() -> None:
    # With k = 2 the person judges by both steps; the window follows the recorded course.
    model = SharedAutonomy(ROW, memory=2, policies=POLICIES)
    recordings = Recordings.of({"a": [RecordedTrial([B, C], [DOWN, DOWN], [UP, DOWN])]})
    steps = PersonModel(model).steps(recordings)
    seen = POLICIES[:, B, UP] * POLICIES[:, C, DOWN]
    np.testing.assert_allclose(steps.perceived[1], seen / seen.sum())


def test_what_no_alpha_explains_is_refused() -> None:
    sure = np.array([[[1.0, 0.0]] * 4, [[1.0, 0.0]] * 4])
    model = SharedAutonomy(ROW, policies=sure)
    recordings = Recordings.of({"a": [RecordedTrial([B], [UP], [DOWN])]})
    with pytest.raises(ValueError, match=r"participant 1 are impossible .* lapse rate"):
        Evidence.of(PersonModel(model), recordings)
    _ = Evidence.of(PersonModel(model, lapse=0.01), recordings)


def test_bad_numbers_are_refused() -> None:
    with pytest.raises(ValueError, match="lapse rate must lie"):
        PersonModel(MODEL, lapse=1.0)
    with pytest.raises(ValueError, match="mode 2 is not one of 0 to 1"):
        PersonModel(MODEL, first_mode=2)
    with pytest.raises(ValueError, match="as many states as inputs"):
        Recordings.of({"a": [RecordedTrial([B], [], [UP])]})


PROGRAM = """
import json
import numpy as np
from coadapt.analysis.adaptability import *
from coadapt.analysis.adaptability.weights import fit_weights
from tests.analysis.adaptability.people import recordings_of
from tests.robots.worlds import MODEL

people = [[[(1, 0, 1), (2, 1, 1)], [(1, 1, 0)]], [[(1, 0, 1), (2, 0, 0), (1, 1, 1)]]]
recordings, person = recordings_of(people), PersonModel(MODEL, mode_lasts=True)
evidence = Evidence.of(person, recordings, 11)
known = posterior(evidence)
fitted = fit_population(evidence)
weights = fit_weights(evidence.log_likelihood[:, [0, 5, 10]], (0.0, 0.5, 1.0))
print(json.dumps([
    evidence.log_likelihood.tolist(),
    modes_over_time(person, recordings, known).probability.tolist(),
    [fitted.mean, fitted.spread, fitted.log_likelihood],
    [w.estimate for w in weights.weights],
]))
"""


def test_the_compiler_changes_nothing() -> None:
    compiled, plain = run_apart(PROGRAM), run_apart(PROGRAM, NUMBA_DISABLE_JIT="1")
    for one, other in zip(compiled, plain, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12)
