"""Why a robot did what it did, in one plain sentence."""

from __future__ import annotations

from coadapt.robots.fixed import NoAdaptation
from coadapt.robots.match import MatchRule
from coadapt.robots.robot import Decision, Robot

CLEAR_AIM = 0.9
"""An action seen as one goal's with at least this probability is said to head for it."""


def explain(robot: Robot, decision: Decision) -> str:
    """One sentence for the person who steers: what the robot does, whether they asked for it, why.

    Args:
        robot: took the decision. Only its models and values are asked, so it may have gone on.
        decision: the decision.

    Returns:
        Plain text without line breaks. Values are expected discounted rewards in the paper's units.
    """
    world = robot.model.world
    done = world.action_names[decision.action]
    if isinstance(robot, NoAdaptation):
        goal = world.goals[world.optimal_goal]
        return (
            f"The robot goes {done} whatever you ask: it takes the shortest way to the "
            f"{goal.name} goal, worth {goal.reward:g}."
        )
    worth = _worth(robot, decision)
    if decision.matched:
        planned = world.action_names[decision.planned]
        plan = " and as it planned" if planned == done else f", instead of {planned}, its plan"
        return (
            f"The robot goes {done}, as you ask{plan}: it is {percent(decision.agreement)} sure "
            f"that you both head for the same goal{_enough(robot)}; {done} is worth {worth}."
        )
    reason = f"this {_aim(robot, decision)} and is worth {worth}"
    if decision.human_input is None:
        return f"The robot goes {done}, and you asked for nothing: {reason}."
    if decision.asked == decision.action:
        return f"The robot goes {done}, as you ask and as it planned: {reason}."
    given = robot.model.interface.names[decision.human_input]
    if decision.asked is None:
        return f"The robot goes {done}, and your input, {given}, asks for no action: {reason}."
    return (
        f"The robot goes {done} although you ask for {given}: {reason}; "
        f"{_too_unsure(robot, decision)}."
    )


def _enough(robot: Robot) -> str:
    threshold = match_threshold(robot)
    return "" if threshold is None else f", and {percent(threshold)} is enough"


def _too_unsure(robot: Robot, decision: Decision) -> str:
    threshold = match_threshold(robot)
    if threshold is not None and threshold > 1:
        return "it keeps to its plan however sure it is of your goal"
    sure = percent(decision.agreement)
    if threshold is None:
        return f"it is {sure} sure that you both head for the same goal"
    needed = percent(threshold)
    how = "just " if sure == needed else ""
    return (
        f"it is {sure} sure that you both head for the same goal, "
        f"{how}below the {needed} from which it does what you ask"
    )


def _aim(robot: Robot, decision: Decision) -> str:
    """What the planned action tells the person who watches (Eq. 2)."""
    model = robot.model
    perceived = model.perceived[decision.window, decision.planned]
    mode = int(perceived.argmax())
    if perceived[mode] >= CLEAR_AIM:
        return f"heads for the {model.mode_names[mode]} goal"
    return "keeps its goal open"


def _worth(robot: Robot, decision: Decision) -> str:
    values = robot.action_values(decision)
    names = robot.model.world.action_names
    others = ", ".join(
        f"{name} {value:.3f}"
        for a, (name, value) in enumerate(zip(names, values, strict=True))
        if a != decision.action
    )
    return f"{values[decision.action]:.3f} to it ({others})"


def match_threshold(robot: Robot) -> float | None:
    """The agreement from which ``robot`` executes the input; None if it does not tell."""
    rule: object = getattr(robot, "match_rule", None)
    return rule.threshold if isinstance(rule, MatchRule) else None


def percent(probability: float) -> str:
    """A probability in whole per cent, where neither 0% nor 100% is said of what is not certain."""
    if 0 < probability < 0.005:
        return "<1%"
    if 0.995 <= probability < 1:
        return ">99%"
    return f"{probability:.0%}"
