"""The two identities of the paper's discussion, shown by numbers.

"If we fix in the model the human adaptability to 0 and assign equal costs for both goals, the
robot would assist the user in their goal. If we fix adaptability to 1 in the model (or we remove
the penalty for mode disagreement), the robot will always go to the optimal goal."

Each is tested against a planner that is built in another way: the first against one whose only
hidden variable is a goal that never changes (`goal_planner`), the others against plain shortest
paths. The robots are compared without the match rule, which belongs to execution, not to planning.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.formalism import SharedAutonomy
from coadapt.momdp import MOMDP, action_values
from coadapt.report.goal_planner import GoalPlanner, goal_problem
from coadapt.report.performance import ALPHAS
from coadapt.report.planning import solve
from coadapt.robots import (
    NEVER_MATCH,
    Decision,
    Decisions,
    MutualAdaptation,
    NoAdaptation,
    OneWayAdaptation,
)
from coadapt.simulation import SimulatedPartner, expand

TIGHT_GAP = 1e-7
"""Gap to which both planners of the first identity are solved, in reward units."""

MOST_BACKUPS = 100_000
"""Planning for an identity stops after these, whatever its gap: some thousands are enough."""

EQUAL_VALUE = 1e-6
"""Actions whose values differ by less are both optimal, in reward units."""

LIKELIHOOD = 1e-9
"""Situations of the one-way robot less likely than this are not compared; it has endlessly many."""

CERTAIN = 1e-9
"""How far a probability of 1 may lie from 1 in floating-point sums."""


@dataclass(frozen=True)
class Identity:
    """The outcome of comparing a robot with a planner built in another way.

    Attributes:
        key: short identifier.
        robot: which robot is compared, and how it is made from the model.
        planner: with what.
        decisions: number of distinct decisions compared.
        complete: whether those are all that can ever be reached.
        differing: number of them in which the actions differ.
        ties: how many of those are ties, both actions being optimal.
        largest_loss: largest value that the robot's action gives away, in reward units.
        optimal_goal: smallest probability of reaching the optimal goal in as many steps as a
            shortest path has, over partners of every adaptability and first mode; None where the
            identity does not speak of it.
        problem_difference: largest difference between any two numbers of the two planning problems,
            or None where there is one problem only.
        belief_difference: largest difference between the beliefs of the two, or None.
    """

    key: str
    robot: str
    planner: str
    decisions: int
    complete: bool
    differing: int
    ties: int
    largest_loss: float
    optimal_goal: float | None = None
    problem_difference: float | None = None
    belief_difference: float | None = None

    @property
    def holds(self) -> bool:
        """Whether the numbers bear the identity out."""
        differences = (self.problem_difference or 0.0, self.belief_difference or 0.0)
        return (
            self.differing == self.ties
            and self.largest_loss <= EQUAL_VALUE
            and (self.optimal_goal is None or self.optimal_goal >= 1 - CERTAIN)
            and max(differences) <= CERTAIN
        )


def identities(model: SharedAutonomy, gap: float) -> tuple[Identity, ...]:
    """All identities of ``model``, its robots planned to ``gap`` where that suffices."""
    return (
        one_way_is_goal_planning(model),
        always_optimal(
            "no_penalty",
            "Mutual adaptation without a penalty for disagreement, C = 0",
            replace(model, disagreement_cost=0.0),
            gap,
        ),
        always_optimal(
            "fully_adaptable",
            "Mutual adaptation with adaptability fixed to 1",
            replace(model, adaptability=(1.0,)),
            gap,
        ),
    )


def one_way_is_goal_planning(model: SharedAutonomy, likelihood: float = LIKELIHOOD) -> Identity:
    """Fixing alpha = 0 with equal rewards gives a robot that assists towards a fixed, unknown goal.

    Both robots go through the same situations, each with a belief of its own.

    Args:
        model: of all conditions.
        likelihood: situations less likely than this are left out.
    """
    one_way = model.one_way()
    ours = one_way.to_momdp()
    theirs = goal_problem(
        one_way.world,
        one_way.windows,
        one_way.modal_policies,
        one_way.disagreement_cost,
        one_way.discount,
    )
    policy = solve(theirs, TIGHT_GAP, MOST_BACKUPS).policy
    robot = OneWayAdaptation(model, solve(ours, TIGHT_GAP, MOST_BACKUPS).policy, NEVER_MATCH)
    planner = GoalPlanner(one_way.modal_policies, policy)
    pair = _SideBySide(robot, planner)
    partners = [SimulatedPartner(0.0, mode) for mode in range(len(model.world.goals))]
    decisions = differing = ties = 0
    largest_loss = belief_difference = 0.0
    for visits in expand(pair, *partners, threshold=likelihood):
        taken = visits.decisions
        beliefs = taken.belief[:, 1]  # the planner's
        wanted = planner.actions(taken.window, beliefs)
        decisions += len(taken)
        apart = np.abs(taken.belief[:, 0] - beliefs).max(initial=0.0)
        belief_difference = max(belief_difference, float(apart))
        for i in np.flatnonzero(wanted != taken.action):
            values = action_values(theirs, policy, int(taken.window[i]), beliefs[i])
            loss = float(values.max() - values[taken.action[i]])
            other = float(values.max() - values[wanted[i]])
            differing += 1
            ties += max(loss, other) <= EQUAL_VALUE
            largest_loss = max(largest_loss, loss)
    return Identity(
        key="one_way",
        robot="One-way adaptation: adaptability fixed to 0, equal rewards",
        planner="A planner whose only hidden variable is a goal that never changes",
        decisions=decisions,
        complete=likelihood <= 0,
        differing=differing,
        ties=ties,
        largest_loss=largest_loss,
        problem_difference=problem_difference(ours, theirs),
        belief_difference=belief_difference,
    )


def always_optimal(key: str, description: str, model: SharedAutonomy, gap: float) -> Identity:
    """The mutual-adaptation robot of ``model`` takes shortest paths to the optimal goal."""
    world = model.world
    policy = solve(model.to_momdp(), gap, MOST_BACKUPS).policy
    robot = MutualAdaptation(model, policy, NEVER_MATCH)
    fixed = NoAdaptation(model)
    modes = range(len(world.goals))
    partners = [SimulatedPartner(alpha, mode) for alpha, mode in product(ALPHAS, modes)]
    goal = world.goals[world.optimal_goal]
    steps = world.distance(world.optimal_goal)
    decisions = differing = ties = 0
    largest_loss = 0.0
    arrived = np.zeros(len(partners))
    # A robot that takes shortest paths is there after so many steps, whoever steers; the likelihood
    # of 0 leaves out nothing. One that does not is caught by the probability of having arrived.
    shortest = int(steps[world.start])
    for visits in expand(robot, *partners, threshold=0.0, max_steps=shortest):
        taken = visits.decisions
        wanted = fixed.decide_many(taken.window, taken.human_input, taken.belief).action
        reached = world.moves[taken.state, taken.action]
        loss = _worth(model, steps[world.moves[taken.state, wanted]]) - _worth(
            model, steps[reached]
        )
        differs = taken.action != wanted
        decisions += len(taken)
        differing += int(differs.sum())
        ties += int((differs & (np.abs(loss) <= EQUAL_VALUE)).sum())
        largest_loss = max(largest_loss, float(loss.max(initial=0.0)))
        arrived += visits.weight[np.isin(reached, goal.states)].sum(axis=(0, 2))
    return Identity(
        key=key,
        robot=description,
        planner="No adaptation: shortest paths to the optimal goal",
        decisions=decisions,
        complete=True,
        differing=differing,
        ties=ties,
        largest_loss=largest_loss,
        optimal_goal=float(arrived.min()),
    )


def problem_difference(a: MOMDP, b: MOMDP) -> float:
    """The largest difference between two numbers that stand for the same in two problems.

    Compared are the joint transition ``P(x', y' | x, y, a)`` of every edge, the observation
    probabilities after it, rewards, discount, and the roots' states, beliefs and probabilities.
    Infinite where the problems differ in shape or in where an action may lead.
    """
    fits = a.shape == b.shape and len(a.roots) == len(b.roots)
    if not fits or not np.array_equal(a.edge_start, b.edge_start):
        return float("inf")
    if not np.array_equal(a.edge_next, b.edge_next):
        return float("inf")
    differences = [np.abs(a.reward - b.reward).max(), abs(a.discount - b.discount)]
    x_count, _, a_count, _ = a.shape
    for x, action in product(range(x_count), range(a_count)):
        for e in a.edges(x, action):
            maps = a.transition.matrix(int(a.edge_map[e])) - b.transition.matrix(int(b.edge_map[e]))
            following = a.edge_next[e]
            seen = (
                a.observation[a.observation_index[action, following]]
                - b.observation[b.observation_index[action, following]]
            )
            differences += [np.abs(maps).max(), np.abs(seen).max()]
    for ours, theirs in zip(a.roots, b.roots, strict=True):
        if ours.x != theirs.x:
            return float("inf")
        differences.append(np.abs(ours.belief - theirs.belief).max())
        differences.append(abs(ours.probability - theirs.probability))
    return float(max(differences))


def _worth(model: SharedAutonomy, steps: IntArray) -> FloatArray:
    """Discounted reward of the optimal goal one move and ``steps`` further moves away."""
    goal = model.world.goals[model.world.optimal_goal]
    return np.where(steps < 0, 0.0, goal.reward * model.discount ** (1.0 + steps))


class _SideBySide:
    """The one-way robot, with the goal planner's belief carried beside its own.

    Beliefs are ``[2, M]``: in row 0 the robot's, in row 1 the planner's.
    """

    name = "side_by_side"

    def __init__(self, robot: OneWayAdaptation, planner: GoalPlanner) -> None:
        self._robot = robot
        self._planner = planner
        self.model = robot.model
        self.reset()

    @property
    def planning_model(self) -> SharedAutonomy:
        return self._robot.planning_model

    @property
    def belief(self) -> FloatArray:
        return self._belief

    def reset(self, belief: FloatArray | None = None, window: int | None = None) -> None:
        self._robot.reset(None if belief is None else belief[:1], window)
        both = np.concatenate([self._robot.belief, self._planner.prior[None]])
        self._belief = both if belief is None else belief

    def act(self, state: int, human_input: int | None) -> int:
        return self._robot.act(state, human_input)

    def decide(self, state: int, human_input: int | None) -> Decision:
        return self._robot.decide(state, human_input)

    def decide_many(
        self, windows: IntArray, human_inputs: IntArray, beliefs: FloatArray
    ) -> Decisions:
        decisions = self._robot.decide_many(windows, human_inputs, beliefs[:, :1])
        states = self.model.windows.state[windows]
        planners = self._planner.correct(beliefs[:, 1], states, human_inputs)[:, None]
        return replace(
            decisions,
            belief=np.concatenate([decisions.belief, planners], axis=1),
            # A goal that never changes is the same at the next step.
            forecast=np.concatenate([decisions.forecast, planners], axis=1),
        )

    def action_values(self, decision: Decision) -> FloatArray:
        return self._robot.action_values(decision)
