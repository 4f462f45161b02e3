"""Every number of the report as CSV tables, and as one JSON object."""

from __future__ import annotations

import csv
import io
import json
import math
from dataclasses import asdict, dataclass, fields
from itertools import zip_longest
from typing import Any

from coadapt.report.performance import RobotResult
from coadapt.report.provenance import parameters
from coadapt.report.reproduce import Planned, Reproduction
from coadapt.report.samples import SampleRun

FORMAT = 1
"""Version of the JSON object's layout."""

Cell = str | int | float | bool | None


@dataclass(frozen=True)
class Table:
    """Rows under named columns.

    Attributes:
        name: stem of its file.
        columns: their names.
        rows: one cell for each column; None where there is nothing to say.
    """

    name: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def csv(self) -> str:
        """The table as CSV (RFC 4180, but lines end in a line feed); numbers in full precision."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows([["" if cell is None else _plain(cell) for cell in r] for r in self.rows])
        return text.getvalue()


def tables(found: Reproduction) -> tuple[Table, ...]:
    """All tables."""
    return (
        _performance(found),
        _curves(found),
        _conditions(found),
        _samples(found),
        _roots(found),
        _bounds(found),
        _identities(found),
        _parameters(found),
    )


def to_json(found: Reproduction) -> str:
    """`as_object` as text: keys in a fixed order, numbers in full precision, ASCII only, no NaN."""
    return json.dumps(as_object(found), indent=2, allow_nan=False) + "\n"


def as_object(found: Reproduction) -> dict[str, Any]:
    """Everything as one object of dictionaries, lists, strings and numbers; ``format`` is `FORMAT`.

    ``performance`` is the mutual-adaptation policy without the match rule,
    ``performance_with_match_rule`` the same with it; ``roots`` are the planner's bounds at the
    belief after each first input.
    """
    world = found.settings.model.world
    return {
        "format": FORMAT,
        "runs": found.settings.runs,
        "seed": found.settings.seed,
        "goals": [
            {"name": goal.name, "state": world.goal_place(g), "reward": goal.reward}
            for g, goal in enumerate(world.goals)
        ],
        "first_mode": world.goals[found.first_mode].name,
        "performance": _performance_object(found.robot("mutual_policy")),
        "performance_with_match_rule": _performance_object(found.robot("mutual_rule")),
        "roots": _roots_object(found.mutual),
        "planner": {
            "mutual_adaptation": _planned_object(found.mutual),
            "one_way_adaptation": _planned_object(found.one_way),
        },
        "bounds": {
            key: [getattr(record, key) for record in found.trace]
            for key in ("backups", "lower", "upper", "gap", "vectors")
        },
        "conditions": [_robot_object(robot) for robot in found.robots],
        "samples": [_sample_object(found, run) for run in found.samples],
        "identities": [{**asdict(i), "holds": i.holds} for i in found.identities],
        "parameters": [asdict(parameter) for parameter in parameters(found)],
    }


def _performance_object(robot: RobotResult) -> dict[str, Any]:
    return {
        "alpha": list(robot.alpha),
        "exact": [e.reward for e in robot.exact],
        "exact_error": [e.reward_error for e in robot.exact],
        "simulated": [s.reward.mean for s in robot.simulated],
        "standard_error": [s.reward.standard_error for s in robot.simulated],
        "interval_low": [s.low for s in robot.simulated],
        "interval_high": [s.high for s in robot.simulated],
        "optimal_goal": list(robot.optimal),
        "optimal_goal_simulated": [float(s.goals[robot.optimal_goal]) for s in robot.simulated],
    }


def _roots_object(planned: Planned) -> dict[str, Any]:
    return {
        "observation": list(planned.root_names),
        "probability": list(planned.root_probability),
        "lower": list(planned.root_lower),
        "upper": list(planned.root_upper),
    }


def _planned_object(planned: Planned) -> dict[str, Any]:
    return {
        "observed_states": planned.observed,
        "hidden_states": planned.hidden,
        "actions": planned.actions,
        "observations": planned.observations,
        "status": planned.status,
        "lower": planned.lower,
        "upper": planned.upper,
        "gap": planned.gap,
        "backups": planned.backups,
        "vectors": planned.vectors,
    }


def _robot_object(robot: RobotResult) -> dict[str, Any]:
    return {
        "robot": robot.key,
        "label": robot.label,
        "condition": robot.condition,
        "match_rule": robot.match_rule,
        "alpha": list(robot.alpha),
        "reward": [e.reward for e in robot.exact],
        "reward_error": [e.reward_error for e in robot.exact],
        "optimal_goal": list(robot.optimal),
        "discounted_return": [e.discounted_return for e in robot.exact],
        "steps": [e.steps for e in robot.exact],
        "disagreement": [e.disagreement for e in robot.exact],
        "overridden": [e.overridden for e in robot.exact],
        "unresolved": [e.unresolved for e in robot.exact],
    }


def _sample_object(found: Reproduction, run: SampleRun) -> dict[str, Any]:
    model, episode = found.settings.model, run.episode
    world, inputs = model.world, model.interface.names
    return {
        "user": run.user,
        "adaptability": run.adaptability,
        "run": run.number,
        "rule": f"the first run in which {run.rule}",
        "goal": None if episode.goal is None else world.goals[episode.goal].name,
        "reward": episode.reward,
        "disagreement": episode.disagreement,
        "states": [world.state_names[state] for state in episode.states],
        "inputs": [None if i is None else inputs[i] for i in episode.inputs],
        "actions": [world.action_names[a] for a in episode.actions],
        "matched": [d.matched for d in episode.decisions],
        "modes": [model.mode_names[mode] for mode in episode.modes],
        "adaptability_values": [float(value) for value in model.alpha.values],
        "mode_names": list(model.mode_names),
        "belief_adaptability": [d.adaptability_belief.tolist() for d in episode.decisions],
        "belief_mode": [d.mode_belief.tolist() for d in episode.decisions],
    }


def _performance(found: Reproduction) -> Table:
    columns = ("robot", "match_rule", "alpha", "exact", "exact_error", "runs", "simulated")
    columns += ("standard_error", "interval_low", "interval_high", "optimal_goal")
    columns += ("optimal_goal_simulated",)
    rows: list[tuple[Cell, ...]] = []
    for robot in (found.robot("mutual_policy"), found.robot("mutual_rule")):
        lists = (robot.alpha, robot.exact, robot.optimal, robot.simulated)
        for alpha, e, p, s in zip(*lists, strict=True):
            exact = (robot.key, robot.match_rule, alpha, e.reward, e.reward_error)
            drawn = (s.runs, s.reward.mean, s.reward.standard_error, s.low, s.high)
            rows.append((*exact, *drawn, p, float(s.goals[robot.optimal_goal])))
    return Table("performance", columns, tuple(rows))


def _curves(found: Reproduction) -> Table:
    curves = [(r.key, r.curve) for r in found.robots if r.curve is not None]
    rows = [
        (key, alpha, reward, curve.error)
        for key, curve in curves
        for alpha, reward in zip(curve.alpha, curve.reward, strict=True)
    ]
    return Table("performance_curve", ("robot", "alpha", "exact", "exact_error"), tuple(rows))


def _conditions(found: Reproduction) -> Table:
    columns = ("robot", "condition", "match_rule", "alpha", "reward", "reward_error")
    columns += ("optimal_goal", "steps", "disagreement", "overridden", "discounted_return")
    columns += ("unresolved",)
    rows: list[tuple[Cell, ...]] = []
    for robot in found.robots:
        for alpha, e, p in zip(robot.alpha, robot.exact, robot.optimal, strict=True):
            who = (robot.key, robot.condition, robot.match_rule, alpha)
            what = (e.steps, e.disagreement, e.overridden, e.discounted_return, e.unresolved)
            rows.append((*who, e.reward, e.reward_error, p, *what))
    return Table("conditions", columns, tuple(rows))


def _samples(found: Reproduction) -> Table:
    model = found.settings.model
    world, inputs = model.world, model.interface.names
    columns = ("user", "adaptability", "step", "state", "mode", "input", "planned", "action")
    columns += ("matched", "agreement")
    columns += tuple(f"belief_alpha_{value:g}" for value in model.alpha.values)
    columns += tuple(f"belief_mode_{name}" for name in model.mode_names)
    rows: list[tuple[Cell, ...]] = []
    for run in found.samples:
        episode = run.episode
        steps = zip_longest(episode.decisions, episode.modes)
        for t, (d, mode) in enumerate(steps, start=1):
            asked = None if d.human_input is None else inputs[d.human_input]
            done = (world.action_names[d.planned], world.action_names[d.action], d.matched)
            rows.append(
                (
                    *(run.user, run.adaptability, t, world.state_names[d.state]),
                    *(model.mode_names[mode], asked, *done, d.agreement),
                    *map(float, d.adaptability_belief),
                    *map(float, d.mode_belief),
                )
            )
    return Table("samples", columns, tuple(rows))


def _roots(found: Reproduction) -> Table:
    names = {"mutual_adaptation": found.mutual, "one_way_adaptation": found.one_way}
    rows: list[tuple[Cell, ...]] = []
    for name, p in names.items():
        lists = (p.root_names, p.root_probability, p.root_lower, p.root_upper)
        rows += [(name, *row) for row in zip(*lists, strict=True)]
    return Table("roots", ("planner", "observation", "probability", "lower", "upper"), tuple(rows))


def _bounds(found: Reproduction) -> Table:
    rows = [(r.backups, r.lower, r.upper, r.gap, r.vectors) for r in found.trace]
    return Table("bounds", ("backups", "lower", "upper", "gap", "vectors"), tuple(rows))


def _identities(found: Reproduction) -> Table:
    rows = [(*asdict(i).values(), i.holds) for i in found.identities]
    columns = (*(f.name for f in fields(found.identities[0])), "holds")
    return Table("identities", columns, tuple(rows))


def _parameters(found: Reproduction) -> Table:
    rows = [(p.name, p.value, p.origin, p.source) for p in parameters(found)]
    return Table("parameters", ("name", "value", "origin", "source"), tuple(rows))


def _plain(cell: str | int | float | bool) -> str:
    if isinstance(cell, bool):
        return "true" if cell else "false"
    if isinstance(cell, float):
        return repr(cell) if math.isfinite(cell) else str(cell)
    return str(cell)
