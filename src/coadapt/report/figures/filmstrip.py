"""One user's sample run, step by step: the table, the belief over alpha, the belief over modes.

A strip has some seventy small panels, so it is drawn on one set of axes whose unit is the point.
"""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, PathPatch, Polygon, Rectangle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

from coadapt.arrays import FloatArray
from coadapt.formalism import SharedAutonomy
from coadapt.report.figures.style import HUMAN, INK, LINE, MUTED, PAPER, PATH, ROBOT, SURFACE
from coadapt.report.samples import SampleRun
from coadapt.robots import Decision

FRAME = 73.0
"""Width of one step's column, points; so are all the others."""

LEFT, RIGHT = 68.0, 6.0
TOP, BOTTOM = 19.0, 36.0
TABLE, BARS = 55.0, 38.0
"""Heights of the rows."""

GAPS = (13.0, 28.0)
"""Heights of what is between them."""

SMALL = 6.5
"""Font size of the smallest labels."""

KEY_FONT = 7.0
KEY_SIGN = 17.0
"""Width of a sign in the key, with the space behind it."""

BAR_WIDTH = 0.72
"""Part of its place that a bar takes."""

BOTTLE = np.array(
    [
        *((-2.5, -5.0), (2.5, -5.0), (2.5, 0.75), (1.0, 2.5)),
        *((1.0, 5.0), (-1.0, 5.0), (-1.0, 2.5), (-2.5, 0.75)),
    ]
)
"""Outline, from the middle."""

ARROW = np.array(
    [(0, -0.95), (6.4, -0.95), (6.4, -3.2), (11, 0), (6.4, 3.2), (6.4, 0.95), (0, 0.95)]
)
"""Outline of an arrow that points to the right, from its tail."""

ARROW_START, ARROWS_APART = 1.5, 3.7
"""How far from the robot an arrow begins, and how far aside of its direction."""


@dataclass(frozen=True)
class Box:
    """A rectangle on the page: its lower left corner and its size."""

    x: float
    y: float
    width: float
    height: float


def largest_belief(runs: Sequence[SampleRun]) -> float:
    """Upper end of the axis for beliefs over alpha, the same for all ``runs``."""
    found = max(float(d.adaptability_belief.max()) for r in runs for d in r.episode.decisions)
    return next(top for top in (0.5, 0.75, 1.0) if found <= top or top == 1.0)


def filmstrip(model: SharedAutonomy, run: SampleRun, top: float = 1.0) -> Figure:
    """The strip of one user: a column for each step.

    Args:
        model: world, adaptability and modes.
        run: what happened.
        top: upper end of the axis for beliefs over alpha.
    """
    episode = run.episode
    key = _key_texts(model)
    width = LEFT + max(episode.steps * FRAME + RIGHT, sum(map(_key_width, key)))
    height = TOP + TABLE + GAPS[0] + BARS + GAPS[1] + BARS + BOTTOM
    figure = Figure(figsize=(width / 72, height / 72))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_xlim(0, width)
    axes.set_ylim(0, height)
    axes.set_axis_off()
    modes_y = BOTTOM
    beliefs_y = modes_y + BARS + GAPS[1]
    table_y = beliefs_y + BARS + GAPS[0]
    alphas = [_short(value) for value in model.alpha.values]
    modes = [name[:1].upper() for name in model.mode_names]
    truth = np.flatnonzero(np.isclose(model.alpha.values, run.adaptability))
    for t, decision in enumerate(episode.decisions):
        x = LEFT + t * FRAME
        frame = Box(x, table_y, FRAME - 4, TABLE)
        _text(axes, x + frame.width / 2, height - 5, f"T = {t + 1}", ha="center", va="top")
        _draw_table(axes, frame, model, episode.states[: t + 1], decision)
        bars = Box(x + 7, beliefs_y, FRAME - 14, BARS)
        _draw_bars(axes, bars, decision.adaptability_belief, alphas, top, truth, t == 0)
        bars = Box(x + 7, modes_y, FRAME - 14, BARS)
        _draw_bars(axes, bars, decision.mode_belief, modes, 1.0, [episode.modes[t]], t == 0)
    goal = "no goal" if episode.goal is None else f"{model.world.goals[episode.goal].name} goal"
    user = f"User {run.user}\nα = {run.adaptability:g}"
    _text(axes, 6, table_y + TABLE - 2, user, va="top", fontweight="bold")
    _text(axes, 6, table_y + 4, f"ends at the\n{goal} ({episode.reward:g})")
    _text(axes, 6, beliefs_y + BARS / 2, "belief\nover α", va="center")
    _text(axes, 6, modes_y + BARS / 2, "belief\nover modes", va="center")
    _draw_key(axes, key)
    return figure


def _draw_table(
    axes: Axes, frame: Box, model: SharedAutonomy, states: Sequence[int], decision: Decision
) -> None:
    world = model.world
    low, high = world.positions.min(axis=0), world.positions.max(axis=0)
    edge, corner = np.array([9.0, 9.5]), np.array([frame.x, frame.y])
    room = np.array([frame.width, frame.height]) - 2 * edge
    place = corner + edge + (world.positions - low) / np.maximum(high - low, 1e-9) * room
    surface = FancyBboxPatch(
        (frame.x + 4, frame.y + 2),
        frame.width - 8,
        frame.height - 4,
        boxstyle="round,pad=0,rounding_size=3",
        facecolor=SURFACE,
        edgecolor=LINE,
        linewidth=0.6,
    )
    axes.add_patch(surface)
    axes.plot(place[:, 0], place[:, 1], ".", markersize=1.3, color=LINE, markeredgewidth=0)
    for g, goal in enumerate(world.goals):
        for state in goal.states:
            _bottle(axes, place[state], INK if g == world.optimal_goal else SURFACE)
    past = place[list(states)]
    axes.plot(past[:, 0], past[:, 1], "-", color=PATH, linewidth=0.9, zorder=4)
    axes.plot(past[:-1, 0], past[:-1, 1], "o", color=PATH, markersize=2.4, markeredgewidth=0)
    axes.plot(*past[-1], "o", color=PATH, markersize=5.2, markeredgewidth=0, zorder=6)
    if decision.human_input is not None:
        _arrow(
            axes,
            past[-1],
            model.interface.directions[decision.human_input],
            HUMAN,
            PAPER,
            +ARROWS_APART,
        )
    _arrow(axes, past[-1], world.directions[decision.action], ROBOT, ROBOT, -ARROWS_APART)


