"""Performance, subjective measures, and one against the other (the paper's Fig. 6)."""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy import stats

from coadapt.analysis.analyse import Analysis
from coadapt.analysis.tests.result import LEVEL
from coadapt.analysis.verdicts import value_of
from coadapt.arrays import FloatArray
from coadapt.hypotheses import PERFORMANCE
from coadapt.report.figures.style import INK, MUTED, WIDTH
from coadapt.report.study.looks import looks, text_color, title_of, two_lines

HEIGHT = 2.55
"""Of the figure, inches."""

MOST_SCALES = 3
"""Scales that are drawn; the tables have all."""

MARKERS = ("o", "s", "^")
"""Of the scales."""


def mean_interval(values: FloatArray) -> tuple[float, float, float]:
    """Mean and its 95 % interval by Student's t; where values are equal, the value alone."""
    mean = float(values.mean())
    if len(values) < 2 or np.ptp(values) == 0:
        return mean, mean, mean
    error = float(stats.sem(values)) * float(stats.t.isf((1 - LEVEL) / 2, len(values) - 1))
    return mean, mean - error, mean + error


def values_of(found: Analysis, outcome: str) -> dict[str, FloatArray]:
    """By condition, the values of an outcome; conditions without any are left out."""
    result: dict[str, FloatArray] = {}
    for condition in found.data.conditions:
        people = [p for p in found.people if p.condition == condition]
        values = [value_of(person, outcome) for person in people]
        given = [value for value in values if value is not None]
        if given:
            result[condition] = np.array(given, dtype=np.float64)
    return result


def panels(found: Analysis) -> Figure:
    """The figure; without ratings its first panel alone."""
    scales = [scale.scale for scale in found.scales][:MOST_SCALES]
    performance = values_of(found, PERFORMANCE)
    drawn = [name for name, there in (("a", performance), ("b", scales)) if there]
    if performance and scales:
        drawn.append("c")
    width = WIDTH if len(drawn) == 3 else WIDTH * max(1, len(drawn)) / 2.6
    figure = Figure(figsize=(width, HEIGHT))
    axes = figure.subplots(1, max(1, len(drawn)), squeeze=False)[0]
    for letter, axis in zip(drawn, axes, strict=False):
        if letter == "a":
            _performance(axis, found, performance)
        elif letter == "b":
            _ratings(axis, found, scales)
        else:
            _against(axis, found, performance, scales[0])
    if not drawn:
        axes[0].set_axis_off()
        axes[0].text(0.5, 0.5, "No performance and no ratings", ha="center", color=MUTED)
    bottom, wide = 0.2, width / WIDTH
    figure.subplots_adjust(left=0.075 / wide, right=0.985, top=0.88, bottom=bottom, wspace=0.36)
    return figure


def _conditions(axes: Axes, names: Sequence[str]) -> None:
    axes.set_xticks(range(len(names)), [two_lines(name) for name in names], fontsize=6.6)
    axes.set_xlim(-0.6, len(names) - 0.4)


def _performance(axes: Axes, found: Analysis, values: dict[str, FloatArray]) -> None:
    style = looks(found.data.conditions)
    for i, (name, given) in enumerate(values.items()):
        color, marker = style[name]
        levels, counts = np.unique(np.round(given, 9), return_counts=True)
        for level, count in zip(levels, counts, strict=True):
            width = min(0.3, 0.035 * (count - 1))
            xs = i + np.linspace(-width, width, int(count)) if count > 1 else np.array([float(i)])
            axes.scatter(xs, np.full(count, level), s=7, color=color, alpha=0.35, linewidths=0)
        mean, low, high = mean_interval(given)
        axes.plot([i, i], [low, high], color=color, linewidth=1.4)
        axes.scatter([i], [mean], s=22, color=color, edgecolors=INK, marker=marker, zorder=5)
    axes.set_title("a  Performance", pad=8)
    axes.set_ylabel("mean reward", fontsize=7.4)
    _conditions(axes, list(values))


def _ratings(axes: Axes, found: Analysis, scales: Sequence[str]) -> None:
    style, conditions = looks(found.data.conditions), found.data.conditions
    for j, scale in enumerate(scales):
        values = values_of(found, scale)
        for i, name in enumerate(conditions):
            if name not in values:
                continue
            x = i + 0.26 * (j - (len(scales) - 1) / 2)
            mean, low, high = mean_interval(values[name])
            color = style[name][0]
            axes.plot([x, x], [low, high], color=color, linewidth=1.4)
            filled = color if j % 2 == 0 else "none"
            axes.scatter(
                [x], [mean], s=24, marker=MARKERS[j], facecolors=filled, edgecolors=color, zorder=4
            )
    for j, scale in enumerate(scales):
        axes.scatter(
            [],
            [],
            s=20,
            marker=MARKERS[j],
            facecolors=MUTED if j % 2 == 0 else "none",
            edgecolors=MUTED,
            label=title_of(scale),
        )
    points = max(len(s.points) for s in found.data.declared.scales)
    axes.set_ylim(0.9, points + 0.1)
    axes.set_yticks(range(1, points + 1))
    axes.legend(
        frameon=False, fontsize=6.6, loc="lower left", handletextpad=0.1, borderpad=0, ncols=2
    )
    axes.set_title("b  Ratings", pad=8)
    axes.set_ylabel("points", fontsize=7.4)
    _conditions(axes, conditions)


def _against(axes: Axes, found: Analysis, values: dict[str, FloatArray], scale: str) -> None:
    style, ratings = looks(found.data.conditions), values_of(found, scale)
    centres: dict[str, tuple[float, float]] = {}
    for name, given in values.items():
        if name not in ratings:
            continue
        color, marker = style[name]
        x, x_low, x_high = mean_interval(ratings[name])
        y, y_low, y_high = mean_interval(given)
        axes.plot([x_low, x_high], [y, y], color=color, linewidth=1.2)
        axes.plot([x, x], [y_low, y_high], color=color, linewidth=1.2)
        axes.scatter([x], [y], s=30, color=color, marker=marker, zorder=4, linewidths=0)
        centres[name] = x, y
    axes.margins(0.18, 0.2)
    low, high = axes.get_xlim()
    for name, (x, y) in centres.items():
        on_left = x > (low + high) / 2
        axes.annotate(
            two_lines(name),
            (x, y),
            xytext=(-5 if on_left else 5, 3),
            textcoords="offset points",
            ha="right" if on_left else "left",
            va="bottom",
            linespacing=0.95,
            fontsize=6.6,
            color=text_color(style[name][0]),
        )
    axes.set_title(f"c  Reward against {title_of(scale).lower()}", pad=8)
    axes.set_xlabel(f"{title_of(scale).lower()}, points", fontsize=7.4)
    axes.set_ylabel("mean reward", fontsize=7.4)
