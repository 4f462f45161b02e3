"""The match rule of Sec. 5.3."""

from __future__ import annotations

import numpy as np
import pytest

from coadapt.robots import NEVER_MATCH, NO_INPUT, MatchRule


def test_agreement_is_the_chance_that_the_modes_are_the_same() -> None:
    rule = MatchRule()
    mode_belief, perceived = np.array([0.75, 0.25]), np.array([0.4, 0.6])
    # 0.75 * 0.4 + 0.25 * 0.6
    assert rule.agreement(mode_belief, perceived) == pytest.approx(0.45)
    both = rule.agreement(np.array([[0.75, 0.25], [1.0, 0.0]]), np.array([[0.4, 0.6], [0.9, 0.1]]))
    np.testing.assert_allclose(both, [0.45, 0.9])


def test_it_fires_from_the_threshold_on_if_there_is_an_input() -> None:
    agreement = np.array([0.9, 0.9, 0.89, 1.0, 1.0])
    human_input = np.array([0, NO_INPUT, 2, 1, NO_INPUT])
    # The threshold of 0.9 is ours.
    assert MatchRule().fires(agreement, human_input).tolist() == [True, False, False, True, False]
    assert MatchRule(0.0).fires(agreement, human_input).tolist() == [True, False, True, True, False]
    assert not NEVER_MATCH.fires(agreement, human_input).any()
