"""Random small models of collaboration."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from coadapt.formalism import Collaboration
from coadapt.human import Adaptability
from coadapt.human.mode_pairs import TIES
from tests.momdp.strategies import random_rows
from tests.worlds.joint_strategies import joint_worlds


@st.composite
def collaborations(draw: st.DrawFn, *, states: int = 5, goals: int = 3) -> Collaboration:
    """Everything random: modes seen or hidden, adaptability by goal or not, fixed or not."""
    world = draw(joint_worlds(states=states, goals=goals))
    hidden_modes = draw(st.booleans(), label="modes are hidden")
    levels = draw(st.integers(1, 3), label="levels of adaptability")
    by_goal = draw(st.booleans(), label="adaptability by goal")
    fixed = draw(st.booleans(), label="adaptability is fixed")
    rng = np.random.default_rng(draw(st.integers(0, 2**32), label="seed"))
    modes, (size, actions, human_actions) = len(world.goals), world.moves.shape[:3]
    if hidden_modes:
        robot = random_rows(rng, (modes, size, actions), 0.4)
        human = random_rows(rng, (modes, size, human_actions), 0.4)
    else:
        # The robot's action may be the same in several modes, the human's is not.
        robot = np.eye(actions)[rng.integers(actions, size=(modes, size))]
        choice = np.stack([rng.permutation(human_actions)[:modes] for _ in range(size)], axis=1)
        human = np.eye(human_actions)[choice]
    values = rng.random((levels, modes)) if by_goal else np.sort(rng.random(levels))
    return Collaboration(
        world,
        memory=draw(st.integers(1, 3), label="memory"),
        adaptability=Adaptability.over(
            values,
            prior=random_rows(rng, (levels,), 0.0),
            transition=None if fixed else random_rows(rng, (levels, levels), 0.3),
        ),
        mode_prior=random_rows(rng, (modes,), 0.0).tolist(),
        hidden_modes=hidden_modes,
        ties=draw(st.sampled_from(TIES), label="ties"),
        discount=float(rng.uniform(0, 0.95)),
        robot_policies=robot,
        human_policies=human,
    )
