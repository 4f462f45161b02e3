"""People drawn by the hundred thousand are those of the simulation, and the fit finds them."""

from __future__ import annotations

import numpy as np
import pytest

from coadapt import SimulatedPartner, evaluate, simulate
from coadapt.analysis.adaptability import Evidence, PersonModel, Recordings, posterior
from coadapt.analysis.adaptability.draws import Design, draw_recordings
from coadapt.analysis.adaptability.recovery import recover, recover_weights
from coadapt.robots import NEVER_MATCH, MutualAdaptation
from tests.robots.worlds import MODEL, towards_the_likelier

ROBOT = MutualAdaptation(MODEL, towards_the_likelier(), NEVER_MATCH)


def test_drawn_people_take_as_many_steps_as_exact_ones() -> None:
    count = 20_000
    design = Design(ROBOT, PersonModel(MODEL, first_mode=0), trials=1)
    drawn = draw_recordings(design, np.full(count, 0.5), np.random.default_rng(0))
    exact = evaluate(ROBOT, SimulatedPartner(0.5, 0), tolerance=1e-6)
    error = drawn.steps.std() / np.sqrt(count)
    assert drawn.steps.mean() == pytest.approx(exact.steps, abs=4 * error)


@pytest.mark.parametrize(("carry", "keep"), [(True, True), (False, True), (True, False)])
def test_trials_in_a_row_are_those_of_the_simulation(carry: bool, keep: bool) -> None:
    count, trials = 1500, 2
    person = PersonModel(MODEL, mode_lasts=keep, first_mode=0 if keep else None)
    design = Design(ROBOT, person, trials, carry)
    drawn = draw_recordings(design, np.full(count, 0.5), np.random.default_rng(0))
    episodes = simulate(
        ROBOT,
        SimulatedPartner(0.5, person.first_mode),
        count,
        np.random.default_rng(1),
        trials=trials,
        carry_belief=carry,
        keep_mode=keep,
    )
    people = {str(i): episodes[i * trials : (i + 1) * trials] for i in range(count)}
    simulated = Recordings.from_episodes(people)
    for first in (True, False):
        ones, others = (_steps_and_inputs(r, trials, first) for r in (drawn, simulated))
        for a, b in zip(ones, others, strict=True):
            error = np.hypot(a.std(), b.std()) / np.sqrt(count)
            assert a.mean() == pytest.approx(b.mean(), abs=4 * error)


def _steps_and_inputs(r: Recordings, trials: int, first: bool) -> tuple[np.ndarray, np.ndarray]:
    steps = np.diff(r.first_step).reshape(-1, trials)[:, 0 if first else 1]
    begin = r.first_step[:-1].reshape(-1, trials)[:, 0 if first else 1]
    return steps, r.human_input[begin]


def test_credible_intervals_are_credible() -> None:
    # Where alpha is drawn from the prior, 95 % intervals hold it in 95 % of all cases.
    rng = np.random.default_rng(0)
    design = Design(ROBOT, PersonModel(MODEL, mode_lasts=True))
    alpha = rng.random(4000)
    evidence = Evidence.of(design.person, draw_recordings(design, alpha, rng))
    ends = posterior(evidence).interval()
    covered = np.mean((ends[:, 0] <= alpha) & (alpha <= ends[:, 1]))
    assert covered == pytest.approx(0.95, abs=4 * np.sqrt(0.95 * 0.05 / 4000) + 0.005)


def test_studies_recover_the_population() -> None:
    design = Design(ROBOT, PersonModel(MODEL, mode_lasts=True), trials=3)
    found = recover(design, 0.6, 0.2, 150, 20, np.random.default_rng(0))
    again = recover(design, 0.6, 0.2, 150, 20, np.random.default_rng(0))
    np.testing.assert_array_equal(found.mean.estimate, again.mean.estimate)
    assert found.sd is not None
    np.testing.assert_array_equal(found.sd.estimate, found.estimated_sd)
    for number, true in ((found.mean, 0.6), (found.sd, 0.2)):
        assert number.true == true
        assert abs(number.bias) < 4 * number.estimate.std() / np.sqrt(20)
        assert number.coverage >= 0.7  # below it with a chance of 3e-4 if it is 0.95
        low, high = number.coverage_interval
        assert low <= number.coverage <= high
        assert np.all((number.low <= number.estimate) & (number.estimate <= number.high))


def test_studies_recover_the_weights() -> None:
    design = Design(ROBOT, PersonModel(MODEL, mode_lasts=True), trials=3)
    values, weights = (0.0, 0.5, 1.0), (0.3, 0.2, 0.5)
    found = recover_weights(design, values, weights, 150, 20, np.random.default_rng(0))
    assert tuple(number.true for number in found) == weights
    np.testing.assert_allclose(sum(number.estimate for number in found), 1.0)
    for number in found:
        assert number.studies == 20
        assert abs(number.bias) < 4 * number.estimate.std() / np.sqrt(20) + 0.02
        assert number.coverage >= 0.7  # as above


def test_where_all_are_alike_no_deviation_is_asked_for() -> None:
    design = Design(ROBOT, PersonModel(MODEL, mode_lasts=True))
    found = recover(design, 1.0, 0.0, 20, 3, np.random.default_rng(0))
    assert found.sd is None
    assert found.true_sd == 0
    assert len(found.estimated_sd) == found.mean.studies == 3


def test_bad_numbers_are_refused() -> None:
    design = Design(ROBOT, PersonModel(MODEL))
    with pytest.raises(ValueError, match="at least one participant"):
        recover(design, 0.5, 0.0, 0, 1, np.random.default_rng(0))
    with pytest.raises(ValueError, match="no population"):
        recover(design, 0.5, 0.6, 1, 1, np.random.default_rng(0))
