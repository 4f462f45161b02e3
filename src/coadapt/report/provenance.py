"""Where every parameter comes from: the paper, or us, and then why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from coadapt.report.reproduce import Reproduction

Origin = Literal["paper", "ours"]


@dataclass(frozen=True)
class Parameter:
    """One choice behind the numbers.

    Attributes:
        name: what it is, with its symbol.
        value: as used here.
        origin: who chose it.
        source: the paper's section, or our reason.
    """

    name: str
    value: str
    origin: Origin
    source: str


def parameters(found: Reproduction) -> tuple[Parameter, ...]:
    """Every parameter of ``found``, first the paper's, then ours; values are read from it."""
    settings, model = found.settings, found.settings.model
    world, alpha = model.world, model.alpha
    best, other = world.goals[world.optimal_goal], world.goals[found.first_mode]
    states = f"{found.mutual.observed} × {found.mutual.hidden}"
    paper = [
        ("Robot states |X|", f"{world.states}", "52", "Sec. 6.5"),
        (
            "Actions of robot and human",
            _listed(world.action_names),
            "left, forward, right",
            "Sec. 5.4 and 6.5",
        ),
        ("Modes, one for each goal", _listed(model.mode_names), "left, right", "Sec. 6.5"),
        (
            "Adaptability values α",
            _numbers(alpha.values),
            "0, 0.25, 0.5, 0.75, 1",
            "Sec. 5.4 and 6.5",
        ),
        ("States of the planning problem", states, "52 × 10", "Sec. 6.5"),
        (f"Reward of the optimal goal R_opt ({best.name})", f"{best.reward:g}", "11", "Sec. 6.5"),
        (f"Reward of the other goal R_sub ({other.name})", f"{other.reward:g}", "10", "Sec. 6.5"),
        (
            "Cost of disagreement C",
            f"{model.disagreement_cost:g}",
            "-0.32",
            "Sec. 6.5, Eq. 8",
        ),
        ("Memory k, steps", f"{model.memory}", "1", "Sec. 5.4 and 6.5"),
        ("Simulated runs per adaptability", f"{settings.runs}", "1000", "Sec. 5.4"),
        ("First mode of the simulated users", other.name, "left", "Sec. 5.4, Fig. 4"),
    ]
    ours = [
        (
            "Layout of the robot states",
            _layout(found),
            "The paper gives the number of states only. Two bottles placed symmetrically "
            "(Sec. 6.3); wide enough for the penalty to outweigh R_opt − R_sub.",
        ),
        (
            "A move off the grid",
            "no-op",
            "The paper's states are places of a hand that cannot leave the table.",
        ),
        (
            "Discount γ",
            f"{model.discount:g}",
            "The paper says only that it lies in [0, 1). Close to 1, so that rewards of "
            f"{other.reward:g} and {best.reward:g} keep their order over ten steps.",
        ),
        (
            "Step cost c of the modal policies",
            f"{model.step_cost:g} nats",
            "The paper asks for maximum entropy (Sec. 3.1) and gives no cost. At this one people "
            "mostly take shortest paths, and now and then stray.",
        ),
        (
            "Prior over adaptability",
            _numbers(alpha.prior, same="uniform"),
            "Not stated. Figure 4 of the paper starts from an even belief.",
        ),
        ("Prior over modes", _numbers(model.prior.sum(axis=0), same="uniform"), "Not stated."),
        (
            "Change of adaptability T_α",
            "none" if alpha.is_fixed else "a matrix",
            "The paper's assumption (Sec. 5.1), here a matrix that may be set.",
        ),
        (
            "First observation",
            "the input before the first action",
            "The person moves first in every step, so planning starts from one belief for each "
            "possible first input.",
        ),
        (
            "An input or action that no mode explains",
            "says nothing",
            "Not stated. It does not occur here, where every mode may take every action.",
        ),
        (
            "Threshold of the match rule",
            f"{settings.match_rule.threshold:g}",
            "The paper asks for “enough confidence” (Sec. 5.3).",
        ),
        (
            "Gap of the planner",
            f"{settings.gap:g}",
            "Far below the difference that a step's delay makes.",
        ),
        ("Seed of the simulations", f"{settings.seed}", "Any will do."),
    ]
    return (
        *(_of_the_paper(*row) for row in paper),
        *(Parameter(name, value, "ours", source) for name, value, source in ours),
    )


def _of_the_paper(name: str, value: str, published: str, source: str) -> Parameter:
    """A parameter that the paper states: ours where another value was chosen."""
    if value == published:
        return Parameter(name, value, "paper", source)
    return Parameter(name, value, "ours", f"Chosen for this report; {source} has {published}.")


def _layout(found: Reproduction) -> str:
    world = found.settings.model.world
    columns, rows = (len(np.unique(world.positions[:, axis])) for axis in (0, 1))
    grid = columns * rows == world.states
    places = f"{columns} columns × {rows} rows" if grid else f"{world.states} places"
    goals = _listed([f"{goal.name}: {world.goal_place(g)}" for g, goal in enumerate(world.goals)])
    return f"{places}; start: {world.state_names[world.start]}; {goals}"


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names)


def _numbers(values: np.typing.NDArray[np.float64], same: str | None = None) -> str:
    if same is not None and np.allclose(values, values[0], rtol=0, atol=1e-12):
        return f"{same} ({values[0]:g})"
    return _listed([f"{value:g}" for value in values])
