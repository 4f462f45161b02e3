"""What came of simulated episodes, for people and for JSON."""

from __future__ import annotations

from math import isnan

from coadapt.formalism import Model
from coadapt.simulation import Mean, Summary

MEANINGS = {
    "reward": "reward of the goal reached",
    "steps": "steps",
    "disagreement": "steps in which it was seen in another mode",
    "overridden": "steps in which it did not do what was asked",
    "estimated_adaptability": "its last estimate of alpha",
}
"""Every measure in a few words, about the robot."""


def summary_record(summary: Summary, model: Model) -> dict[str, object]:
    """For JSON."""
    means = {
        name: {"mean": value.mean, "standard_error": _error(value)}
        for name, value in _measures(summary).items()
    }
    goals = _shares(summary, model)
    return {"episodes": summary.runs, "goals": goals, "no_goal": summary.no_goal, **means}


def summary_lines(summary: Summary, model: Model) -> list[str]:
    """For people."""
    shares = {f"ends at {name}": share for name, share in _shares(summary, model).items()}
    shares["ends at no goal"] = summary.no_goal
    width = 2 + max(map(len, (*shares, *MEANINGS.values())))
    lines = [f"  {'episodes':<{width}}{summary.runs:8,}"]
    lines += [f"  {name:<{width}}{share:8.1%}" for name, share in shares.items()]
    for name, value in _measures(summary).items():
        error = _error(value)
        spread = "" if error is None else f" +- {error:.2g}"
        lines.append(f"  {MEANINGS[name]:<{width}}{value.mean:8.3f}{spread}")
    return lines


def _shares(summary: Summary, model: Model) -> dict[str, float]:
    return dict(zip(model.mode_names, map(float, summary.goals), strict=True))


def _measures(summary: Summary) -> dict[str, Mean]:
    found = {name: getattr(summary, name) for name in list(MEANINGS)[:-1]}
    if summary.adaptability is not None:
        found["estimated_adaptability"] = summary.adaptability
    return found


def _error(value: Mean) -> float | None:
    return None if isnan(value.standard_error) else value.standard_error
