"""Exact evaluation of a robot against a simulated partner, by expanding reachable beliefs.

A robot's decision depends on the window of its last steps, its belief and the input; the partner's
inputs depend on a mode that follows the adaptation model. So the pair (window, robot belief)
together with a weight for each mode of the partner says all about an episode so far. We expand
these step by step, merging those that coincide, until the mass that has not reached a goal is
negligible. The robot decides alike whoever steers, so one expansion serves any number of partners.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.human import filter as human_filter
from coadapt.robots import NO_INPUT, Decider, Decisions
from coadapt.simulation.partners import SimulatedPartner

SAME_BELIEF = 10
"""Beliefs that agree to this many decimals are merged."""

TOLERANCE = 1e-3
SMALLEST_TOLERANCE = 1e-12
MAX_STEPS = 1000

FIRST_THRESHOLD = 1e-4
"""Situations less likely than this part of the tolerance are left out at the first attempt."""

FINER = 8.0
"""How much smaller the threshold is at each further attempt."""


@dataclass(frozen=True)
class Evaluation:
    """What a robot and a partner achieve together, exact but for ``unresolved``.

    Attributes:
        reward: expected reward of the goal reached, the performance of Sec. 5.4. Episodes not
            followed to their end count with the middle of the goals' rewards.
        reward_error: how far the true expectation may lie from ``reward``, if all episodes end.
        discounted_return: expected discounted sum of rewards, penalties and costs of moves.
        goal_probability: ``[G]`` probability of ending at each goal.
        steps: expected number of robot actions.
        disagreement: expected number of steps in which the person sees the robot in another mode
            than their own.
        overridden: expected number of steps in which the action is not what the input asks for.
        unresolved: probability of the episodes not followed to their end; the numbers other than
            ``reward`` leave out what those still did.
        decisions: number of distinct decisions met.
    """

    reward: float
    reward_error: float
    discounted_return: float
    goal_probability: FloatArray
    steps: float
    disagreement: float
    overridden: float
    unresolved: float
    decisions: int


@dataclass(frozen=True)
class Visits:
    """The distinct decisions of one time step, with the probability of coming to each.

    Attributes:
        step: the time step, from 0.
        decisions: ``N`` decisions.
        weight: ``[N, P, M]`` probability, for each partner, of coming to it in each mode.
    """

    step: int
    decisions: Decisions
    weight: FloatArray


def evaluate(
    robot: Decider,
    partner: SimulatedPartner,
    *,
    tolerance: float = TOLERANCE,
    max_steps: int = MAX_STEPS,
) -> Evaluation:
    """Evaluate ``robot`` with ``partner``.

    Args:
        robot: the robot; its belief starts from its prior.
        partner: a person who follows the adaptation model.
        tolerance: largest probability of the episodes that are not followed to their end, at
            least `SMALLEST_TOLERANCE`.
        max_steps: episodes are not followed beyond this number of actions, whatever their
            probability.

    Raises:
        ValueError: if the tolerance is below what rounding allows.
    """
    return evaluate_all(robot, [partner], tolerance=tolerance, max_steps=max_steps)[0]


def evaluate_all(
    robot: Decider,
    partners: Sequence[SimulatedPartner],
    *,
    tolerance: float = TOLERANCE,
    max_steps: int = MAX_STEPS,
) -> list[Evaluation]:
    """Evaluate ``robot`` with each of ``partners``, in one expansion; else as `evaluate`."""
    if not tolerance >= SMALLEST_TOLERANCE:
        raise ValueError(f"tolerance must be at least {SMALLEST_TOLERANCE}, not {tolerance}")
    threshold = FIRST_THRESHOLD * tolerance
    while True:
        evaluations, cut_short = _evaluate(robot, partners, threshold, max_steps)
        if cut_short or max(e.unresolved for e in evaluations) <= tolerance:
            return evaluations
        threshold /= FINER


def _evaluate(
    robot: Decider, partners: Sequence[SimulatedPartner], threshold: float, max_steps: int
) -> tuple[list[Evaluation], bool]:
    """The evaluations, and whether ``max_steps`` rather than the threshold ended the expansion."""
    model, world = robot.model, robot.model.world
    count, goals = len(partners), len(world.goals)
    rewards = np.array([goal.reward for goal in world.goals])
    goal_probability = np.zeros((count, goals))
    steps, disagreement, overridden, discounted = np.zeros((4, count))
    decisions = last_step = 0
    for visits in expand(robot, *partners, threshold=threshold, max_steps=max_steps):
        taken = visits.decisions
        mass = visits.weight.sum(axis=2)  # [N, P]
        differs = 1.0 - model.perceived[taken.window, taken.action]  # [N, M], Eq. 7
        seen = np.einsum("npm,nm->p", visits.weight, differs)
        decisions += len(taken)
        steps += mass.sum(axis=0)
        disagreement += seen
        overridden += mass[(taken.asked >= 0) & (taken.asked != taken.action)].sum(axis=0)
        reached = world.goal_of[world.outcomes[taken.state, taken.action]]  # [N, outcomes]
        chance = model.outcome_chances(taken.state, taken.action, taken.human_input)
        arrives = (reached[:, :, None] == np.arange(goals)) * chance[:, :, None]
        arrived = np.einsum("np,nog->pg", mass, arrives)
        goal_probability += arrived
        paid = model.reward[taken.window, taken.action]  # [N, M], Eq. 6
        discounted += model.discount**visits.step * np.einsum("npm,nm->p", visits.weight, paid)
        discounted += model.discount ** (visits.step + 1) * (arrived * rewards).sum(axis=1)
        last_step = visits.step
    unresolved = np.maximum(0.0, 1.0 - goal_probability.sum(axis=1))
    middle, reach = (rewards.max() + rewards.min()) / 2, (rewards.max() - rewards.min()) / 2
    evaluations = [
        Evaluation(
            reward=float((goal_probability[i] * rewards).sum() + unresolved[i] * middle),
            reward_error=float(unresolved[i] * reach),
            discounted_return=float(discounted[i]),
            goal_probability=goal_probability[i],
            steps=float(steps[i]),
            disagreement=float(disagreement[i]),
            overridden=float(overridden[i]),
            unresolved=float(unresolved[i]),
            decisions=decisions,
        )
        for i in range(count)
    ]
    return evaluations, last_step == max_steps - 1


def expand(
    robot: Decider,
    *partners: SimulatedPartner,
    threshold: float = FIRST_THRESHOLD * TOLERANCE,
    max_steps: int = MAX_STEPS,
) -> Iterator[Visits]:
    """Every decision that ``robot`` can come to with any of ``partners``, step by step.

    Args:
        robot: the robot; its belief starts from its prior.
        partners: people who follow the adaptation model.
        threshold: situations that are less likely than this with every partner are left out,
            and what would follow them.
        max_steps: number of time steps to go.

    Yields:
        The distinct decisions of each time step.
    """
    model, world, windows = robot.model, robot.model.world, robot.model.windows
    starts, inputs = world.start_chances, len(model.input_names)
    alpha = _adaptabilities(partners, len(world.goals))
    robot.reset()
    window = windows.beginning[list(starts)]
    belief = np.repeat(robot.belief[None], len(starts), axis=0)
    modes = np.stack([partner.mode_distribution(model) for partner in partners])
    weight = np.array(list(starts.values()))[:, None, None] * modes
    for step in range(max_steps):
        likely = weight.sum(axis=2).max(axis=1) >= threshold
        if not likely.any():
            return
        window, belief, weight = window[likely], belief[likely], weight[likely]
        # Each situation with each input.
        likelihood = model.input_likelihood[windows.state[window]]  # [N, A_h, M]
        seen = weight[:, None] * likelihood[:, :, None]  # [N, A_h, P, M]
        where, observed = np.nonzero(seen.any(axis=(2, 3)))
        human_input = np.where(observed < inputs, observed, NO_INPUT)
        decisions = robot.decide_many(window[where], human_input, belief[where])
        seen = seen[where, observed]
        yield Visits(step, decisions, seen)
        perceived = model.perceived[decisions.window, decisions.action]
        kept = np.einsum("npm,nmk->npk", seen, model.kept_modes(decisions.window, decisions.action))
        # The partners' modes move as a belief over them would, Eq. 3-4.
        moved = human_filter.predict(kept, alpha, perceived, None)
        chance = model.outcome_chances(decisions.state, decisions.action, decisions.human_input)
        which, outcome = np.nonzero(chance > 0)
        reached = windows.next[decisions.window, decisions.action][which, outcome]
        moved = moved[which] * chance[which, outcome][:, None, None]
        on = ~world.ends[windows.state[reached]]
        window, belief, weight = _merge(reached[on], decisions.forecast[which[on]], moved[on])


def _adaptabilities(partners: Sequence[SimulatedPartner], goals: int) -> FloatArray:
    """``[P]``, or ``[P, M]`` where it differs from goal to goal for one of them."""
    alpha = np.stack([partner.rates(goals) for partner in partners])
    return alpha[:, 0] if np.all(alpha == alpha[:, :1]) else alpha


def _merge(
    window: IntArray, belief: FloatArray, weight: FloatArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """The distinct pairs of window and belief, with the weights of equal ones added up."""
    if len(window) == 0:
        return window, belief, weight
    rounded = belief.reshape(len(window), -1).round(SAME_BELIEF)
    rows = np.ascontiguousarray(np.column_stack([window, rounded]))
    keys = rows.view(np.dtype((np.void, rows.dtype.itemsize * rows.shape[1]))).ravel()
    _, first, which = np.unique(keys, return_index=True, return_inverse=True)
    merged = np.zeros((len(first), *weight.shape[1:]))
    np.add.at(merged, which, weight)
    return window[first], belief[first], merged
