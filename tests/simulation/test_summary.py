"""Sums over episodes, and intervals around them."""

from __future__ import annotations

import numpy as np
import pytest

from coadapt import SimulatedPartner, simulate_batch
from coadapt.robots import NEVER_MATCH, MutualAdaptation
from coadapt.simulation import Mean, Summary, summarize
from coadapt.simulation.summary import reward_interval
from tests.robots.worlds import MODEL, towards_the_likelier

REWARDS = [10.0, 11.0]


def interval(optimal: int, runs: int) -> tuple[float, float]:
    values = np.repeat([11.0, 10.0], [optimal, runs - optimal])
    ends = np.array([runs - optimal, optimal])
    return reward_interval(ends, runs, REWARDS, Mean.of(values))


def test_interval_is_wilsons() -> None:
    # Wilson's interval for 10 of 100 is 0.0552 to 0.1744 (R: binom::binom.confint, "wilson").
    low, high = interval(10, 100)
    assert low == pytest.approx(10.0552, abs=5e-5)
    assert high == pytest.approx(10.1744, abs=5e-5)


@pytest.mark.parametrize(("optimal", "end"), [(0, 10.0), (50, 11.0)])
def test_interval_has_width_where_all_runs_end_alike(optimal: int, end: float) -> None:
    low, high = interval(optimal, 50)
    assert high - low > 0.05
    assert end in (pytest.approx(low), pytest.approx(high))


def test_interval_where_some_end_at_no_goal() -> None:
    # Rewards 0, 0, 10, 10: mean 5, standard error sqrt(100 / 3) / 2 = 2.8868, times 1.96.
    low, high = reward_interval(np.array([2, 0]), 4, REWARDS, Mean.of(np.array([0.0, 0, 10, 10])))
    assert (low, high) == (pytest.approx(5 - 5.6580, abs=1e-4), pytest.approx(5 + 5.6580, abs=1e-4))


def summary_of(people: int, trial: int | None = None, beliefs: bool = True) -> Summary:
    robot = MutualAdaptation(MODEL, towards_the_likelier(), NEVER_MATCH)
    batch = simulate_batch(
        robot,
        SimulatedPartner(0.5),
        people,
        np.random.default_rng(0),
        trials=2,
        max_steps=1,
        beliefs=beliefs,
    )
    found = summarize(batch, MODEL, trial=trial)
    part = slice(None) if trial is None else [trial]
    assert found.runs == batch.goal[:, part].size
    for name in ("reward", "steps", "disagreement", "overridden", "discounted_return", "switched"):
        assert getattr(found, name).mean == pytest.approx(getattr(batch, name)[:, part].mean())
    assert found.no_goal == pytest.approx(np.mean(batch.goal[:, part] < 0))
    np.testing.assert_allclose(found.goals, [np.mean(batch.goal[:, part] == g) for g in (0, 1)])
    return found


@pytest.mark.parametrize("trial", [None, 0, 1])
def test_a_summary_is_of_the_trials_asked_for(trial: int | None) -> None:
    found = summary_of(40, trial)
    assert found.adaptability is not None
    assert 0 < found.adaptability.mean < 1


def test_one_episode_has_no_spread() -> None:
    found = summary_of(1, 0, beliefs=False)
    assert np.isnan(found.reward.standard_error)
    assert found.adaptability is None


def test_no_episodes() -> None:
    with pytest.raises(ValueError, match="no episodes"):
        summary_of(0)
