"""Two sample runs: what the robot believes of the person, step by step."""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coadapt.report.figures.conditions import spread
from coadapt.report.figures.style import (
    LINE,
    MUTED,
    ONE_WAY,
    ONE_WAY_TEXT,
    PATH,
    WIDTH,
    label_line,
)
from coadapt.report.task.outcomes import OPTIMAL, SHADES
from coadapt.report.task.results import TaskResults
from coadapt.simulation import Episode

HEIGHT = 3.4
"""Of the figure, inches."""


def beliefs(found: TaskResults) -> Figure:
    """A column for each run: belief over modes above, the estimate of alpha below."""
    figure = Figure(figsize=(WIDTH, HEIGHT))
    ends = found.planned.by_alpha[0], found.planned.by_alpha[-1]
    for i, (episode, shown) in enumerate(zip(found.planned.samples, ends, strict=True)):
        left = 0.085 + 0.5 * i
        upper = figure.add_axes((left, 0.54, 0.31, 0.34))
        upper.set_title(f"{'ab'[i]}  A run with a partner of α = {shown.alpha:g}", pad=14)
        _modes(upper, found, episode)
        lower = figure.add_axes((left, 0.13, 0.31, 0.26))
        _alpha(lower, found, episode, shown.alpha)
    return figure


def _modes(axes: Axes, found: TaskResults, episode: Episode) -> None:
    world = found.model.world
    steps = np.arange(1, episode.steps + 1)
    believed = np.stack([d.belief.sum(axis=0) for d in episode.decisions])
    others = [g for g in range(len(world.goals)) if g != world.optimal_goal]
    last: list[float] = []
    looks: list[tuple[str, str]] = []
    for rank, g in enumerate([world.optimal_goal, *others]):
        color = OPTIMAL if g == world.optimal_goal else SHADES[(rank - 1) % len(SHADES)]
        axes.plot(steps, believed[:, g], "-o", color=color, markersize=2.6, markeredgewidth=0)
        last.append(float(believed[-1, g]))
        looks.append((world.goals[g].name, color))
    for y, at, (name, color) in zip(last, spread(last, 0.12), looks, strict=True):
        dark = {ONE_WAY: ONE_WAY_TEXT, LINE: MUTED}.get(color, color)
        dy = (at - y) * 0.36 * HEIGHT * 72 / 1.1
        label_line(axes, float(steps[-1]), y, name, dark, dx=7, dy=dy, fontsize=7)
    axes.set_ylim(-0.05, 1.05)
    axes.set_ylabel("belief over modes")
    _switches(axes, episode)
    _steps(axes, episode)
    axes.tick_params(labelbottom=False)


def _switches(axes: Axes, episode: Episode) -> None:
    """A line where the partner changes their mode, the first of them named."""
    changes = [t for t, (a, b) in enumerate(pairwise(episode.modes), start=1) if a != b]
    for i, t in enumerate(changes):
        axes.axvline(t + 0.5, color=MUTED, linewidth=0.8, linestyle=(0, (2, 2)), zorder=0)
        if i == 0:
            axes.text(t + 0.5, 1.07, "switches", color=MUTED, fontsize=6, ha="center", va="bottom")


def _alpha(axes: Axes, found: TaskResults, episode: Episode, true: float) -> None:
    levels = found.model.alpha.levels
    estimate = [float(d.belief.sum(axis=1) @ levels) for d in episode.decisions]
    steps = np.arange(1, episode.steps + 1)
    axes.axhline(true, color=LINE, linewidth=1.0, zorder=0)
    axes.plot(steps, estimate, "-o", color=PATH, markersize=2.6, markeredgewidth=0)
    ends = [estimate[-1], true]
    for y, at, (text, color) in zip(
        ends, spread(ends, 0.2), (("estimate", PATH), ("true", MUTED)), strict=True
    ):
        dy = (at - y) * 0.26 * HEIGHT * 72 / 1.1
        label_line(axes, float(steps[-1]), y, text, color, dx=7, dy=dy, fontsize=7)
    axes.set_ylim(-0.05, 1.05)
    axes.set_ylabel("adaptability")
    axes.set_xlabel("step")
    _steps(axes, episode)


def _steps(axes: Axes, episode: Episode) -> None:
    last = max(episode.steps, 2)
    axes.set_xlim(0.6, last + 0.4)
    every = max(1, -(-last // 10))
    axes.set_xticks(np.arange(1, last + 1, every))
