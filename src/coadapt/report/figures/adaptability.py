"""What a fit found: every participant's adaptability, and its distribution among them."""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coadapt.analysis.adaptability.fit import AdaptabilityFit
from coadapt.report.figures.style import INK, LINE, MUTED, MUTUAL, PATH, WIDTH

NAMED = 40
"""More participants are drawn without their names."""


def adaptability(found: AdaptabilityFit) -> Figure:
    """Participants on the left, each with a credible interval; the population on the right."""
    count = len(found.recordings)
    figure = Figure(figsize=(WIDTH, 1.6 + 0.14 * min(count, NAMED)), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    _participants(left, found)
    _population(right, found)
    return figure


def _participants(axes: Axes, found: AdaptabilityFit) -> None:
    order = np.argsort(found.posterior.mean, kind="stable")
    mean, ends = found.posterior.mean[order], found.posterior.interval(found.level)[order]
    rows = np.arange(len(order))
    axes.axvspan(found.mean.low, found.mean.high, color=LINE, alpha=0.6, linewidth=0)
    axes.axvline(found.mean.estimate, color=PATH, linewidth=1.2)
    axes.hlines(rows, ends[:, 0], ends[:, 1], color=MUTUAL, linewidth=1.1)
    axes.plot(mean, rows, "o", color=MUTUAL, markersize=3.6, markeredgewidth=0)
    axes.set_yticks(rows if len(rows) <= NAMED else [])
    if len(rows) <= NAMED:
        names = [found.recordings.names[i] for i in map(int, order)]
        axes.set_yticklabels(names, fontsize=6.5)
    axes.set_ylim(-0.7, len(rows) + 0.6)
    axes.set_xlim(-0.02, 1.02)
    axes.set_xlabel("adaptability α")
    axes.set_ylabel("participants")
    axes.set_title(f"Each participant, {100 * found.level:g} % credible intervals")
    axes.annotate(
        "population mean",
        (found.mean.estimate, len(rows) + 0.6),
        xytext=(4, -2),
        textcoords="offset points",
        color=PATH,
        va="top",
        fontsize=7,
    )


def _population(axes: Axes, found: AdaptabilityFit) -> None:
    edges = np.linspace(0, 1, 11)
    weights = found.population.weights(found.posterior.prior.size)
    bars, _ = np.histogram(found.posterior.alpha, bins=edges, weights=weights)
    axes.bar(
        edges[:-1], bars, width=0.1, align="edge", color=LINE, edgecolor="white", linewidth=0.8
    )
    axes.plot([], [], "s", color=LINE, label="beta distribution, tenths of the range")
    values = np.array(found.weights.values)
    share = np.array([w.estimate for w in found.weights.weights])
    low, high = (np.array([getattr(w, e) for w in found.weights.weights]) for e in ("low", "high"))
    axes.errorbar(
        values,
        share,
        yerr=np.maximum(np.stack([share - low, high - share]), 0),
        fmt="o",
        color=INK,
        markersize=4,
        elinewidth=1.1,
        capsize=2.2,
        label="weights of single values",
    )
    axes.set_xlim(-0.05, 1.05)
    axes.set_ylim(0, 1.3)
    axes.set_yticks(np.linspace(0, 1, 6))
    axes.set_xlabel("adaptability α")
    axes.set_ylabel("share of people")
    axes.set_title("The population")
    both = "\n".join(
        f"{name} {value.estimate:.2f} ({value.low:.2f} to {value.high:.2f})"
        for name, value in (("mean", found.mean), ("SD", found.sd))
    )
    axes.legend(
        frameon=False,
        fontsize=6.5,
        loc="upper left",
        labelcolor=MUTED,
        title=both,
        alignment="left",
    )
