"""A robot written down: the few numbers from which it can be built again, the same to the bit.

Planning is deterministic, so two robots built from equal setups by the same version of the package
take the same decisions.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Literal, Protocol, get_args

import msgspec
import numpy as np

from coadapt.errors import InputError
from coadapt.formalism import SharedAutonomy
from coadapt.formalism.shared_autonomy import PAPER_ADAPTABILITY
from coadapt.human.history import LONGEST_MEMORY, count_windows
from coadapt.momdp.model import MOMDP
from coadapt.momdp.policy import AlphaVectorPolicy
from coadapt.robots.fixed import NoAdaptation
from coadapt.robots.match import MatchRule
from coadapt.robots.mutual import MutualAdaptation
from coadapt.robots.one_way import OneWayAdaptation
from coadapt.robots.robot import NO_INPUT
from coadapt.worlds import table_clearing

RobotName = Literal["mutual_adaptation", "one_way_adaptation", "no_adaptation"]
"""The robots of Sec. 6.1, by their ``name``."""

ROBOT_NAMES: tuple[RobotName, ...] = get_args(RobotName)

Progress = Callable[[str], None]
"""Called with a short sentence when a stage of the work begins."""

LARGEST_GRID = 10_000
"""Cells."""

LARGEST_REWARD = 1e6

LARGEST_STEP_COST = 1000.0
"""Nats; long before this the modal policies are uniform over the shortest paths."""

MOST_ADAPTABILITIES = 100

MOST_WINDOWS = 100_000
"""Windows of the last steps; they grow exponentially with the memory."""


ConditionRobot = MutualAdaptation | OneWayAdaptation | NoAdaptation
"""A robot of one of the conditions of Sec. 6.1."""


class SetupError(InputError):
    """A value of a setup is out of its range.

    Attributes:
        field: name of the value, as in `RobotSetup`.
        problem: the rest of the sentence that begins with that name.
    """

    def __init__(self, field: str, problem: str) -> None:
        super().__init__(f"{field} {problem}")
        self.field = field
        self.problem = problem


class RobotSetup(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a robot for the table-clearing task is built from.

    Attributes:
        robot: which of the robots of Sec. 6.1.
        columns: width of the grid in cells, at least 3.
        rows: depth of the grid in cells, at least 1.
        left_reward: reward of the left goal, in the paper's units.
        right_reward: reward of the right goal, in the paper's units.
        memory: ``k``, the steps from which the person infers the robot's goal, at least 1.
        adaptability: the values of alpha that the robot considers, increasing, in [0, 1].
        disagreement_cost: ``C`` of Eq. 8, at most 0.
        discount: gamma, in [0, 1).
        step_cost: ``c`` of the maximum-entropy modal policies, in nats.
        match_threshold: agreement at which the input is executed, at least 0; above 1 it never is.
        gap: the planner stops when its bounds are this close.

    Raises:
        SetupError: if a value is out of its range; names the value.
    """

    robot: RobotName = "mutual_adaptation"
    columns: int = 13
    rows: int = 4
    left_reward: float = 10.0
    right_reward: float = 11.0
    memory: int = 1
    adaptability: tuple[float, ...] = PAPER_ADAPTABILITY
    disagreement_cost: float = -0.32
    discount: float = 0.99
    step_cost: float = 3.0
    match_threshold: float = 0.9
    gap: float = 1e-3

    def __post_init__(self) -> None:
        require_field("columns", self.columns >= 3, "at least 3", self.columns)
        require_field("rows", self.rows >= 1, "at least 1", self.rows)
        cells = self.columns * self.rows
        few = f"so few that there are at most {LARGEST_GRID:,} cells"
        require_field("columns", cells <= LARGEST_GRID, few, f"{cells:,}")
        for field in ("left_reward", "right_reward"):
            reward: float = getattr(self, field)
            wanted = f"a number of size {LARGEST_REWARD:g} at most"
            require_field(field, abs(reward) <= LARGEST_REWARD, wanted, reward)
        wanted = f"from 1 to {LONGEST_MEMORY}"
        require_field("memory", 1 <= self.memory <= LONGEST_MEMORY, wanted, self.memory)
        self._require_adaptability()
        cost = self.disagreement_cost
        require_field(
            "disagreement_cost", -LARGEST_REWARD <= cost <= 0, "a number of at most 0", cost
        )
        require_field("discount", 0 <= self.discount < 1, "at least 0 and below 1", self.discount)
        cost = self.step_cost
        require_field("step_cost", 0 < cost <= LARGEST_STEP_COST, "above 0 and at most 1000", cost)
        require_planned(self)

    def _require_adaptability(self) -> None:
        values = self.adaptability
        require_field(
            "adaptability",
            1 <= len(values) <= MOST_ADAPTABILITIES,
            f"1 to {MOST_ADAPTABILITIES} values",
            len(values),
        )
        shown = ",".join(f"{value:g}" for value in values)
        inside = all(0 <= value <= 1 for value in values)
        require_field("adaptability", inside, "values from 0 to 1", shown)
        increasing = all(a < b for a, b in pairwise(values))
        require_field("adaptability", increasing, "increasing values", shown)

    def model(self) -> SharedAutonomy:
        """World and people, the same for all three robots.

        Raises:
            SetupError: if the step cost is too small for the grid, or the memory too long.
        """
        world = table_clearing(
            self.columns,
            self.rows,
            left_reward=self.left_reward,
            right_reward=self.right_reward,
        )
        windows = count_windows(world.moves, list(world.start_chances), world.ends, self.memory)
        few = f"so short that there are at most {MOST_WINDOWS:,} windows of steps"
        require_field(
            "memory", windows <= MOST_WINDOWS, few, f"{self.memory} ({windows:.3g} windows)"
        )
        model = SharedAutonomy(
            world,
            memory=self.memory,
            adaptability=self.adaptability,
            disagreement_cost=self.disagreement_cost,
            discount=self.discount,
            step_cost=self.step_cost,
        )
        try:
            _ = model.modal_policies
        except ValueError as error:
            raise SetupError("step_cost", f"cannot be used: {error}") from error
        return model

    def build(self, progress: Progress | None = None) -> ConditionRobot:
        """The robot, its policy planned now, see `planned_robot`.

        Raises:
            SetupError: as `model`.
        """
        return planned_robot(self, progress)


