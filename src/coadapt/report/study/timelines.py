"""What the robot believed and did in each trial, participant by participant."""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from coadapt.analysis.analyse import Analysis
from coadapt.analysis.data import Person, Step, Trial
from coadapt.report.figures.style import HUMAN, INK, LINE, MUTED, MUTUAL, PATH, WIDTH

MOST_PEOPLE = 24
"""Participants of a condition that are drawn; the table of courses has all."""

ROW = 0.5
"""Height of a participant's row, inches."""

HEAD, FOOT = 0.34, 0.42
"""Inches above and below the rows."""

LEFT = 0.72
"""Inches for the participants' names."""

FAINT = 0.015
"""Belief that is not drawn: its square could not be seen."""


def with_courses(found: Analysis, condition: str) -> tuple[Person, ...]:
    """Those of a condition whose steps were recorded."""
    people = found.data.of(condition)
    return tuple(person for person in people if any(trial.course for trial in person.trials))


def timelines(found: Analysis, people: Sequence[Person]) -> Figure:
    """A row for each participant, a column for each trial.

    Squares: belief over α, a row for each value, the lowest at the bottom. Line: the robot's belief
        that
    the participant wants the goal it holds to be better, from 0 at the bottom to 1. Marks below:
    what the robot did with the input.
    """
    count, trials = len(people), found.data.declared.trials
    height = HEAD + FOOT + ROW * count
    figure = Figure(figsize=(WIDTH, height))
    longest = max(len(t.course) for person in people for t in person.trials)
    span = (WIDTH - LEFT - 0.1) / trials
    for i, person in enumerate(people):
        bottom = (height - HEAD - ROW * (i + 1)) / height
        by_number = {trial.number: trial for trial in person.trials}
        figure.text(
            0.01,
            bottom + 0.55 * ROW / height,
            person.name[:9],
            fontsize=6.2,
            color=MUTED,
            va="center",
        )
        for n in range(1, trials + 1):
            left = (LEFT + span * (n - 1)) / WIDTH
            axes = figure.add_axes((left, bottom, (span - 0.12) / WIDTH, ROW * 0.86 / height))
            axes.set_axis_off()
            axes.set_xlim(-0.7, longest + 2.2)
            axes.set_ylim(-0.55, 1.08)
            if n in by_number and by_number[n].course:
                _trial(axes, by_number[n], found.data.adaptability)
            else:
                axes.text(0, 0.4, "not recorded", fontsize=6, color=MUTED)
            if i == 0:
                axes.text(0, 1.35, f"Trial {n}", fontsize=7.4, color=INK, fontweight="bold")
    _legend(figure, height)
    return figure


def _trial(axes: Axes, trial: Trial, alphas: Sequence[float]) -> None:
    steps = len(trial.course)
    infers = len(trial.course[0].belief) == len(alphas) > 1 and any(
        not np.allclose(step.belief, trial.course[0].belief, atol=1e-9) for step in trial.course
    )
    axes.add_patch(Rectangle((-0.5, 0), steps, 1, facecolor="none", edgecolor=LINE, linewidth=0.5))
    if infers:
        size = 1 / len(alphas)
        for t, step in enumerate(trial.course):
            for a, belief in enumerate(step.belief):
                if belief > FAINT:
                    axes.add_patch(
                        Rectangle(
                            (t - 0.5, a * size),
                            1,
                            size,
                            facecolor=MUTUAL,
                            alpha=float(min(1.0, belief)) * 0.75,
                            linewidth=0,
                        )
                    )
    towards = [step.towards for step in trial.course]
    if np.ptp(towards) > 1e-9:
        axes.plot(range(steps), towards, color=INK, linewidth=0.9)
    for kind, (color, marker) in MARKS.items():
        xs = [t for t, step in enumerate(trial.course) if done_with(step) == kind]
        axes.scatter(xs, [-0.3] * len(xs), s=7, color=color, marker=marker, linewidths=0)
    reached = "no goal" if trial.goal is None else "optimal" if trial.optimal else "other"
    color = MUTED if trial.goal is None or not trial.optimal else HUMAN
    axes.text(steps - 0.1, 0.4, reached, fontsize=5.8, color=color, va="center")


MARKS = {
    "followed": (HUMAN, "o"),
    "overrode": (PATH, "v"),
    "matched": (MUTUAL, "s"),
    "no input": (LINE, "."),
}
"""Colour and mark of what the robot did with an input."""


def done_with(step: Step) -> str:
    """What the robot did with the input of a step."""
    if step.input is None:
        return "no input"
    if step.matched:
        return "matched"
    return "followed" if step.action == step.input else "overrode"


def _legend(figure: Figure, height: float) -> None:
    axes = figure.add_axes((LEFT / WIDTH, 0.0, 1 - LEFT / WIDTH, FOOT * 0.7 / height))
    axes.set_axis_off()
    axes.set_xlim(0, 10)
    axes.set_ylim(0, 1)
    texts = {
        "followed": "did what was asked",
        "overrode": "did something else",
        "matched": "input instead of plan",
        "no input": "no input",
    }
    for i, (kind, text) in enumerate(texts.items()):
        color, marker = MARKS[kind]
        x = (0, 2.3, 4.55, 6.95)[i]
        axes.scatter([x + 0.1], [0.5], s=12, color=color, marker=marker, linewidths=0)
        axes.text(x + 0.25, 0.5, text, fontsize=6.6, color=MUTED, va="center")
    axes.plot([7.9, 8.2], [0.5, 0.5], color=INK, linewidth=0.9)
    axes.text(8.3, 0.5, "P(wants optimal)", fontsize=6.6, color=MUTED, va="center")
