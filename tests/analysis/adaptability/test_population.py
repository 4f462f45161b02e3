"""Populations: weights of beta distributions, fits with known answers, intervals, EM."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats
from scipy.optimize import minimize

from coadapt.analysis.adaptability import (
    Recordings,
    compare_models,
    fit_population,
    fit_weights,
    mean_interval,
    posterior,
    sd_interval,
)
from coadapt.analysis.adaptability.beta import (
    alpha_grid,
    beta_weights,
    spread_of,
    standard_deviation,
)
from coadapt.analysis.adaptability.fit import fit_adaptability
from coadapt.analysis.adaptability.intervals import profile_interval
from coadapt.analysis.adaptability.likelihood import PersonModel, log_likelihoods
from tests.analysis.adaptability.people import binomial_evidence, recordings_of
from tests.robots.worlds import DOWN, MODEL, UP, B, C

YES = [0, 1, 2, 5, 3, 4, 0, 2, 1, 3, 5, 2]
"""Of 5 occasions each."""


@given(st.floats(0, 1), st.floats(0, 1))
def test_weights_are_a_distribution_with_the_mean(mean: float, spread: float) -> None:
    weights = beta_weights(np.array(mean), np.array(spread))
    assert np.all(weights >= 0)
    assert weights.sum() == pytest.approx(1.0, abs=1e-12)
    assert weights @ alpha_grid() == pytest.approx(mean, abs=1e-6)


def test_weights_are_integrals_over_the_beta_distribution() -> None:
    # Beta(2, 3): mean 0.4, spread 1 / (1 + 2 + 3). Between the points the function is linear.
    grid = alpha_grid(11)
    function = np.cos(5 * grid)
    expected = stats.beta(2, 3).expect(lambda x: np.interp(x, grid, function))
    assert beta_weights(np.array(0.4), np.array(1 / 6), 11) @ function == pytest.approx(expected)


def test_extreme_populations() -> None:
    np.testing.assert_allclose(
        beta_weights(np.array(0.3), np.array(1.0), 11), [0.7, *[0] * 9, 0.3], atol=1e-12
    )
    point = beta_weights(alpha_grid(11)[4], np.array(0.0), 11)
    np.testing.assert_allclose(point, np.eye(11)[4], atol=1e-12)


@given(st.floats(0.01, 0.99), st.floats(0, 1))
def test_spread_and_sd_are_each_others_inverse(mean: float, spread: float) -> None:
    assert spread_of(mean, standard_deviation(mean, spread)) == pytest.approx(spread, abs=1e-9)


def test_an_impossible_sd_is_refused() -> None:
    with pytest.raises(ValueError, match=r"no population in \[0, 1\]"):
        spread_of(0.1, 0.4)


def test_people_alike_are_fitted_as_one() -> None:
    # All occasions together are binomial: the most likely alpha is the share of all.
    fitted = fit_population(binomial_evidence(YES, 5, 401), spread=0.0)
    assert fitted.mean == pytest.approx(sum(YES) / (5 * len(YES)), abs=2e-3)


def test_a_beta_population_is_the_beta_binomial_one() -> None:
    def missing(x: np.ndarray) -> float:
        m, k = 1 / (1 + np.exp(-x[0])), np.exp(x[1])
        logs = stats.betabinom.logpmf(YES, 5, m * k, (1 - m) * k)
        return -float((logs - np.log(stats.binom.pmf(YES, 5, 0.5) * 2.0**5)).sum())

    best = minimize(missing, [0.0, 0.5], method="Nelder-Mead", options={"xatol": 1e-8})
    mean, k = 1 / (1 + np.exp(-best.x[0])), np.exp(best.x[1])
    fitted = fit_population(binomial_evidence(YES, 5, 401))
    assert fitted.mean == pytest.approx(mean, abs=2e-3)
    assert fitted.spread == pytest.approx(1 / (1 + k), abs=5e-3)
    assert fitted.log_likelihood == pytest.approx(-best.fun, abs=1e-3)


def test_ends_of_intervals_are_where_the_ratio_is_the_quantile() -> None:
    evidence = binomial_evidence(YES, 5)
    fitted = fit_population(evidence)
    interval = mean_interval(evidence, fitted)
    assert interval.low < fitted.mean < interval.high
    for end in (interval.low, interval.high):
        held = fit_population(evidence, mean=end)
        ratio = 2 * (fitted.log_likelihood - held.log_likelihood)
        assert ratio == pytest.approx(stats.chi2.ppf(0.95, 1), abs=0.01)
    spread = sd_interval(evidence, fitted)
    assert 0 < spread.low < fitted.sd < spread.high < 0.5
    assert mean_interval(evidence, fitted, 0.8).low > interval.low


def test_a_normal_likelihood_has_its_normal_interval() -> None:
    found = profile_interval(lambda t: -0.5 * ((t - 2) / 0.3) ** 2, 2.0, 0.0, (-9, 9))
    reach = 0.3 * stats.norm.ppf(0.975)
    assert (found.low, found.high) == (
        pytest.approx(2 - reach, abs=1e-4),
        pytest.approx(2 + reach, abs=1e-4),
    )
    assert profile_interval(lambda t: -t, 0.0, 0.0, (0, 1)).low == 0.0


def test_people_who_never_adapt_end_at_the_border() -> None:
    # Of 40 occasions none: the interval ends where 80 log(1 - alpha) = -3.84.
    evidence = binomial_evidence([0] * 8, 5)
    interval = mean_interval(evidence, fit_population(evidence))
    assert (interval.estimate, interval.low) == (0.0, 0.0)
    assert interval.high >= 1 - np.exp(-stats.chi2.ppf(0.95, 1) / 80) - 1e-3


def test_weights_satisfy_the_conditions_of_the_maximum() -> None:
    evidence = binomial_evidence(YES, 5, 5)
    found = fit_weights(evidence.log_likelihood, evidence.alpha.tolist())
    weights = np.array([w.estimate for w in found.weights])
    gain = (evidence.scaled / (evidence.scaled @ weights)[:, None]).mean(axis=0)
    assert weights.sum() == pytest.approx(1.0)
    assert np.all(gain <= 1 + 1e-4)  # Karush-Kuhn-Tucker
    np.testing.assert_allclose(gain[weights > 1e-3], 1.0, atol=1e-4)
    assert all(w.low <= w.estimate <= w.high for w in found.weights)
    assert found.log_likelihood >= fit_population(evidence).log_likelihood - 1e-9


def test_the_posterior_of_an_occasion_is_a_beta_distribution() -> None:
    # A uniform prior and 3 of 5: Beta(4, 3).
    found = posterior(binomial_evidence([3], 5, 801))
    beta = stats.beta(4, 3)
    assert found.mean == pytest.approx([beta.mean()], abs=1e-3)
    assert found.sd == pytest.approx([beta.std()], abs=1e-3)
    low, high = found.interval()[0]
    assert beta.cdf(high) - beta.cdf(low) == pytest.approx(0.95, abs=0.01)
    assert beta.pdf(low) == pytest.approx(beta.pdf(high), abs=0.1)  # the shortest
    assert found.log_evidence == pytest.approx([-np.log(60)], abs=1e-3)  # B(4, 3) = 1 / 60


def test_who_was_never_asked_told_nothing() -> None:
    found = posterior(binomial_evidence([0, 3], 0 + 3))
    nothing = posterior(binomial_evidence([0], 0))
    assert nothing.information == pytest.approx([0.0], abs=1e-9)
    assert np.all(found.information > 0.5)


def test_models_are_compared() -> None:
    # Of ten people five change their inputs as the robot leads and five never do.
    follows = [[(B, DOWN, UP), (C, UP, UP)]]
    stays = [[(B, DOWN, UP), (C, DOWN, UP)]]
    recordings = recordings_of([follows] * 5 + [stays] * 5)
    person = PersonModel(MODEL, first_mode=0)
    scores = {(s.name, s.memory): s for s in compare_models(person, recordings, (1,))}
    none, alike, beta = (
        scores[name, 1] for name in ("no adaptation", "all alike", "beta population")
    )
    assert none.log_likelihood <= alike.log_likelihood <= beta.log_likelihood + 1e-6
    # Nobody's modes matter before the first step: 10 inputs DOWN, then 5 UP, 5 DOWN in low.
    expected = 10 * np.log(0.8) + 5 * np.log(0.1) + 5 * np.log(0.9)
    assert none.log_likelihood == pytest.approx(expected)
    assert none.log_evidence == none.left_out == none.log_likelihood
    full = scores["full adaptation", 1]
    at_one = log_likelihoods(person, recordings, np.array([1.0]))
    assert full.log_likelihood == pytest.approx(at_one.sum())
    assert full.log_evidence == full.left_out == full.log_likelihood
    assert full.log_likelihood <= alike.log_likelihood
    assert full.aic == -2 * full.log_likelihood
    assert alike.aic == pytest.approx(2 - 2 * alike.log_likelihood)
    assert beta.bic == pytest.approx(2 * np.log(10) - 2 * beta.log_likelihood)
    assert alike.left_out < alike.log_likelihood
    assert alike.log_evidence < alike.log_likelihood


def test_a_fit_needs_participants() -> None:
    with pytest.raises(ValueError, match="no participants"):
        fit_adaptability(PersonModel(MODEL), Recordings.of({}))
