"""Whether fits find what was put in: recovered against true means, coverage, widths."""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from coadapt.analysis.adaptability.recovery import Recovery
from coadapt.report.figures.style import LINE, MUTED, MUTUAL, PATH, WIDTH

WANTED = (0.93, 0.97)
"""The band of coverage that is shaded."""


def recovery(found: Sequence[Recovery]) -> Figure:
    """Three panels over the true mean; populations of people alike, and spread ones."""
    figure = Figure(figsize=(WIDTH, 2.7), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    for alike, color, marker, label in (
        (True, MUTUAL, "o", "everybody alike"),
        (False, PATH, "s", "a spread population"),
    ):
        some = sorted((r for r in found if (r.sd is None) == alike), key=lambda r: r.mean.true)
        if some:
            _draw(left, middle, right, some, color, marker, label)
    left.plot([0, 1], [0, 1], color=MUTED, linewidth=0.8, zorder=0)
    left.set_title("Recovered mean, 95 % of studies")
    left.set_ylabel("fitted mean of α")
    left.legend(frameon=False, fontsize=6.5, loc="upper left")
    middle.axhspan(*WANTED, color=LINE, alpha=0.6, linewidth=0)
    middle.axhline(0.95, color=MUTED, linewidth=0.8, zorder=0)
    middle.set_ylim(0.88, 1.005)
    middle.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    middle.set_title("Intervals that hold the truth")
    middle.set_ylabel("coverage of 95 % intervals")
    right.set_ylim(0, None)
    right.set_title("Width of the intervals")
    right.set_ylabel("mean width")
    for axes in (left, middle, right):
        axes.set_xlim(-0.04, 1.04)
        axes.set_xlabel("true mean of α")
    return figure


def _draw(
    left: Axes,
    middle: Axes,
    right: Axes,
    some: Sequence[Recovery],
    color: str,
    marker: str,
    label: str,
) -> None:
    means = [r.mean for r in some]
    true = np.array([r.true for r in means])
    style: dict[str, Any] = {"color": color, "markersize": 3.8, "elinewidth": 1.0}
    style["markeredgewidth"] = 0
    centre = np.array([np.median(r.estimate) for r in means])
    ends = np.array([np.quantile(r.estimate, (0.025, 0.975)) for r in means]).T
    reach = np.abs(ends - centre)
    left.errorbar(true, centre, yerr=reach, fmt=marker, capsize=1.8, label=label, **style)
    share = np.array([r.coverage for r in means])
    bounds = np.array([r.coverage_interval for r in means]).T
    middle.errorbar(true, share, yerr=np.abs(bounds - share), fmt=marker, capsize=1.8, **style)
    right.plot(true, [r.width for r in means], marker, color=color, markersize=3.8)
