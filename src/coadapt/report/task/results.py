"""What the report of a task shows, computed: plan, simulated episodes, sample runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf, sqrt

import numpy as np

from coadapt.arrays import FloatArray
from coadapt.formalism import Model, SharedAutonomy
from coadapt.formalism.collaboration import Collaboration
from coadapt.momdp.sarsop import Solution
from coadapt.report.planning import solve
from coadapt.robots import (
    Collaborator,
    Decider,
    MutualAdaptation,
    NoAdaptation,
    OneWayAdaptation,
)
from coadapt.simulation import Episode, SimulatedPartner, simulate

Progress = Callable[[str], None]

ALPHAS = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Adaptability of the simulated partners, the values of Sec. 5.4."""

GAP = 1e-2
"""The planner stops when its bounds are this close, in reward units ..."""

MOST_BACKUPS = 20_000
"""... or after so much work: what it has then is a policy with the bounds that are shown."""

MAX_STEPS = 200
"""Of a simulated episode."""


@dataclass(frozen=True)
class TaskSettings:
    """What can be chosen.

    Attributes:
        runs: simulated episodes for each robot and adaptability, at least 2.
        seed: from which all episodes are drawn, at least 0.
        gap: the planner stops when its bounds are this close, in reward units, above 0.

    Raises:
        ValueError: if a value is out of its range.
    """

    runs: int = 1000
    seed: int = 0
    gap: float = GAP

    def __post_init__(self) -> None:
        if self.runs < 2:
            raise ValueError(f"runs must be at least 2, not {self.runs}")
        if self.seed < 0:
            raise ValueError(f"seed must be at least 0, not {self.seed}")
        if not 0 < self.gap < inf:
            raise ValueError(f"gap must be a number above 0, not {self.gap:g}")


@dataclass(frozen=True)
class Performance:
    """What the simulated episodes of one robot with partners of one adaptability came to.

    Attributes:
        alpha: the partners' adaptability.
        reward: mean reward of the goal reached, with its standard error.
        goals: ``[G]`` share of the episodes that ended at each goal; they may sum to less than 1.
        steps, disagreement: means of `Episode.steps` and `Episode.disagreement`.
        estimate: mean over the episodes of the robot's last estimate of alpha, its posterior mean.
        visits: ``[X]`` mean number of steps taken in each state.
        flow: mean number of moves from a state to another, by the pair of states.
    """

    alpha: float
    reward: float
    standard_error: float
    goals: FloatArray
    steps: float
    disagreement: float
    estimate: float
    visits: FloatArray
    flow: dict[tuple[int, int], float]


@dataclass(frozen=True)
class RobotPerformance:
    """One robot with partners of every adaptability.

    Attributes:
        label: what the report calls the robot.
        by_alpha: one for each of `ALPHAS`.
        samples: the first episode with the least and with the most adaptable partner.
    """

    label: str
    by_alpha: tuple[Performance, ...]
    samples: tuple[Episode, Episode]


@dataclass(frozen=True)
class TaskResults:
    """Everything the report of a task shows.

    Attributes:
        name, title, about: of the task.
        model: world and people.
        solution: the plan of the first robot.
        first_mode: the mode in which the simulated partners begin.
        robots: the one that the plan is for first.
        settings: what was asked for.
    """

    name: str
    title: str
    about: str
    model: Model
    solution: Solution
    first_mode: int
    robots: tuple[RobotPerformance, ...]
    settings: TaskSettings

    @property
    def planned(self) -> RobotPerformance:
        """The robot that the plan is for."""
        return self.robots[0]


def task_results(
    name: str,
    title: str,
    about: str,
    model: SharedAutonomy | Collaboration,
    settings: TaskSettings,
    progress: Progress | None = None,
) -> TaskResults:
    """Plan, and simulate every robot with partners of every adaptability.

    Args:
        name, title, about: of the task.
        model: world and people.
        settings: what can be chosen.
        progress: told what is being done.
    """
    gap = settings.gap
    tell: Progress = (lambda _: None) if progress is None else progress
    tell("Solving the task")
    solution = solve(model.to_momdp(), gap, MOST_BACKUPS)
    robots: list[tuple[str, Decider]] = []
    if isinstance(model, Collaboration):
        robots.append(("Collaborator", Collaborator(model, solution.policy)))
    else:
        robots.append(("Mutual adaptation", MutualAdaptation(model, solution.policy)))
        tell("Solving the one-way model")
        one_way = solve(model.one_way().to_momdp(), gap, MOST_BACKUPS)
        robots.append(("One-way adaptation", OneWayAdaptation(model, one_way.policy)))
        robots.append(("No adaptation", NoAdaptation(model)))
    first_mode = _first_mode(model)
    found: list[RobotPerformance] = []
    for label, robot in robots:
        tell(f"Simulating: {label}")
        found.append(_simulated(label, robot, first_mode, settings))
    return TaskResults(
        name=name,
        title=title,
        about=about,
        model=model,
        solution=solution,
        first_mode=first_mode,
        robots=tuple(found),
        settings=settings,
    )


def _first_mode(model: Model) -> int:
    """The likeliest mode but the optimal goal's: people who want something else than the robot."""
    prior = model.prior.sum(axis=0)
    best = model.world.optimal_goal
    others = [g for g in range(len(prior)) if g != best] or [best]
    return max(others, key=lambda g: prior[g])


def _simulated(
    label: str, robot: Decider, first_mode: int, settings: TaskSettings
) -> RobotPerformance:
    # Every robot meets partners drawn from the same seeds.
    children = np.random.SeedSequence(settings.seed).spawn(len(ALPHAS))
    by_alpha: list[Performance] = []
    samples: list[Episode] = []
    for alpha, child in zip(ALPHAS, children, strict=True):
        partner = SimulatedPartner(alpha, first_mode)
        rng = np.random.default_rng(child)
        episodes = simulate(robot, partner, settings.runs, rng, max_steps=MAX_STEPS)
        by_alpha.append(_summary(robot.model, alpha, episodes))
        samples.append(episodes[0])
    return RobotPerformance(label, tuple(by_alpha), (samples[0], samples[-1]))


def _summary(model: Model, alpha: float, episodes: Sequence[Episode]) -> Performance:
    world, count = model.world, len(episodes)
    rewards = np.array([episode.reward for episode in episodes])
    visits = np.zeros(world.states)
    flow: dict[tuple[int, int], float] = {}
    goals = np.zeros(len(world.goals))
    estimates: list[float] = []
    for episode in episodes:
        if episode.goal is not None:
            goals[episode.goal] += 1 / count
        states = episode.states
        for here, there in pairwise(states):
            visits[here] += 1 / count
            flow[here, there] = flow.get((here, there), 0.0) + 1 / count
        last = episode.decisions[-1].belief.sum(axis=1)
        levels = model.alpha.levels if len(last) == len(model.alpha.prior) else np.zeros(len(last))
        estimates.append(float(last @ levels))
    return Performance(
        alpha=alpha,
        reward=float(rewards.mean()),
        standard_error=float(rewards.std(ddof=1) / sqrt(count)),
        goals=goals,
        steps=float(np.mean([episode.steps for episode in episodes])),
        disagreement=float(np.mean([episode.disagreement for episode in episodes])),
        estimate=float(np.mean(estimates)),
        visits=visits,
        flow=flow,
    )
