"""The three conditions of Sec. 6.1 side by side, over the adaptability of the user."""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coadapt.report.figures.style import (
    FIXED,
    MUTUAL,
    ONE_WAY,
    ONE_WAY_TEXT,
    WIDTH,
    label_line,
)
from coadapt.report.performance import RobotResult
from coadapt.report.reproduce import Reproduction

LOOKS = {
    "No adaptation": (FIXED, "D", (0, (1, 1.2))),
    "Mutual adaptation": (MUTUAL, "o", "-"),
    "One-way adaptation": (ONE_WAY, "s", (0, (4, 1.6))),
}
"""Colour, marker and dashes of each condition."""

HEIGHT = 4.6
"""Of the figure, inches."""

PANEL_WIDTH, PANEL_HEIGHT = 0.28, 0.365
"""Of each panel, as parts of the figure's."""

SPREAD = 0.075
"""Least distance between two labels, as a part of the axis."""


def conditions(found: Reproduction) -> Figure:
    """Four panels: reward, how often the optimal goal, steps, disagreement; all exact."""
    robots = found.conditions
    panels = (
        ("a  Reward of the goal reached", [[e.reward for e in r.exact] for r in robots]),
        ("b  Optimal goal reached, %", [[100 * p for p in r.optimal] for r in robots]),
        ("c  Robot actions until a goal", [[e.steps for e in r.exact] for r in robots]),
        (
            "d  Steps seen as disagreement",
            [[e.disagreement for e in r.exact] for r in robots],
        ),
    )
    figure = Figure(figsize=(WIDTH, HEIGHT))
    for i, (title, values) in enumerate(panels):
        row, column = divmod(i, 2)
        axes = figure.add_axes(
            (0.055 + column * 0.5, 0.575 - row * 0.485, PANEL_WIDTH, PANEL_HEIGHT)
        )
        _panel(axes, title, robots, values)
        if row == 1:
            axes.set_xlabel("adaptability α of the user")
    return figure


def _panel(
    axes: Axes, title: str, robots: Sequence[RobotResult], values: Sequence[Sequence[float]]
) -> None:
    for robot, ys in zip(robots, values, strict=True):
        color, marker, dashes = LOOKS[robot.condition]
        axes.plot(
            robot.alpha,
            ys,
            marker=marker,
            linestyle=dashes,
            color=color,
            markersize=4.0,
            markeredgewidth=0,
            clip_on=False,
            zorder=3,
        )
    axes.set_title(title, pad=7)
    axes.set_xlim(0, 1)
    axes.set_xticks(robots[0].alpha)
    flat = [y for ys in values for y in ys]
    margin = 0.07 * (max(flat) - min(flat)) or 0.5
    axes.set_ylim(min(flat) - margin, max(flat) + margin)
    low, high = axes.get_ylim()
    places = spread([ys[-1] for ys in values], SPREAD * (high - low))
    points = PANEL_HEIGHT * HEIGHT * 72 / (high - low)
    for robot, ys, place in zip(robots, values, places, strict=True):
        color, _, _ = LOOKS[robot.condition]
        color = ONE_WAY_TEXT if color == ONE_WAY else color
        dy = (place - ys[-1]) * points
        label_line(axes, 1.0, ys[-1], robot.condition, color, dx=7, dy=dy, fontsize=7.2)


def spread(wanted: Sequence[float], least: float) -> list[float]:
    """Places near ``wanted`` in the same order, at least ``least`` apart."""
    order = np.argsort(np.array(wanted), kind="stable")
    places = np.array(wanted, dtype=np.float64)[order]
    for _ in range(100):
        close = np.diff(places) < least - 1e-9
        if not close.any():
            break
        for i in np.flatnonzero(close):
            middle = (places[i] + places[i + 1]) / 2
            places[i], places[i + 1] = middle - least / 2, middle + least / 2
    result = np.empty(len(places))
    result[order] = places
    return [float(place) for place in result]