def _arrow(
    axes: Axes, start: FloatArray, direction: FloatArray, color: str, fill: str, aside: float
) -> None:
    """An arrow that begins near ``start``, ``aside`` points to the left of its direction."""
    angle = np.arctan2(direction[1], direction[0])
    turn = Affine2D().translate(ARROW_START, aside).rotate(float(angle)).translate(*start)
    outline = turn.transform(ARROW)
    axes.add_patch(
        Polygon(outline, facecolor=fill, edgecolor=color, linewidth=0.9, zorder=7, clip_on=False)
    )


def _bottle(axes: Axes, place: FloatArray | tuple[float, float], fill: str) -> None:
    outline = BOTTLE + np.array(place)
    axes.add_patch(Polygon(outline, facecolor=fill, edgecolor=INK, linewidth=0.8, zorder=3))


def _draw_bars(
    axes: Axes,
    box: Box,
    belief: FloatArray,
    names: Sequence[str],
    top: float,
    truth: Iterable[int],
    first: bool,
) -> None:
    """A bar for each name, a tick for none, half and all of ``top``, a mark over each truth."""
    place = box.width / len(names)
    middle = box.x + place * (np.arange(len(names)) + 0.5)
    bars = [
        Rectangle(
            (x - BAR_WIDTH * place / 2, box.y), BAR_WIDTH * place, box.height * float(b) / top
        )
        for x, b in zip(middle, belief, strict=True)
    ]
    axes.add_collection(PatchCollection(bars, facecolor=ROBOT, edgecolor="none"))
    ticks = [0.0, top / 2, top]
    heights = [box.y + box.height * tick / top for tick in ticks]
    lines = [
        [(box.x, box.y + box.height), (box.x, box.y), (box.x + box.width, box.y)],
        *([(box.x - 2, y), (box.x, y)] for y in heights),
    ]
    axes.add_collection(LineCollection(lines, colors=MUTED, linewidths=0.7, zorder=3))
    for x, name in zip(middle, names, strict=True):
        _text(axes, float(x), box.y - 2.5, name, ha="center", va="top", fontsize=SMALL)
    if first:
        for tick, y in zip(ticks, heights, strict=True):
            _text(axes, box.x - 3.5, y, _short(tick), ha="right", va="center", fontsize=SMALL)
    for i in truth:
        _mark(axes, float(middle[i]), box.y + box.height + 4.5)


def _mark(axes: Axes, x: float, y: float) -> None:
    """The triangle that points to what the user is in truth."""
    axes.plot(x, y, marker="v", markersize=4, color=HUMAN, markeredgewidth=0)


def _draw_key(axes: Axes, texts: Sequence[str]) -> None:
    """What the signs mean, in a row below the strip; ``texts`` are those of `_key_texts`."""
    right, y = np.array([1.0, 0.0]), 9.0
    signs: list[Callable[[float], None]] = [
        lambda x: _arrow(axes, np.array([x, y]), right, HUMAN, PAPER, 0),
        lambda x: _arrow(axes, np.array([x, y]), right, ROBOT, ROBOT, 0),
        lambda x: _path_key(axes, x, y),
        lambda x: _bottle(axes, (x + 8, y), INK),
        lambda x: _bottle(axes, (x + 8, y), SURFACE),
        lambda x: _mark(axes, x + 8, y),
    ]
    x = LEFT
    for text, sign in zip(texts, signs, strict=True):
        sign(x)
        _text(axes, x + KEY_SIGN, y, text, va="center", fontsize=KEY_FONT)
        x += _key_width(text)


def _key_texts(model: SharedAutonomy) -> list[str]:
    world = model.world
    best = world.goals[world.optimal_goal]
    other = next(goal for goal in world.goals if goal is not best)
    return [
        "human input",
        "robot action",
        "path so far",
        f"optimal goal ({best.name}, {best.reward:g})",
        f"other goal ({other.name}, {other.reward:g})",
        "the user’s true α and mode",
    ]


def _key_width(text: str) -> float:
    """About how wide an entry of the key is, with the space behind it."""
    return KEY_SIGN + 0.55 * KEY_FONT * len(text) + 14


def _path_key(axes: Axes, x: float, y: float) -> None:
    outline = Path(np.array([(x, y), (x + 14, y)]))
    axes.add_patch(PathPatch(outline, facecolor="none", edgecolor=PATH, linewidth=0.9))
    axes.plot(x + 7, y, "o", color=PATH, markersize=3.5, markeredgewidth=0)


def _text(axes: Axes, x: float, y: float, text: str, **looks: object) -> None:
    axes.text(x, y, text, **looks)  # pyright: ignore[reportArgumentType]


def _short(value: float) -> str:
    """``0.25`` as ``.25``."""
    return f"{value:g}".removeprefix("0") or "0"
