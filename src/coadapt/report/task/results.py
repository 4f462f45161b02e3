"""What the report of a task shows, computed: plan, simulated episodes, sample runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf

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
from coadapt.simulation import (
    Batch,
    Episode,
    SimulatedPartner,
    Summary,
    simulate,
    simulate_batch,
    summarize,
)

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
        summary: shares and means.
        visits: ``[X]`` mean number of steps taken in each state.
        flow: mean number of moves from a state to another, by the pair of states.
    """

    alpha: float
    summary: Summary
    visits: FloatArray
    flow: dict[tuple[int, int], float]

    @property
    def estimate(self) -> float:
        """Mean over the episodes of the robot's last estimate of alpha, its posterior mean."""
        assert self.summary.adaptability is not None
        return self.summary.adaptability.mean


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
        batch = simulate_batch(
            robot,
            partner,
            settings.runs,
            np.random.default_rng(child),
            max_steps=MAX_STEPS,
            beliefs=True,
        )
        by_alpha.append(_performance(robot.model, alpha, batch))
        first = simulate(robot, partner, 1, np.random.default_rng(child), max_steps=MAX_STEPS)
        samples += first
    return RobotPerformance(label, tuple(by_alpha), (samples[0], samples[-1]))


def _performance(model: Model, alpha: float, batch: Batch) -> Performance:
    world = model.world
    assert batch.belief is not None
    values = batch.belief.shape[2]
    levels = model.alpha.levels if values == len(model.alpha.prior) else np.zeros(values)
    flow: dict[tuple[int, int], float] = {}
    places = world.outcomes.reshape(batch.taken.shape)
    for x, a, o in np.argwhere(batch.taken):
        way = int(x), int(places[x, a, o])
        flow[way] = flow.get(way, 0.0) + float(batch.taken[x, a, o]) / batch.people
    return Performance(
        alpha=alpha,
        summary=summarize(batch, model, levels=levels),
        visits=batch.taken.sum(axis=(1, 2)) / batch.people,
        flow=flow,
    )
