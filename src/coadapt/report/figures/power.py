"""The power curve: how often a study finds its hypothesis, by the number of participants."""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from coadapt.analysis.experiment.power import QUESTIONS, Needed, PowerPoint
from coadapt.report.figures.style import FIXED, INK, MUTED, MUTUAL, ONE_WAY_TEXT, PATH

COLORS = (PATH, MUTUAL, ONE_WAY_TEXT)
MARKERS = ("o", "s", "^")
LABELS = (
    "all of H1",
    "mutual better than one-way",
    "no adaptation better than mutual",
)
APART = 0.055
"""Smallest distance between labels, as a part of the axis."""


def power(
    points: Sequence[PowerPoint],
    needed: Sequence[Needed],
    wanted: float,
    population: str,
) -> Figure:
    """One curve for each of `QUESTIONS`, and the answer where the wanted power is reached."""
    figure = Figure(figsize=(6.4, 3.8))
    axes = figure.add_axes((0.095, 0.13, 0.6, 0.76))
    n = np.array([point.n for point in points])
    ends: list[float] = []
    for q in reversed(range(len(QUESTIONS))):
        values = np.array([point.power[q] for point in points])
        low, high = (np.array([getattr(p, e)[q] for p in points]) for e in ("low", "high"))
        main = q == 0
        axes.fill_between(n, low, high, color=COLORS[q], alpha=0.18, linewidth=0)
        axes.plot(
            n,
            values,
            marker=MARKERS[q],
            color=COLORS[q],
            markersize=4.5 if main else 3.2,
            markeredgewidth=0,
            linewidth=2.2 if main else 1.2,
            zorder=3 if main else 2,
        )
        ends.append(float(values[-1]))
    ends.reverse()
    for q, y in enumerate(_apart(ends)):
        axes.annotate(
            LABELS[q],
            (1.0, y),
            xycoords=("axes fraction", "data"),
            xytext=(6, 0),
            textcoords="offset points",
            color=COLORS[q],
            va="center",
            weight="bold" if q == 0 else "normal",
            annotation_clip=False,
        )
    axes.axhline(wanted, color=MUTED, linewidth=0.9, linestyle=(0, (4, 3)), zorder=1)
    axes.set_xlim(0, float(n[-1]) * 1.02)
    axes.set_ylim(0, 1.02)
    axes.yaxis.set_major_formatter(PercentFormatter(1.0))
    axes.set_xlabel("participants in each of the three conditions")
    axes.set_ylabel("probability that the study finds it")
    axes.set_title(_answer(needed[0], wanted, int(n[-1])), color=INK, pad=12)
    if needed[0].n is not None:
        axes.plot([needed[0].n] * 2, [0, wanted], color=PATH, linewidth=1.2, zorder=1)
        axes.annotate(
            f"{needed[0].n}",
            (needed[0].n, 0),
            xytext=(4, 4),
            textcoords="offset points",
            color=PATH,
            weight="bold",
            fontsize=10,
        )
    figure.text(
        0.71,
        0.13,
        f"{population}\npoints: {points[0].experiments:,} simulated\nexperiments each; bands: 95 %",
        color=FIXED,
        fontsize=7,
        va="bottom",
    )
    return figure


def _answer(needed: Needed, wanted: float, largest: int) -> str:
    if needed.n is None:
        return f"{wanted:.0%} power for H1 needs more than {largest} participants in each condition"
    return f"{needed.n} participants in each condition give {wanted:.0%} power for H1"


def _apart(values: list[float]) -> list[float]:
    """Where to write the labels: at the values, moved down so that none covers another."""
    order = sorted(range(len(values)), key=lambda i: (-values[i], -i))
    placed = list(values)
    for above, below in pairwise(order):
        placed[below] = min(placed[below], placed[above] - APART)
    return placed
