"""Mean performance over adaptability (the paper's Fig. 5), with and without the match rule."""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from coadapt.report.figures.style import INK, LINE, MUTED, MUTUAL, PATH, label_line
from coadapt.report.performance import RobotResult
from coadapt.report.reproduce import Reproduction

APART = 0.008
"""How far the points of each robot are moved aside, so that the intervals can be told apart."""


def performance(found: Reproduction) -> Figure:
    """Exact curves as lines, simulated means as points with 95 % intervals."""
    world = found.settings.model.world
    best, other = world.goals[world.optimal_goal].reward, world.goals[found.first_mode].reward
    figure = Figure(figsize=(5.4, 3.3))
    axes = figure.add_axes((0.1, 0.135, 0.66, 0.815))
    for reward, which in ((best, "optimal goal"), (other, "other goal")):
        axes.axhline(reward, color=LINE, linewidth=1.0, zorder=0)
        label_line(axes, 1.03, reward, f"{which}, {reward:g}", MUTED)
    rule, policy = found.robot("mutual_rule"), found.robot("mutual_policy")
    _draw(figure, rule, PATH, "s", "--", +APART)
    _draw(figure, policy, MUTUAL, "o", "-", -APART)
    gap = rule.exact[-1].reward - policy.exact[-1].reward
    apart = 5 if gap < 0.1 * (best - other) else 0
    upper, lower = (rule, policy) if gap >= 0 else (policy, rule)
    for robot, dy in ((upper, apart), (lower, -apart)):
        text = "with the match rule" if robot is rule else "the policy alone"
        color = PATH if robot is rule else MUTUAL
        label_line(axes, 1.03, robot.exact[-1].reward, text, color, dy=dy)
    axes.set_xlim(-0.03, 1.03)
    margin = 0.06 * (best - other)
    axes.set_ylim(other - margin, best + margin)
    axes.set_xticks(rule.alpha)
    axes.set_yticks(np.linspace(other, best, 6))
    axes.set_xlabel("adaptability α of the simulated user")
    axes.set_ylabel("mean reward of the goal reached")
    axes.text(
        0.98,
        0.06,
        f"lines: exact\npoints: {found.settings.runs:,} simulated runs, 95 % intervals",
        transform=axes.transAxes,
        ha="right",
        va="bottom",
        fontsize=7,
        color=INK,
    )
    return figure


def _draw(
    figure: Figure, robot: RobotResult, color: str, marker: str, dashes: str, aside: float
) -> None:
    axes = figure.axes[0]
    curve = robot.curve
    if curve is not None:
        points = {**dict(zip(curve.alpha, curve.reward, strict=True))}
        points |= {a: e.reward for a, e in zip(robot.alpha, robot.exact, strict=True)}
        alpha = sorted(points)
        axes.plot(alpha, [points[a] for a in alpha], dashes, color=color, linewidth=1.5)
    means = np.array([s.reward.mean for s in robot.simulated])
    low, high = (np.array([getattr(s, end) for s in robot.simulated]) for end in ("low", "high"))
    axes.errorbar(
        np.array(robot.alpha) + aside,
        means,
        yerr=np.abs(np.stack([means - low, high - means])),
        fmt=marker,
        color=color,
        markersize=4.2,
        markeredgewidth=0,
        elinewidth=1.1,
        capsize=2.2,
        zorder=3,
    )
