"""What a robot loses with people who are not as it assumes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot

import numpy as np

from coadapt.robots import MutualAdaptation
from coadapt.robots.setup import Progress
from coadapt.simulation.batch import simulate_batch
from coadapt.simulation.knowing import KnowingRobot
from coadapt.simulation.partners import DescribedPartner
from coadapt.simulation.summary import Mean, Summary, summarize


@dataclass(frozen=True)
class Robustness:
    """A robot with people of one kind, beside one that knows the kind.

    Attributes:
        name: what the people are called.
        assuming: what the episodes of the robot came to.
        knowing: what those of `KnowingRobot` came to.
        same_memory: whether the people remember as many steps as the robot assumes.
    """

    name: str
    assuming: Summary
    knowing: Summary
    same_memory: bool

    @property
    def return_lost(self) -> Mean | None:
        """How much larger the mean discounted return is of who knows: what both plan for.

        None where the person has a memory of their own. Then the two robots reckon the penalty by
        different windows, and their returns are not to be compared.
        """
        if not self.same_memory:
            return None
        return _difference(self.knowing.discounted_return, self.assuming.discounted_return)

    @property
    def reward_lost(self) -> Mean:
        """How much larger the mean reward is of who knows."""
        return _difference(self.knowing.reward, self.assuming.reward)

    @property
    def disagreement_added(self) -> Mean:
        """In how many more steps the robot is seen in another mode than of who knows."""
        return _difference(self.assuming.disagreement, self.knowing.disagreement)


def robustness(
    robot: MutualAdaptation,
    partners: Mapping[str, DescribedPartner],
    *,
    runs: int,
    seed: int,
    gap: float,
    max_steps: int,
    progress: Progress | None = None,
) -> list[Robustness]:
    """Measure what ``robot`` loses with each of ``partners``.

    Both robots meet the same people, in the same episodes' random numbers, and follow the same
    match rule. The one that knows is planned here, once for each of them.

    Args:
        robot: the robot, in the model that it assumes.
        partners: the people, by the names for the result.
        runs: number of episodes with each, at least 2.
        seed: of all episodes.
        gap: the planner stops when its bounds are this close, in reward units.
        max_steps: number of robot actions after which an episode is given up.
        progress: told what is being done.

    Raises:
        ValueError: if somebody does not go with the robot's model.
    """
    found: list[Robustness] = []
    for name, partner in partners.items():
        if progress is not None:
            progress(f"Planning and simulating: {name}")
        knowing = KnowingRobot.planned(robot.model, partner, robot.match_rule, gap)
        assumed, known = (
            summarize(
                simulate_batch(
                    each, partner, runs, np.random.default_rng(seed), max_steps=max_steps
                ),
                each.model,
            )
            for each in (robot, knowing)
        )
        same_memory = knowing.model.memory == robot.model.memory
        found.append(Robustness(name, assumed, known, same_memory))
    return found


def _difference(a: Mean, b: Mean) -> Mean:
    """As if the two were drawn apart: a little too wide, since they meet the same people."""
    return Mean(a.mean - b.mean, hypot(a.standard_error, b.standard_error))