class Planned(Protocol):
    """What a robot is planned from: the part that all setups have."""

    @property
    def robot(self) -> RobotName:
        """Which of the robots of Sec. 6.1."""
        ...

    @property
    def match_threshold(self) -> float:
        """Agreement at which the input is executed."""
        ...

    @property
    def gap(self) -> float:
        """The planner stops when its bounds are this close."""
        ...

    def model(self) -> SharedAutonomy:
        """World and people."""
        ...


def planned_robot(setup: Planned, progress: Progress | None = None) -> ConditionRobot:
    """The robot of ``setup``, its policy planned now.

    Args:
        setup: what it is built from.
        progress: told what is being done. What it raises ends the planning.

    Raises:
        KeyboardInterrupt: if planning was interrupted; there is no half-planned robot.
    """
    tell = _say_nothing if progress is None else progress
    tell("Building the model")
    model = setup.model()
    problem = planning_problem(setup, model)
    policy = None if problem is None else planned_policy(problem, setup.gap, tell)
    robot = robot_with(setup, model, policy)
    tell("Preparing the robot")
    # The first decision waits for the compiler; later ones take microseconds.
    window = model.windows.beginning[[model.world.start]]
    _ = robot.decide_many(window, np.array([NO_INPUT]), robot.belief[None])
    return robot


def planning_problem(setup: Planned, model: SharedAutonomy) -> MOMDP | None:
    """What the robot of ``setup`` plans for in its ``model``; None if it does not plan."""
    if setup.robot == "no_adaptation":
        return None
    return (model.one_way() if setup.robot == "one_way_adaptation" else model).to_momdp()


def robot_with(
    setup: Planned, model: SharedAutonomy, policy: AlphaVectorPolicy | None
) -> ConditionRobot:
    """The robot of ``setup`` in its ``model``, with a solution of its `planning_problem`."""
    if policy is None:
        return NoAdaptation(model)
    robot = OneWayAdaptation if setup.robot == "one_way_adaptation" else MutualAdaptation
    return robot(model, policy, MatchRule(setup.match_threshold))


def planned_policy(
    problem: MOMDP, gap: float, progress: Progress | None = None
) -> AlphaVectorPolicy:
    """A policy planned until its bounds are as close as ``gap``, a function of the problem alone.

    Raises:
        KeyboardInterrupt: if planning was interrupted.
    """
    tell = _say_nothing if progress is None else progress
    tell("Preparing the planner")
    # Imported now: whoever only reads or checks a setup need not wait for the compiler.
    from coadapt.momdp.sarsop import SARSOP, Record, Status  # noqa: PLC0415

    def tell_bounds(record: Record) -> None:
        tell(
            f"Planning: value between {record.lower:.3f} and {record.upper:.3f} "
            f"after {record.backups:,} backups"
        )

    solution = SARSOP(gap=gap, callback=tell_bounds).solve(problem)
    if solution.status is not Status.GAP:
        # The policy so far is no function of the problem.
        raise KeyboardInterrupt
    return solution.policy


def require_planned(setup: Planned) -> None:
    """Raise SetupError unless what all setups have is in range."""
    require_field(
        "robot", setup.robot in ROBOT_NAMES, f"one of {', '.join(ROBOT_NAMES)}", setup.robot
    )
    threshold = setup.match_threshold
    require_field("match_threshold", 0 <= threshold < math.inf, "a number of at least 0", threshold)
    require_field("gap", 0 < setup.gap < math.inf, "a number above 0", setup.gap)


def require_field(field: str, holds: bool, wanted: str, found: object) -> None:
    """Raise SetupError unless ``holds``."""
    if not holds:
        raise SetupError(field, f"must be {wanted}, not {found}")


def _say_nothing(_: str) -> None:
    return
