"""The sample runs of Sec. 5.4: two users who begin alike, one stubborn and one who turns.

Both are simulated; which of the simulated runs is shown follows from the inputs and the user's
mode alone, never from where the run ends.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from coadapt.robots import Robot
from coadapt.simulation import Episode, SimulatedPartner, simulate

LEADING_INPUTS = 2
"""Both users ask for the way to their goal this many times before they part."""

BATCH = 500
MOST_RUNS = 100_000


@dataclass(frozen=True)
class SampleRun:
    """One simulated run, and how it was chosen.

    Attributes:
        user: number of the user, from 1.
        adaptability: the user's alpha.
        episode: what happened.
        number: index of the run among those drawn from the seed, from 0.
        rule: the rule by which it was chosen, a clause that completes "the first run in which".
    """

    user: int
    adaptability: float
    episode: Episode
    number: int
    rule: str


def sample_runs(robot: Robot, mode: int, seed: np.random.SeedSequence) -> tuple[SampleRun, ...]:
    """The two users' runs with ``robot``, both starting in ``mode``.

    Args:
        robot: the robot.
        mode: the users' first mode, another one than the optimal goal's.
        seed: seeds the two users' generators.

    Raises:
        ValueError: if no run of a user is as the rule asks.
    """
    world = robot.model.world
    own = _own_direction(robot, mode)
    other = _own_direction(robot, world.optimal_goal)
    name, turned = world.action_names[own], world.action_names[other]
    goal = world.goals[world.optimal_goal].name
    opening = (own,) * LEADING_INPUTS
    choices: tuple[tuple[float, str, Callable[[Episode], bool]], ...] = (
        (
            0.0,
            f"the user asks for {name} in each of the first {LEADING_INPUTS + 1} steps",
            lambda e: e.inputs[: LEADING_INPUTS + 1] == (*opening, own),
        ),
        (
            0.75,
            f"the user asks for {name} {LEADING_INPUTS} times, then for {turned}, and from then on "
            f"heads for the {goal} goal",
            lambda e: (
                e.inputs[: LEADING_INPUTS + 1] == (*opening, other)
                and set(e.modes[LEADING_INPUTS:]) == {world.optimal_goal}
            ),
        ),
    )
    runs: list[SampleRun] = []
    for (alpha, rule, fits), child in zip(choices, seed.spawn(len(choices)), strict=True):
        partner = SimulatedPartner(alpha, mode)
        number, episode = _first(robot, partner, fits, np.random.default_rng(child))
        runs.append(SampleRun(len(runs) + 1, alpha, episode, number, rule))
    return tuple(runs)


def _first(
    robot: Robot,
    partner: SimulatedPartner,
    fits: Callable[[Episode], bool],
    rng: np.random.Generator,
) -> tuple[int, Episode]:
    for start in range(0, MOST_RUNS, BATCH):
        for i, episode in enumerate(simulate(robot, partner, BATCH, rng)):
            if fits(episode):
                return start + i, episode
    raise ValueError(
        f"none of {MOST_RUNS} runs with adaptability {partner.adaptability:g} is fit to be shown"
    )


def _own_direction(robot: Robot, mode: int) -> int:
    """The action in the start state that tells most clearly of ``mode`` (Eq. 2)."""
    model = robot.model
    start = model.windows.beginning[model.world.start]
    return int(np.argmax(model.perceived[start, :, mode]))
