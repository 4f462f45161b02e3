"""The trade-off of performance against disagreement as C varies, between the robots at its ends."""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coadapt.arrays import FloatArray
from coadapt.report.figures.conditions import spread
from coadapt.report.figures.style import (
    FIXED,
    INK,
    MUTED,
    MUTUAL,
    ONE_WAY,
    ONE_WAY_TEXT,
    WIDTH,
    label_line,
)
from coadapt.report.maps.mark import Mark
from coadapt.report.maps.phase_map import minus
from coadapt.report.maps.points import Rows, TradeOff

HEIGHT = 3.5
"""Of the figure, inches."""

APART = 0.06
"""Least distance of labelled points, as a part of the axes."""

LABELS_APART = 0.09
"""Least distance of the labels of two curves, as a part of the largest disagreement."""

ENDS = {
    "no_adaptation": ("No adaptation", FIXED, FIXED, "D"),
    "one_way_adaptation": ("One-way adaptation", ONE_WAY, ONE_WAY_TEXT, "s"),
}
"""Label, colour, colour of the label and marker of the robots at the ends."""


def trade_off(found: TradeOff, rows: Rows, mark: Mark | None) -> Figure:
    """Left: the mean over all people. Right: a curve for each adaptability."""
    figure = Figure(figsize=(WIDTH, HEIGHT))
    left = figure.add_axes((0.085, 0.14, 0.42, 0.76))
    right = figure.add_axes((0.575, 0.14, 0.4, 0.76), sharey=left)
    seen, reward = found.curve(rows, "disagreement"), found.curve(rows, "reward")
    _mean(left, found, rows, seen.mean(axis=1), reward.mean(axis=1), mark)
    tops = found.end(rows, "no_adaptation", "disagreement").tolist()
    for i, at in enumerate(spread(tops, LABELS_APART * max(tops))):
        _one(right, found, rows, i, at)
    left.set_title("All people, each adaptability alike often", pad=7)
    left.set_ylabel("mean reward of the goal reached")
    right.set_title("One curve for each adaptability α", pad=7)
    for axes in (left, right):
        axes.set_xlabel("steps in which the robot is seen to disagree")
        axes.set_xlim(0, None)
    return figure


def _mean(
    axes: Axes,
    found: TradeOff,
    rows: Rows,
    seen: FloatArray,
    reward: FloatArray,
    mark: Mark | None,
) -> None:
    axes.plot(seen, reward, "o-", color=MUTUAL, markersize=3.6, markeredgewidth=0, zorder=2)
    for robot, (label, colour, text, marker) in ENDS.items():
        x = float(found.end(rows, robot, "disagreement").mean())
        y = float(found.end(rows, robot, "reward").mean())
        axes.plot([x], [y], marker, color=colour, markersize=6, markeredgewidth=0, zorder=3)
        if robot == "no_adaptation":
            label_line(axes, x, y, label, text, dx=0, dy=10, weight="bold", ha="center")
        else:
            label_line(axes, x, y, label, text, dx=9, dy=-2, weight="bold")
    axes.margins(x=0.04, y=0.12)
    _label_costs(axes, found, seen, reward, mark)


def _label_costs(
    axes: Axes,
    found: TradeOff,
    seen: FloatArray,
    reward: FloatArray,
    mark: Mark | None,
) -> None:
    """Write C beside the points, leaving out those too close to another."""
    wide, high = float(np.ptp(seen)) or 1.0, float(np.ptp(reward)) or 1.0
    top = float(reward.max()) - 0.02 * high
    # Of the points on top, where the robot always guides, only the last.
    order = [0, *range(len(found.costs) - 1, 0, -1)]
    order = [j for j in order if reward[j] < top or j == len(found.costs) - 1]
    marked = None
    if mark is not None and mark.cost in found.costs and abs(mark.gap - found.gap) < 1e-9:
        marked = found.costs.index(mark.cost)
        order = [marked, *(j for j in order if j != marked)]
        axes.plot([seen[marked]], [reward[marked]], "*", color=INK, markersize=11, zorder=4)
    written: list[tuple[float, float]] = []
    for j in order:
        place = (float(seen[j]) / wide, float(reward[j]) / high)
        if any(np.hypot(place[0] - x, place[1] - y) < APART for x, y in written):
            continue
        written.append(place)
        text = f"C = {minus(found.costs[j])}"
        if j == marked and mark is not None:
            text += f", {mark.label}"
        on_top = reward[j] >= top
        label_line(
            axes,
            float(seen[j]),
            float(reward[j]),
            text,
            INK if j == marked else MUTED,
            dx=0 if on_top else -8,
            dy=-9 if on_top else 2,
            ha="center" if on_top else "right",
            fontsize=7,
            weight="bold" if j == marked else "normal",
        )
    j = len(found.costs) // 2 if marked is None else marked
    label_line(
        axes,
        float(seen[j]),
        float(reward[j]),
        "Mutual adaptation",
        MUTUAL,
        dx=12,
        dy=-5,
        weight="bold",
    )


def _one(axes: Axes, found: TradeOff, rows: Rows, i: int, at: float) -> None:
    """The curve of one adaptability, with its label at ``at``."""
    seen, reward = found.curve(rows, "disagreement")[:, i], found.curve(rows, "reward")[:, i]
    axes.plot(seen, reward, "-", color=MUTUAL, linewidth=1.2, zorder=2)
    for robot, (_, colour, _, marker) in ENDS.items():
        x = float(found.end(rows, robot, "disagreement")[i])
        y = float(found.end(rows, robot, "reward")[i])
        axes.plot([x], [y], marker, color=colour, markersize=4.5, markeredgewidth=0, zorder=3)
        if robot == "no_adaptation":
            axes.annotate(
                f"α = {found.alphas[i]:g}" if i == 0 else f"{found.alphas[i]:g}",
                (x, y),
                xytext=(at, y + 0.07 * float(np.ptp(reward))),
                ha="center",
                va="bottom",
                fontsize=7,
                arrowprops={"arrowstyle": "-", "color": MUTED, "linewidth": 0.6, "shrinkB": 3},
            )
