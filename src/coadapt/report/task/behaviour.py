"""What the planned robot does, on a map: with a partner who adapts and one who does not."""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from coadapt.arrays import FloatArray
from coadapt.formalism import Model
from coadapt.report.figures.style import INK, LINE, MUTED, PAPER, PATH, SURFACE, WIDTH
from coadapt.report.task.results import Performance, TaskResults

WIDEST = 5.0
"""Points: width of a line that every episode follows once."""

THINNEST = 0.3

MOST_HEIGHT = 4.4
"""Of the figure, inches."""

HEAD = 0.62
"""Room for the titles and the labels of the uppermost goals, inches."""

CURVE = 0.07
"""How far ways there and back bend apart, as a part of their length."""

FEW_STATES = 8
"""Up to so many states are drawn with their names."""


def behaviour(found: TaskResults) -> Figure:
    """Two maps side by side; the width of a line is how often its move is made in an episode."""
    low, high = _extent(found.model)
    across, ahead = (float(size) for size in high - low)
    panel = 0.47 * WIDTH
    height = min(MOST_HEIGHT, panel * ahead / across + HEAD)
    figure = Figure(figsize=(WIDTH, height))
    least, most = found.planned.by_alpha[0], found.planned.by_alpha[-1]
    begins = found.model.mode_names[found.first_mode]
    for i, (shown, kind) in enumerate(((least, "does not adapt"), (most, "adapts"))):
        left = 0.015 + 0.505 * i
        top = 1 - 0.16 / height
        title = f"{'ab'[i]}  A partner who {kind}, α = {shown.alpha:g}"
        figure.text(left, top, title, fontsize=8.5, fontweight="bold", va="center")
        under = top - 0.16 / height
        figure.text(left, under, f"begins in mode “{begins}”", fontsize=7, color=MUTED, va="center")
        axes = figure.add_axes((left, 0.0, 0.47, 1 - HEAD / height))
        axes.set_anchor("N")
        _map(axes, found.model, shown)
    return figure


def _extent(model: Model) -> tuple[FloatArray, FloatArray]:
    """The corners of the drawing, in the world's units; never much longer than wide."""
    place = model.world.positions
    low, high = place.min(axis=0), place.max(axis=0)
    room = 0.12 * max(float((high - low).max()), 1.0)
    return low - room, high + room


def _map(axes: Axes, model: Model, shown: Performance) -> None:
    world, place = model.world, model.world.positions
    axes.set_axis_off()
    axes.set_aspect("equal")
    low, high = _extent(model)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    if np.array_equal(place, place.round()):
        # Cells of a grid: where there are none are obstacles.
        cells = [Rectangle((x - 0.46, y - 0.46), 0.92, 0.92) for x, y in place.tolist()]
        axes.add_collection(PatchCollection(cells, facecolor=SURFACE, edgecolor="none", zorder=0))
    else:
        axes.plot(place[:, 0], place[:, 1], "o", color=LINE, markersize=4, markeredgewidth=0)
    for here, there in sorted(shown.flow, key=lambda way: shown.flow[way]):
        if here != there:
            _way(axes, place[here], place[there], shown.flow[here, there])
    for start in world.start_chances:
        axes.plot(*place[start], "o", color="none", markeredgecolor=INK, markersize=7, zorder=5)
    if world.states <= FEW_STATES:
        for state, name in enumerate(world.state_names):
            if world.goal_at(state) is None:
                _name(axes, place[state], name, MUTED, up=False, inside=False)
    else:
        _name(axes, place[world.start], "start", MUTED, up=False)
    middle = (low[1] + high[1]) / 2
    for g, goal in enumerate(world.goals):
        region = place[list(goal.states)]
        fill = INK if g == world.optimal_goal else PAPER
        axes.plot(
            *(region[:, 0], region[:, 1], "s"),
            color=fill,
            markeredgecolor=INK,
            markersize=8,
            zorder=6,
        )
        centre = region.mean(axis=0)
        share = f"{100 * float(shown.summary.goals[g]):.0f} %"
        text = f"{goal.name}, {goal.reward:g}\n{share}{' end here' if len(world.goals) < 3 else ''}"
        side = _side(world.positions, [other.states for other in world.goals], g)
        _name(axes, centre, text, INK, up=bool(centre[1] >= middle), side=side)


def _side(place: FloatArray, goals: Sequence[Sequence[int]], g: int) -> str | None:
    """Where the label of goal ``g`` has room: left or right if another goal is close beside it."""
    centres = np.array([place[list(states)].mean(axis=0) for states in goals])
    aside, ahead = (centres - centres[g]).T
    wide = np.ptp(place[:, 0])
    beside = (np.abs(ahead) < 0.15 * max(np.ptp(place[:, 1]), 1.0)) & (aside != 0)
    close = aside[beside & (np.abs(aside) < max(0.3 * wide, 1.5))]
    if len(close) == 0 or (close.min() < 0 < close.max()):
        return None
    return "right" if close.min() > 0 else "left"


def _name(
    axes: Axes,
    where: FloatArray,
    text: str,
    color: str,
    *,
    up: bool,
    inside: bool = True,
    side: str | None = None,
) -> None:
    low, high = axes.get_xlim()
    part = (where[0] - low) / (high - low)
    if side is None and inside:
        side = "left" if part < 0.15 else "right" if part > 0.85 else None
    axes.annotate(
        text,
        (float(where[0]), float(where[1])),
        xytext=(0, 7 if up else -7),
        textcoords="offset points",
        ha=side or "center",
        va="bottom" if up else "top",
        color=color,
        fontsize=6.5,
        zorder=7,
        annotation_clip=False,
    )


def _way(axes: Axes, here: FloatArray, there: FloatArray, often: float) -> None:
    """A bent line from one place to another, thinner and paler the less it is used."""
    along = there - here
    aside = np.array([-along[1], along[0]]) * CURVE
    t = np.linspace(0, 1, 12)[:, None]
    points = (1 - t) * here + t * there + 4 * t * (1 - t) * aside
    part = min(often, 1.0)
    width = max(THINNEST, WIDEST * part) * np.linspace(1, 0.4, len(points) - 1)
    shade = np.array(to_rgb(PATH)) * (0.35 + 0.65 * part) + (0.65 - 0.65 * part)
    pieces = np.stack([points[:-1], points[1:]], axis=1)
    axes.add_collection(
        LineCollection(
            list(pieces),
            colors=to_hex((float(shade[0]), float(shade[1]), float(shade[2]))),
            linewidths=width.tolist(),
            capstyle="round",
            zorder=4,
        )
    )
