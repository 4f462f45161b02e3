"""What came of simulated episodes: shares of the goals and means, with their standard errors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean, stdev

from coadapt.robots import Collaborator, Robot
from coadapt.simulation import Episode

MEANINGS = {
    "reward": "reward of the goal reached",
    "steps": "steps",
    "disagreement": "steps in which it was seen in another mode",
    "overridden": "steps in which it did not do what was asked",
    "estimated_adaptability": "its last estimate of alpha",
}
"""Every measure in a few words, about the robot."""


@dataclass(frozen=True)
class Mean:
    """A mean over the episodes, and its standard error; None of a single episode."""

    mean: float
    standard_error: float | None


@dataclass(frozen=True)
class Outcome:
    """What came of the episodes.

    Attributes:
        episodes: their number.
        goals: the share of those that end at each goal.
        no_goal: the share of the others.
        measures: the means, by the names in `MEANINGS`.
    """

    episodes: int
    goals: dict[str, float]
    no_goal: float
    measures: dict[str, Mean]

    def record(self) -> dict[str, object]:
        """For JSON."""
        means = {
            name: {"mean": value.mean, "standard_error": value.standard_error}
            for name, value in self.measures.items()
        }
        return {"episodes": self.episodes, "goals": self.goals, "no_goal": self.no_goal, **means}

    def lines(self) -> list[str]:
        """For people."""
        shares = {f"ends at {name}": share for name, share in self.goals.items()}
        shares["ends at no goal"] = self.no_goal
        width = 2 + max(map(len, (*shares, *MEANINGS.values())))
        lines = [f"  {'episodes':<{width}}{self.episodes:8,}"]
        lines += [f"  {name:<{width}}{share:8.1%}" for name, share in shares.items()]
        for name, value in self.measures.items():
            error = value.standard_error
            spread = "" if error is None else f" +- {error:.2g}"
            lines.append(f"  {MEANINGS[name]:<{width}}{value.mean:8.3f}{spread}")
        return lines


def outcome_of(robot: Robot | Collaborator, episodes: Sequence[Episode]) -> Outcome:
    """The outcome of at least one episode of ``robot``."""
    names, count = robot.model.mode_names, len(episodes)
    ends = [sum(e.goal == g for e in episodes) for g in range(len(names))]
    alpha = robot.planning_model.alpha.levels
    estimates = [float(e.decisions[-1].adaptability_belief @ alpha) for e in episodes]
    values = {
        "reward": [e.reward for e in episodes],
        "steps": [float(e.steps) for e in episodes],
        "disagreement": [e.disagreement for e in episodes],
        "overridden": [float(e.overridden) for e in episodes],
        "estimated_adaptability": estimates,
    }
    return Outcome(
        episodes=count,
        goals={name: end / count for name, end in zip(names, ends, strict=True)},
        no_goal=sum(e.goal is None for e in episodes) / count,
        measures={name: _mean(numbers) for name, numbers in values.items()},
    )


def _mean(values: Sequence[float]) -> Mean:
    error = stdev(values) / math.sqrt(len(values)) if len(values) > 1 else None
    return Mean(fmean(values), error)
