"""The paper's task, computed: solve it, evaluate it, draw sample runs, compare the conditions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from coadapt.formalism import SharedAutonomy
from coadapt.momdp import AlphaVectorPolicy
from coadapt.momdp.sarsop import Record, Solution
from coadapt.report.identities import Identity, identities
from coadapt.report.performance import (
    ALPHAS,
    RobotResult,
    evaluate_curve,
    simulate_partner,
)
from coadapt.report.planning import solve
from coadapt.report.samples import SampleRun, sample_runs
from coadapt.robots import NEVER_MATCH, MatchRule, MutualAdaptation, NoAdaptation, OneWayAdaptation
from coadapt.robots.robot import Robot
from coadapt.simulation import SimulatedPartner, Summary, evaluate_all
from coadapt.worlds import table_clearing

Progress = Callable[[str], None]
"""Called with a short sentence when a stage of the work begins."""

SMALLEST_GAP, LARGEST_GAP = 1e-6, 0.1
"""Below, planning takes minutes; above, the gap exceeds what one step more or less is worth."""

FINER_GAP, MOST_BACKUPS = 10.0, 20_000
"""How many times smaller the gap is of the run that shows how the bounds close in, and its end."""


POLICY_TOLERANCE = 3e-4
"""Probability of episodes that the evaluation of a robot without the rule may leave unfinished."""

MATCHED_TOLERANCE = 3e-3
"""Probability of the episodes that the evaluation of a robot with the match rule may leave
unfinished. Executing inputs makes so many episodes distinct that each factor of 3 costs seconds."""


@dataclass(frozen=True)
class Settings:
    """What can be chosen.

    Attributes:
        runs: simulated runs for each robot and adaptability, at least 2.
        seed: from which all runs are drawn.
        gap: the planner stops when its bounds are this close, in reward units; 1e-6 to 0.1.
        model: world and people; the paper's task by default.
        match_rule: of the robots that follow one.
        alphas: adaptability of the simulated users.

    Raises:
        ValueError: if a value is out of its range.
    """

    runs: int = 1000
    seed: int = 0
    gap: float = 1e-3
    model: SharedAutonomy = field(default_factory=lambda: SharedAutonomy(table_clearing()))
    match_rule: MatchRule = field(default_factory=MatchRule)
    alphas: tuple[float, ...] = ALPHAS

    def __post_init__(self) -> None:
        if self.runs < 2:
            raise ValueError(f"runs must be at least 2, not {self.runs}")
        if self.seed < 0:
            raise ValueError(f"seed must be at least 0, not {self.seed}")
        if not SMALLEST_GAP <= self.gap <= LARGEST_GAP:
            wanted = f"from {SMALLEST_GAP:g} to {LARGEST_GAP:g}"
            raise ValueError(f"gap must be a number {wanted}, not {self.gap:g}")


@dataclass(frozen=True)
class Planned:
    """A planning problem and what the solver made of it; no time is kept, so it is reproducible.

    Attributes:
        observed, hidden, actions, observations: sizes of the problem.
        status: why the solver stopped.
        gap: largest difference of the bounds at any root.
        backups, vectors: the work done, and the size of the policy.
        root_names: the first inputs.
        root_probability: of each of them.
        root_lower, root_upper: bounds of the value at the belief after each.
        lower, upper: the same weighted by probability.
    """

    observed: int
    hidden: int
    actions: int
    observations: int
    status: str
    gap: float
    backups: int
    vectors: int
    root_names: tuple[str, ...]
    root_probability: tuple[float, ...]
    root_lower: tuple[float, ...]
    root_upper: tuple[float, ...]
    lower: float
    upper: float


@dataclass(frozen=True)
class Reproduction:
    """Everything the report shows.

    Attributes:
        settings: what was asked for.
        first_mode: the mode in which all users start, the goal worth less.
        mutual, one_way: the planners' results.
        trace: bounds over work of a run that goes on to a smaller gap.
        robots: every robot's results, see `results`.
        samples: the sample runs.
        identities: the identities.
    """

    settings: Settings
    first_mode: int
    mutual: Planned
    one_way: Planned
    trace: tuple[Record, ...]
    robots: tuple[RobotResult, ...]
    samples: tuple[SampleRun, ...]
    identities: tuple[Identity, ...]

    def robot(self, key: str) -> RobotResult:
        """The results of robot ``key``: ``mutual_policy``, ``mutual_rule``, ``one_way_policy``,
        ``one_way_rule`` or ``none``."""
        return next(robot for robot in self.robots if robot.key == key)

    @property
    def conditions(self) -> tuple[RobotResult, ...]:
        """The robots of the three conditions of Sec. 6.1, as participants met them."""
        return tuple(self.robot(key) for key in ("none", "mutual_rule", "one_way_rule"))


def reproduce(settings: Settings, progress: Progress | None = None) -> Reproduction:
    """Compute everything.

    Args:
        settings: what can be chosen.
        progress: told what is being done.

    Raises:
        ValueError: if the world has not two goals of different reward.
    """
    tell: Progress = _say_nothing if progress is None else progress
    model = settings.model
    first_mode = _worse_goal(model)
    tell("Solving the task")
    problem = model.to_momdp()
    solution = solve(problem, settings.gap)
    trace = solve(problem, settings.gap / FINER_GAP, MOST_BACKUPS).trace
    tell("Solving the one-way model")
    one_way = solve(model.one_way().to_momdp(), settings.gap)

    entrants = _entrants(settings, solution.policy, one_way.policy)
    seed, sample_seed = np.random.SeedSequence(settings.seed).spawn(2)
    robots: list[RobotResult] = []
    for entrant in entrants:
        tell(f"Evaluating: {entrant.label}")
        robots.append(_evaluate(entrant, settings, first_mode, seed))
    tell("Choosing the sample runs")
    mutual = next(entrant.robot for entrant in entrants if entrant.key == "mutual_rule")
    samples = sample_runs(mutual, first_mode, sample_seed)
    tell("Checking the identities")
    return Reproduction(
        settings=settings,
        first_mode=first_mode,
        mutual=_planned(model, solution),
        one_way=_planned(model.one_way(), one_way),
        trace=trace,
        robots=tuple(robots),
        samples=samples,
        identities=identities(model, settings.gap),
    )


@dataclass(frozen=True)
class _Entrant:
    """A robot to evaluate; the names are those of `RobotResult`."""

    key: str
    label: str
    condition: str
    match_rule: bool | None
    robot: Robot


def _entrants(
    settings: Settings, mutual: AlphaVectorPolicy, one_way: AlphaVectorPolicy
) -> list[_Entrant]:
    model = settings.model
    found = [_Entrant("none", "No adaptation", "No adaptation", None, NoAdaptation(model))]
    for follows, rule in ((True, settings.match_rule), (False, NEVER_MATCH)):
        kind, more = ("rule", "") if follows else ("policy", ", policy alone")
        name = "Mutual adaptation"
        robot = MutualAdaptation(model, mutual, rule)
        found.append(_Entrant(f"mutual_{kind}", name + more, name, follows, robot))
        name = "One-way adaptation"
        robot = OneWayAdaptation(model, one_way, rule)
        found.append(_Entrant(f"one_way_{kind}", name + more, name, follows, robot))
    return found


def _evaluate(
    entrant: _Entrant, settings: Settings, first_mode: int, seed: np.random.SeedSequence
) -> RobotResult:
    partners = [SimulatedPartner(alpha, first_mode) for alpha in settings.alphas]
    central = entrant.condition == "Mutual adaptation"
    robot = entrant.robot
    tolerance = MATCHED_TOLERANCE if entrant.match_rule else POLICY_TOLERANCE
    return RobotResult(
        key=entrant.key,
        label=entrant.label,
        condition=entrant.condition,
        match_rule=entrant.match_rule,
        alpha=settings.alphas,
        exact=tuple(evaluate_all(robot, partners, tolerance=tolerance)),
        simulated=_simulate(robot, partners, settings.runs, seed) if central else (),
        optimal_goal=settings.model.world.optimal_goal,
        curve=evaluate_curve(robot, first_mode) if central else None,
    )


def _simulate(
    robot: Robot, partners: Sequence[SimulatedPartner], runs: int, seed: np.random.SeedSequence
) -> tuple[Summary, ...]:
    # Spawning counts the children, so it is done from a copy: every robot meets users drawn from
    # the same seeds, and differences are the robots' own.
    copy = np.random.SeedSequence(seed.entropy, spawn_key=seed.spawn_key)
    return tuple(
        simulate_partner(robot, partner, runs, np.random.default_rng(child))
        for partner, child in zip(partners, copy.spawn(len(partners)), strict=True)
    )


def _worse_goal(model: SharedAutonomy) -> int:
    goals = model.world.goals
    if len(goals) != 2 or goals[0].reward == goals[1].reward:
        raise ValueError("the report is about two goals of different reward")
    return 1 - model.world.optimal_goal


def _planned(model: SharedAutonomy, solution: Solution) -> Planned:
    problem = model.to_momdp()
    observed, hidden, actions, observations = problem.shape
    return Planned(
        observed=observed,
        hidden=hidden,
        actions=actions,
        observations=observations,
        status=solution.status.value,
        gap=solution.gap,
        backups=solution.backups,
        vectors=solution.vectors,
        root_names=tuple(root.label for root in problem.roots),
        root_probability=tuple(root.probability for root in problem.roots),
        root_lower=tuple(map(float, solution.root_lower)),
        root_upper=tuple(map(float, solution.root_upper)),
        lower=solution.lower,
        upper=solution.upper,
    )


def _say_nothing(_: str) -> None:
    return
