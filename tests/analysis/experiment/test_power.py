"""Simulated experiments: pools against exact evaluation, power curves, the published study."""

from __future__ import annotations

import numpy as np
import pytest

from coadapt import SimulatedPartner, evaluate
from coadapt.analysis.adaptability.beta import alpha_grid, beta_weights
from coadapt.analysis.experiment.pool import Pool, Protocol, simulate_pool
from coadapt.analysis.experiment.power import (
    Conditions,
    PowerPoint,
    participants_needed,
    power_curve,
)
from coadapt.analysis.experiment.published import fit_published, predict_tests
from coadapt.robots import NEVER_MATCH, MutualAdaptation
from tests.robots.worlds import HIGH, LOW, MODEL, towards_the_likelier

ROBOT = MutualAdaptation(MODEL, towards_the_likelier(), NEVER_MATCH)


def made_pool(chance: float, points: int = 5, people: int = 400, seed: int = 0) -> Pool:
    """People of whom a part ``chance * alpha`` reaches the optimal goal in each of three trials."""
    rng = np.random.default_rng(seed)
    odds = chance * alpha_grid(points)[:, None, None]
    optimal = rng.random((points, people, 3)) < odds
    return Pool(10 + optimal.mean(axis=2), optimal)


ALWAYS = Pool(np.full((5, 400), 11.0), np.ones((5, 400, 3), dtype=np.bool_))
CONDITIONS = Conditions(ALWAYS, made_pool(0.9), made_pool(0.2, seed=1))


def test_a_pool_is_what_people_do() -> None:
    count = 4000
    pool = simulate_pool(
        ROBOT, Protocol(1, first_mode=LOW), np.random.default_rng(0), points=3, people=count
    )
    for j, alpha in enumerate(alpha_grid(3).tolist()):
        exact = evaluate(ROBOT, SimulatedPartner(alpha, LOW), tolerance=1e-6)
        p = float(exact.goal_probability[HIGH])
        error = np.sqrt(p * (1 - p) / count) + 1e-6
        assert pool.optimal[j].mean() == pytest.approx(p, abs=4 * error)
        assert pool.performance[j].mean() == pytest.approx(exact.reward, abs=8 * error)


def test_patterns_count_trials_as_bits() -> None:
    optimal = np.array([[[True, False], [False, True], [False, False], [True, False]]])
    pool = Pool(np.zeros((1, 4)), optimal)
    assert pool.patterns().tolist() == [[0.25, 0.5, 0.25, 0.0]]


def test_people_are_drawn_from_the_population() -> None:
    pool = Pool(np.array([[0.0, 0.0], [1.0, 1.0]]), np.zeros((2, 2, 1), dtype=np.bool_))
    drawn = pool.draw(np.array([0.25, 0.75]), (100, 100), np.random.default_rng(0))
    assert drawn.performance.mean() == pytest.approx(0.75, abs=4 * np.sqrt(0.75 * 0.25 / 1e4))


def test_power_grows_with_participants_and_repeats_with_the_seed() -> None:
    weights = beta_weights(np.array(0.5), np.array(0.3), 5)
    points, again = (
        power_curve(CONDITIONS, weights, (4, 12, 40), 200, np.random.default_rng(0))
        for _ in range(2)
    )
    assert points == again
    power = [point.power[1] for point in points]
    assert power[0] < power[1] < power[2]
    assert power[2] > 0.9
    assert all(p.low[q] <= p.power[q] <= p.high[q] for p in points for q in range(3))
    assert all(p.power[0] <= min(p.power[1:]) for p in points)  # H1 is both of its parts
    # Mutual ends optimally in 0.9 alpha of the trials and one-way in 0.2 alpha, each worth 1 more.
    assert points[2].difference == pytest.approx(0.7 * 0.5, abs=0.05)


def test_without_a_difference_it_is_hardly_found() -> None:
    weights = beta_weights(np.array(0.5), np.array(0.0), 5)
    same = Conditions(ALWAYS, made_pool(0.5), made_pool(0.5, seed=1))
    (point,) = power_curve(same, weights, (20,), 1000, np.random.default_rng(0))
    # In this direction 2.5 % halved by the correction, but the two pools differ by chance.
    assert point.power[1] < 0.05


def test_the_participants_needed() -> None:
    def point(n: int, power: float, reach: float) -> PowerPoint:
        return PowerPoint(n, 100, (power,), (power - reach,), (power + reach,), 0.0)

    points = [
        point(4, 0.82, 0.05),
        point(8, 0.7, 0.11),
        point(12, 0.81, 0.05),
        point(16, 0.9, 0.05),
    ]
    found = participants_needed(points, 0.8)
    assert (found.n, found.surely, found.perhaps) == (12, 16, 4)
    assert participants_needed(points, 0.95).n is None
    assert participants_needed(points, 0.99).perhaps is None


def test_the_published_counts_are_fitted() -> None:
    # Where each trial is optimal with probability p: at least once 1 - (1 - p) ** 3.
    fit = fit_published(CONDITIONS.mutual, CONDITIONS.one_way)
    assert fit.counts["mutual_adaptation"].sum() == pytest.approx(1.0)
    assert fit.groups[:3].sum() == pytest.approx(1.0)
    assert fit.groups[2] == pytest.approx(fit.counts["mutual_adaptation"][0])
    assert fit.deviance >= 0
    p = 9 / 16, 3 / 16, 4 / 16
    best = sum(n * np.log(x) for n, x in zip((9, 3, 4), p, strict=True))
    best += 2 * np.log(2 / 17) + 15 * np.log(15 / 17)
    assert fit.saturated == pytest.approx(best)
    tests = predict_tests(CONDITIONS, fit, 50, np.random.default_rng(0))
    assert tests.chi2.shape == (50,)
    assert np.all(tests.u_lower <= 16 * 17 / 2)
