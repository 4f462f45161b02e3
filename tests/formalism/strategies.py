"""Random small models of shared autonomy."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from coadapt import SharedAutonomy
from coadapt.human import Adaptability, Inputs
from coadapt.human.history import NO_ACTION
from tests.momdp.strategies import random_rows
from tests.worlds.strategies import worlds


@st.composite
def models(
    draw: st.DrawFn, *, states: int = 6, goals: int = 4, memory: int = 1, general: bool = False
) -> SharedAutonomy:
    """Everything random, with a memory of up to ``memory`` steps.

    With ``general`` also what the paper leaves out: uncertain moves, goal regions, several starts,
    costs, inputs that are not the robot's actions, a human half of the policies of its own,
    adaptability that differs from goal to goal.
    """
    general = general and draw(st.booleans(), label="general")
    world = draw(worlds(states=states, goals=goals, general=general))
    levels = draw(st.integers(1, 3), label="levels of adaptability")
    fixed = draw(st.booleans(), label="adaptability is fixed")
    given_policies = draw(st.booleans(), label="policies are given")
    zeros = draw(st.sampled_from((0.0, 0.5)), label="zeros")
    rng = np.random.default_rng(draw(st.integers(0, 2**32), label="seed"))
    modes = len(world.goals)
    shape = (modes, world.states, world.actions)
    values = np.sort(rng.random(levels))
    values[-1] = 1.0 if zeros else values[-1]
    if general and rng.random() < 0.5:
        values = np.clip(rng.uniform(-0.3, 1.3, size=(levels, modes)), 0, 1)
        values[:, 0] = rng.random(levels)  # so that rows differ
    return SharedAutonomy(
        world,
        memory=draw(st.integers(1, memory), label="memory"),
        adaptability=Adaptability.over(
            values.tolist(),
            prior=random_rows(rng, (levels,), 0.0).tolist(),
            transition=None if fixed else random_rows(rng, (levels, levels), zeros),
        ),
        mode_prior=random_rows(rng, (modes,), 0.0).tolist(),
        disagreement_cost=-float(rng.random()),
        discount=float(rng.uniform(0, 0.95)),
        step_cost=float(rng.uniform(1.5, 5)),
        policies=random_rows(rng, shape, zeros) if given_policies else None,
        action_disagreement_cost=-float(rng.random()) if general else 0.0,
        human_policies=random_rows(rng, shape, zeros) if general and rng.random() < 0.5 else None,
        inputs=random_inputs(rng, world.actions) if general and rng.random() < 0.7 else None,
    )


def random_inputs(rng: np.random.Generator, actions: int) -> Inputs:
    """One to four inputs, at random, and none at all at times."""
    count = int(rng.integers(1, 5))
    return Inputs(
        names=tuple(f"i{i}" for i in range(count)),
        likelihood=random_rows(rng, (actions, count), 0.3),
        asks=rng.integers(NO_ACTION, actions, size=count),
        directions=np.zeros((count, 2)),
        silence=float(rng.choice([0.0, rng.random()])),
    )
