"""The phase map: where the robot guides, probes and complies, over C and the gap of rewards."""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, to_rgba
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from scipy.ndimage import distance_transform_edt

from coadapt.arrays import BoolArray, FloatArray
from coadapt.report.figures.style import INK, MUTED, MUTUAL, PAPER, WIDTH
from coadapt.report.maps.mark import Mark
from coadapt.report.maps.points import Map, Rows
from coadapt.simulation.conduct import Phase, phase

HEIGHT = 4.35
"""Of the figure, inches."""

GUIDES = MUTUAL
PROBES = ("#fbe3c0", "#e39a3b", "#b4530a")
COMPLIES = "#f6f7f8"

STEPS = (1.0, 2.0, 3.0, 4.0)
"""Contours of the number of steps in which the robot insists."""

EDGE = 0.23
"""Least distance of the middle of a name from the sides, as a part of the axis."""

SMALLEST = 0.04
"""Part of the map that a region needs to be named."""

MOST_STEPS = 5.0
"""Where the colour of probing ends."""


def phase_map(found: Map, others: Sequence[Map], rows: Rows, mark: Mark | None) -> Figure:
    """The phases with somebody who never adapts; beside them what becomes of people who do.

    Args:
        found: of people with alpha 0.
        others: of people who adapt, up to four.
        rows: the results.
        mark: a setting to be marked.
    """
    figure = Figure(figsize=(WIDTH, HEIGHT) if others else (4.6, HEIGHT))
    wide = 0.5 if others else 0.84
    axes = figure.add_axes((0.075 if others else 0.12, 0.115, wide, 0.8))
    _phases(axes, found, rows, mark)
    for i, other in enumerate(others[:4]):
        row, column = divmod(i, 2)
        small = figure.add_axes((0.66 + 0.18 * column, 0.535 - 0.42 * row, 0.15, 0.34))
        _outcomes(small, other, rows, mark)
        if row == 1 or i + 2 >= len(others):
            small.set_xlabel("C", labelpad=1)
        if column == 1:
            small.set_yticklabels([])
    if others:
        figure.text(0.66, 0.955, "People who adapt: how many", fontsize=8.5, weight="bold")
        figure.text(0.66, 0.92, "end at the better goal", fontsize=8.5, weight="bold")
        figure.text(0.985, 0.925, "line: half", fontsize=7, ha="right")
    return figure


def _phases(axes: Axes, found: Map, rows: Rows, mark: Mark | None) -> None:
    optimal, insisting = found.values(rows, "exact_optimal"), found.values(rows, "exact_insisting")
    kinds = np.array(
        [
            [phase(p, n) if np.isfinite(p) else None for p, n in zip(*line, strict=True)]
            for line in zip(optimal, insisting, strict=True)
        ]
    )
    probing = LinearSegmentedColormap.from_list("probing", PROBES)
    colours = np.ones((*optimal.shape, 4))
    for (i, j), kind in np.ndenumerate(kinds):
        if kind is Phase.GUIDES:
            colours[i, j] = to_rgba(GUIDES)
        elif kind is Phase.PROBES:
            colours[i, j] = probing(min(1.0, insisting[i, j] / MOST_STEPS))
        elif kind is Phase.COMPLIES:
            colours[i, j] = to_rgba(COMPLIES)
    _frame(axes, found)
    axes.pcolormesh(edges(found.costs), edges(found.gaps), colours, rasterized=True, zorder=0)
    _boundary(axes, found, kinds == Phase.GUIDES, PAPER)
    _boundary(axes, found, kinds == Phase.COMPLIES, MUTED)
    _step_contours(axes, found, np.where(kinds == Phase.GUIDES, np.nan, insisting))
    axes.set_title("What the robot does with somebody who never adapts", pad=7)
    axes.set_xlabel("C, the penalty for a step in disagreement")
    axes.set_ylabel("R$_{opt}$ − R$_{sub}$, what the better goal is worth more")
    guides = "GUIDES\nends at the better goal\nwhatever they ask"
    probes = "PROBES,\nTHEN COMPLIES\nlines: steps it insists"
    _name(axes, kinds == Phase.GUIDES, found, guides, PAPER, GUIDES)
    _name(axes, kinds == Phase.PROBES, found, probes, INK, PROBES[0])
    _name(axes, kinds == Phase.COMPLIES, found, "COMPLIES\nfrom the start", INK, COMPLIES)
    _mark(axes, mark, large=True)


