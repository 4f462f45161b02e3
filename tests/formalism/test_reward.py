"""The robot's reward, Eq. 6-8."""

from __future__ import annotations

import numpy as np
from hypothesis import given

from coadapt import SharedAutonomy
from coadapt.formalism.reward import disagreement, reward
from coadapt.worlds import table_clearing
from tests.formalism.strategies import models


@given(models())
def test_the_reward_is_that_of_the_paper(model: SharedAutonomy) -> None:
    world, perceived = model.world, model.perceived
    found = reward(world, model.windows.state, perceived, model.disagreement_cost)
    modes = len(world.goals)
    for x, a, m_h in np.ndindex(world.states, world.actions, modes):
        if x in world.goal_states:
            expected = world.goals[world.goal_states.index(x)].reward  # Eq. 6, x in G
        else:
            expected = 0.0
            for m_r in range(modes):
                cost = 0.0 if m_h == m_r else model.disagreement_cost  # Eq. 8
                expected += cost * perceived[x, a, m_r]  # Eq. 7
        np.testing.assert_allclose(found[x, a, m_h], expected, atol=1e-14)


def test_disagreement_is_the_chance_of_another_mode() -> None:
    np.testing.assert_allclose(disagreement(np.array([0.7, 0.2, 0.1])), [0.3, 0.8, 0.9])


def test_reward_leaves_what_it_is_given_alone() -> None:
    world = table_clearing(3, 2)
    perceived = np.full((6, 3, 2), 0.5)
    reward(world, np.arange(6), perceived, -1.0)
    assert np.all(perceived == 0.5)
