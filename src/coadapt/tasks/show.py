"""A task in words, for people."""

from __future__ import annotations

from textwrap import fill

import msgspec

from coadapt.formalism import SharedAutonomy
from coadapt.tasks.registry import BuiltTask
from coadapt.tasks.task import Task
from coadapt.worlds import World

WIDTH = 80

MOST_LINES = 60
"""Lines of a map or of a graph's moves that are shown."""


def description(task: Task) -> list[str]:
    """The task's text, its place, its goals and its parameters, line by line."""
    model = task.build()
    lines = [""]
    if task.about:
        lines += [*fill(" ".join(task.about.split()), WIDTH).splitlines(), ""]
    lines += _place(task, model.world)
    lines += ["", "Goals", *_goals(task)]
    lines += ["", "Parameters", *(f"  {n:<26}{value}" for n, value in _parameters(task, model))]
    return lines


def built_description(task: BuiltTask) -> list[str]:
    """The same of a task in which the person moves the world too."""
    model = task.build()
    world, alpha = model.world, model.alpha
    names = ", ".join(name.removeprefix("alpha=") for name in alpha.names)
    starts = " or ".join(world.state_names[start] for start in world.starts)
    shown = [
        ("start", starts),
        ("robot's actions", ", ".join(world.action_names)),
        ("person's actions", ", ".join(world.human_action_names)),
        ("memory", f"{model.memory}"),
        ("adaptability", names),
        ("discount", f"{model.discount:g}"),
    ]
    goals = [
        f"  {goal.name}: {world.together.goal_place(g)}, reward {goal.reward:g}"
        for g, goal in enumerate(world.goals)
    ]
    about = fill(" ".join(task.about.split()), WIDTH).splitlines()
    parameters = [f"  {name:<26}{value}" for name, value in shown]
    return ["", *about, "", "Goals", *goals, "", "Parameters", *parameters]


def _place(task: Task, world: World) -> list[str]:
    if task.map is not None:
        drawn = [f"  {line}" for line in task.map.lines]
        drawn += ["", "  @ start   . free   # obstacle"]
    else:
        drawn = [
            f"  {name}: {', '.join(_ways(world, x)) or 'nothing leads on'}"
            for x, name in enumerate(world.state_names)
        ]
    if len(drawn) > MOST_LINES:
        drawn = [*drawn[:MOST_LINES], f"  ... and {len(drawn) - MOST_LINES:,} lines more"]
    return drawn


def _ways(world: World, x: int) -> list[str]:
    """What each action does in a state, where it does anything."""
    if world.ends[x]:
        return []
    ways: list[str] = []
    for a, action in enumerate(world.action_names):
        states: list[int] = world.outcomes[x, a].tolist()
        chances: list[float] = world.outcome_chances[x, a].tolist()
        ends = {y: chance for y, chance in zip(states, chances, strict=True) if chance > 0}
        if ends != {x: 1.0}:
            names = [
                world.state_names[y] + ("" if chance == 1 else f" ({chance:g})")
                for y, chance in ends.items()
            ]
            ways.append(f"{action} to {' or '.join(names)}")
    return ways


def _goals(task: Task) -> list[str]:
    widest = max(len(goal.name) for goal in task.goals)
    lines: list[str] = []
    for goal in task.goals:
        symbol = f"{goal.mark}  " if task.map is not None else ""
        prior = "" if goal.prior is None else f", wanted with probability {goal.prior:g}"
        lines.append(f"  {symbol}{goal.name:<{widest}}  reward {goal.reward:g}{prior}")
    return lines


def _parameters(task: Task, model: SharedAutonomy) -> list[tuple[str, str]]:
    alpha, world, inputs = model.alpha, model.world, model.interface
    names = ", ".join(name.removeprefix("alpha=") for name in alpha.names)
    shares = ", ".join(f"{share:.3g}" for share in alpha.prior)
    changes = "" if alpha.is_fixed else ", changing"
    kind = msgspec.to_builtins(task.inputs)
    how = ", ".join(f"{key} {value}" for key, value in kind.items() if key != "kind")
    shown = [
        ("actions", ", ".join(world.action_names)),
        ("inputs", ", ".join(inputs.names)),
        ("which are", f"{kind['kind']}: {how}"),
        ("memory", f"{model.memory}"),
        ("adaptability", f"{names}{changes}"),
        ("its prior", shares),
        ("disagreement cost", f"{model.disagreement_cost:g}"),
        ("action disagreement cost", f"{model.action_disagreement_cost:g}"),
        ("discount", f"{model.discount:g}"),
        ("step cost of the modes", f"{task.model.step_cost:g}"),
    ]
    if world.costs is not None:
        shown.append(("cost of a move", f"{world.costs.max():g}"))
    return shown