def _outcomes(axes: Axes, found: Map, rows: Rows, mark: Mark | None) -> None:
    shares = 100 * found.values(rows, "optimal")
    colours = LinearSegmentedColormap.from_list("share", (COMPLIES, "#9cc3de", GUIDES))
    _frame(axes, found)
    axes.pcolormesh(
        edges(found.costs),
        edges(found.gaps),
        shares,
        cmap=colours,
        vmin=0,
        vmax=100,
        rasterized=True,
        zorder=0,
    )
    if np.nanmin(shares) < 50 < np.nanmax(shares):
        axes.contour(found.costs, found.gaps, shares, levels=[50], colors=[INK], linewidths=0.9)
    axes.set_title(f"α = {found.alpha:g}", fontsize=8, pad=3)
    axes.tick_params(labelsize=6.5)
    for (x, y), value in (((0.05, 0.05), shares[0, 0]), ((0.95, 0.95), shares[-1, -1])):
        axes.text(
            x,
            y,
            f"{value:.0f} %",
            transform=axes.transAxes,
            fontsize=6.5,
            ha="left" if x < 0.5 else "right",
            va="bottom" if y < 0.5 else "top",
            color=PAPER if value > 60 else INK,
        )
    _mark(axes, mark, large=False)


def _frame(axes: Axes, found: Map) -> None:
    costs, gaps = edges(found.costs), edges(found.gaps)
    axes.set_xlim(costs[0], costs[-1])
    axes.set_ylim(gaps[0], gaps[-1])


def edges(centres: FloatArray) -> FloatArray:
    """``[N + 1]`` the borders of cells around ``[N]`` increasing centres."""
    middle = (centres[1:] + centres[:-1]) / 2
    first, last = 2 * centres[0] - middle[0], 2 * centres[-1] - middle[-1]
    return np.concatenate([[first], middle, [last]])


def _boundary(axes: Axes, found: Map, inside: BoolArray, colour: str) -> None:
    """Draw the border of a region along the borders of its cells."""
    costs, gaps = edges(found.costs), edges(found.gaps)
    for i, j in np.argwhere(inside[:, 1:] != inside[:, :-1]):
        axes.plot([costs[j + 1]] * 2, gaps[i : i + 2], color=colour, linewidth=1.1)
    for i, j in np.argwhere(inside[1:] != inside[:-1]):
        axes.plot(costs[j : j + 2], [gaps[i + 1]] * 2, color=colour, linewidth=1.1)


def _step_contours(axes: Axes, found: Map, insisting: FloatArray) -> None:
    """Lines of equal numbers of steps, each with its number where it begins on the left."""
    for level in STEPS:
        lines = axes.contour(
            found.costs, found.gaps, insisting, levels=[level], colors=[INK], linewidths=0.6
        )
        parts = [part for part in lines.allsegs[0] if len(part) > 1]
        if not parts:
            continue
        longest = max(parts, key=len)
        if longest[0, 0] > longest[-1, 0]:
            longest = longest[::-1]
        # Further along from level to level, so that the numbers do not meet.
        x, y = longest[int((0.06 * level - 0.02) * len(longest))].tolist()
        _write(axes, x, y, f"{level:g}", INK, PROBES[0], fontsize=7.2, ha="center")


def _name(axes: Axes, inside: BoolArray, found: Map, text: str, colour: str, halo: str) -> None:
    """Write ``text`` in a region, farthest from its borders."""
    if inside.mean() < SMALLEST:
        return
    depth: FloatArray = distance_transform_edt(np.pad(inside, 1))[1:-1, 1:-1]
    i, j = np.unravel_index(int(depth.argmax()), depth.shape)
    left, right = axes.get_xlim()
    margin = EDGE * (right - left)
    x = min(max(found.costs.tolist()[int(j)], left + margin), right - margin)
    y = found.gaps.tolist()[int(i)]
    _write(axes, x, y, text, colour, halo, ha="center", weight="bold")


def _write(axes: Axes, x: float, y: float, text: str, colour: str, halo: str, **kw: Any) -> None:
    """Text that stays readable on what lies under it."""
    axes.text(
        x,
        y,
        text,
        color=colour,
        va="center",
        path_effects=[withStroke(linewidth=2.2, foreground=halo)],
        zorder=4,
        **kw,
    )


def _mark(axes: Axes, mark: Mark | None, *, large: bool) -> None:
    if mark is None:
        return
    low, high = sorted(axes.get_xlim())
    bottom, top = axes.get_ylim()
    if not (low <= mark.cost <= high and bottom <= mark.gap <= top):
        return
    size = 9 if large else 5
    axes.plot(
        [mark.cost],
        [mark.gap],
        marker="*",
        markersize=size + 4,
        color=PAPER,
        markeredgewidth=0,
        zorder=5,
    )
    axes.plot(
        [mark.cost], [mark.gap], marker="*", markersize=size, color=INK, markeredgewidth=0, zorder=5
    )
    if large:
        axes.annotate(
            f"{mark.label}\nC = {minus(mark.cost)}, gap {mark.gap:g}",
            (mark.cost, mark.gap),
            xytext=(13, 12),
            textcoords="offset points",
            fontsize=7.5,
            va="center",
            bbox={"facecolor": PAPER, "edgecolor": "none", "pad": 2},
            zorder=6,
        )


def minus(x: float) -> str:
    """A number with a true minus sign."""
    return f"{x:g}".replace("-", "\u2212")
