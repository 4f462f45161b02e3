"""How the planner's bounds close in on the value of the task."""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from coadapt.report.figures.style import INK, LINE, MUTED, MUTUAL, PATH, WIDTH, label_line
from coadapt.report.reproduce import Reproduction


def bounds(found: Reproduction) -> Figure:
    """Left: both bounds over work. Right: the gap between them, and the one asked for."""
    trace = found.trace
    backups = np.array([record.backups for record in trace])
    lower, upper = (np.array([getattr(r, end) for r in trace]) for end in ("lower", "upper"))
    gap = np.array([record.gap for record in trace])
    figure = Figure(figsize=(WIDTH, 2.6))

    axes = figure.add_axes((0.075, 0.175, 0.32, 0.70))
    axes.fill_between(backups, lower, upper, color=LINE, alpha=0.6, linewidth=0)
    axes.plot(backups, upper, "-", color=PATH, marker="v", markersize=3.2, markeredgewidth=0)
    axes.plot(backups, lower, "-", color=MUTUAL, marker="^", markersize=3.2, markeredgewidth=0)
    axes.set_title("a  Bounds of the expected return")
    middle = (lower[-1] + upper[-1]) / 2
    height = max(float((upper - lower).max()), 1e-9)
    for dy, text, color in ((8, "upper", PATH), (-8, "lower", MUTUAL)):
        label_line(axes, float(backups[-1]), float(middle), text, color, dx=0, dy=dy, ha="right")
    axes.set_ylim(lower.min() - 0.08 * height, upper.max() + 0.08 * height)
    axes.set_xlabel("backups")

    axes = figure.add_axes((0.565, 0.175, 0.32, 0.70))
    axes.semilogy(backups, gap, "-", color=INK, marker="o", markersize=3.2, markeredgewidth=0)
    axes.axhline(found.settings.gap, color=MUTED, linewidth=1.0, linestyle=(0, (4, 2)))
    # Plain numbers: powers would be set letter by letter.
    axes.yaxis.set_major_formatter(FuncFormatter(_plain))
    wanted = f"gap of this\nreport: {found.settings.gap:g}"
    label_line(axes, 1.0, found.settings.gap, wanted, MUTED, xycoords=("axes fraction", "data"))
    axes.set_title("b  Largest gap at any first input")
    axes.set_xlabel("backups")
    for axes in figure.axes:
        axes.set_xlim(left=0)
        axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))
    return figure


def _plain(value: float, _: int | None) -> str:
    return f"{value:g}"
