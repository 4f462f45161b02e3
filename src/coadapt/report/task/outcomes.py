"""How well the robots do over the adaptability of their partners, and where episodes end."""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coadapt.report.figures.conditions import LOOKS, spread
from coadapt.report.figures.style import (
    HUMAN,
    INK,
    LINE,
    MUTED,
    MUTUAL,
    ONE_WAY,
    ONE_WAY_TEXT,
    PAPER,
    PATH,
    ROBOT,
    WIDTH,
    label_line,
)
from coadapt.report.task.results import TaskResults
from coadapt.simulation.summary import Z95

HEIGHT = 2.7
"""Of the figure, inches."""

OPTIMAL = MUTUAL
SHADES = (ONE_WAY, MUTED, LINE, HUMAN, PATH, ROBOT)
"""Of the goals but the optimal one, in their order and again from the first."""


def outcomes(found: TaskResults) -> Figure:
    """Left: reward over adaptability. Right: where the planned robot's episodes end."""
    figure = Figure(figsize=(WIDTH, HEIGHT))
    _rewards(figure.add_axes((0.065, 0.17, 0.27, 0.69)), found)
    _ends(figure.add_axes((0.6, 0.17, 0.24, 0.69)), found)
    return figure


def _rewards(axes: Axes, found: TaskResults) -> None:
    axes.set_title("a  Mean reward of the goal reached", pad=7)
    for robot in found.robots:
        color, marker, dashes = LOOKS.get(robot.label, LOOKS["Mutual adaptation"])
        axes.errorbar(
            [p.alpha for p in robot.by_alpha],
            [p.summary.reward.mean for p in robot.by_alpha],
            yerr=[Z95 * p.summary.reward.standard_error for p in robot.by_alpha],
            color=color,
            marker=marker,
            linestyle=dashes,
            markersize=4,
            markeredgewidth=0,
            elinewidth=0.9,
            clip_on=False,
            zorder=3,
        )
    low, high = axes.get_ylim()
    if high - low < 0.2:
        axes.set_ylim(low - 0.1, high + 0.1)
        low, high = axes.get_ylim()
    last = [robot.by_alpha[-1].summary.reward.mean for robot in found.robots]
    points = 0.69 * HEIGHT * 72 / (high - low)
    for robot, y, at in zip(found.robots, last, spread(last, 0.09 * (high - low)), strict=True):
        color = LOOKS.get(robot.label, LOOKS["Mutual adaptation"])[0]
        color = ONE_WAY_TEXT if color == ONE_WAY else color
        label_line(axes, 1.0, y, robot.label, color, dx=8, dy=(at - y) * points, fontsize=7.2)
    _alphas(axes, found)


def _ends(axes: Axes, found: TaskResults) -> None:
    axes.set_title("b  Where its episodes end", pad=7)
    world = found.model.world
    by_alpha = found.planned.by_alpha
    alphas = np.array([p.alpha for p in by_alpha])
    bottom = np.zeros(len(by_alpha))
    others = [g for g in range(len(world.goals)) if g != world.optimal_goal]
    middles: list[float] = []
    labels: list[tuple[str, str]] = []
    for rank, g in enumerate([world.optimal_goal, *others]):
        share = np.array([100 * float(p.summary.goals[g]) for p in by_alpha])
        color = OPTIMAL if g == world.optimal_goal else SHADES[(rank - 1) % len(SHADES)]
        axes.bar(alphas, share, width=0.17, bottom=bottom, color=color, edgecolor=PAPER, lw=0.6)
        middles.append(float(bottom[-1] + share[-1] / 2))
        labels.append((f"{world.goals[g].name}, {world.goals[g].reward:g}", color))
        bottom += share
    rest = 100 - bottom
    if rest.max() > 0.05:
        axes.bar(alphas, rest, width=0.17, bottom=bottom, color=PAPER, edgecolor=MUTED, lw=0.6)
        middles.append(float(100 - rest[-1] / 2))
        labels.append(("no goal", MUTED))
    axes.set_ylim(0, 100)
    axes.set_ylabel("% of the episodes")
    points = 0.69 * HEIGHT * 72 / 100
    for y, at, (text, color) in zip(middles, spread(middles, 9.0), labels, strict=True):
        axes.annotate(
            text,
            (1.09, y),
            xytext=(14, (at - y) * points),
            textcoords="offset points",
            va="center",
            fontsize=7.2,
            color=INK,
            annotation_clip=False,
            arrowprops={"arrowstyle": "-", "color": LINE, "lw": 0.5},
        )
        axes.annotate(
            "■",
            (1.09, y),
            xytext=(6, (at - y) * points),
            textcoords="offset points",
            va="center",
            fontsize=7.2,
            color=color,
            annotation_clip=False,
        )
    _alphas(axes, found)
    axes.set_xlim(-0.12, 1.12)


def _alphas(axes: Axes, found: TaskResults) -> None:
    axes.set_xticks([p.alpha for p in found.planned.by_alpha])
    axes.set_xlabel("adaptability α of the partner")
