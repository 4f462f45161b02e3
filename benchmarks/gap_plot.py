"""The figure of `solve.py`: how the gap of both solvers closes over time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from comparison import Point
from matplotlib.figure import Figure

from coadapt.report.figures.style import MUTED, MUTUAL, PATH, WIDTH, render, settings

COLUMNS = 4
HEIGHT = 1.5
"""Inches of a panel."""

EARLIEST = 1e-3
"""Seconds; what happens before is drawn at this time."""


def draw_gaps(
    panels: Sequence[tuple[str, Sequence[Point], Sequence[Point]]], precision: float, out: Path
) -> None:
    """Write `gap.svg` and `gap.png` to ``out``.

    Args:
        panels: for each problem its name, our trace and the reference's; either may be empty.
        precision: the gap at which the solvers finish.
        out: a directory.
    """
    if not panels:
        return
    rows = math.ceil(len(panels) / COLUMNS)
    with settings():
        figure = Figure(figsize=(WIDTH, rows * HEIGHT + 0.4), layout="constrained")
        for i, (name, ours, reference) in enumerate(panels, start=1):
            axes = figure.add_subplot(rows, COLUMNS, i, xscale="log", yscale="log")
            axes.set_title(name, fontsize=6.5)
            axes.tick_params(labelsize=5.5, which="both")
            for trace, color, label in ((reference, PATH, "reference"), (ours, MUTUAL, "coadapt")):
                seconds = [max(point.seconds, EARLIEST) for point in trace]
                gaps = [max(point.upper - point.lower, precision / 2) for point in trace]
                axes.plot(seconds, gaps, color=color, label=label, drawstyle="steps-post", lw=1.1)
            axes.axhline(precision, color=MUTED, lw=0.6, linestyle=(0, (4, 2)))
            if i == 1:
                axes.legend(fontsize=5.5, frameon=False)
        figure.supxlabel("seconds of solving", fontsize=7)
        figure.supylabel("gap between the bounds", fontsize=7)
        for kind in ("svg", "png"):
            (out / f"gap.{kind}").write_bytes(render(figure, kind))
