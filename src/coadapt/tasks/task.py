"""A task written down: place, goals, person and model; what a file or a log holds of it."""

from __future__ import annotations

import msgspec
import numpy as np

from coadapt.formalism import SharedAutonomy
from coadapt.human.history import LONGEST_MEMORY, count_windows
from coadapt.requirements import (
    LARGEST_REWARD,
    FieldError,
    require,
    require_chance,
    require_name,
    require_names,
)
from coadapt.tasks.goal import TaskGoal
from coadapt.tasks.graph import TaskGraph
from coadapt.tasks.map import TaskMap
from coadapt.tasks.person import ActionInputs, AnyInputs, TaskAdaptability
from coadapt.worlds import World

FORMAT = 1
"""Version of the task format."""

LONGEST_TEXT = 2000
"""Characters of a task's description."""

LARGEST_STEP_COST = 1000.0
"""Nats; long before this the modal policies are uniform over the shortest paths."""

LARGEST_TASK = 60_000
"""Bytes of a task as JSON: it has to fit into a line of a log."""

MOST_GOALS = 50

MOST_WINDOWS = 100_000
"""Windows of the last steps; they grow exponentially with the memory."""

MOST_NUMBERS = 100_000_000
"""Rewards of a planning problem: windows times actions times hidden states."""


class TaskModel(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The parameters of the model, with the defaults of `SharedAutonomy`.

    Attributes:
        memory: ``k``, the steps from which the person infers the robot's goal, at least 1.
        disagreement_cost: ``C`` of Eq. 8, at most 0.
        action_disagreement_cost: ``C_a``, at most 0.
        discount: gamma, in [0, 1).
        step_cost: ``c`` of the maximum-entropy modal policies, in nats.
    """

    memory: int = 1
    disagreement_cost: float = -0.32
    action_disagreement_cost: float = 0.0
    discount: float = 0.99
    step_cost: float = 3.0

    def __post_init__(self) -> None:
        wanted = f"from 1 to {LONGEST_MEMORY}"
        require(("memory",), 1 <= self.memory <= LONGEST_MEMORY, wanted, self.memory)
        for name in ("disagreement_cost", "action_disagreement_cost"):
            cost: float = getattr(self, name)
            require((name,), -LARGEST_REWARD <= cost <= 0, "a number of at most 0", cost)
        require_chance(("discount",), self.discount, most_included=False)
        inside = 0 < self.step_cost <= LARGEST_STEP_COST
        require(("step_cost",), inside, "above 0 and at most 1000", self.step_cost)


class Task(
    msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True
):
    """A task for a robot and a person.

    Attributes:
        format: version of the format, `FORMAT`.
        name: short identifier.
        title: what it is, in a few words.
        about: what it is, in a few sentences.
        map, graph: the place, one of the two.
        goals: the goals, one mode each.
        inputs: what the person steers with.
        adaptability: what the robot assumes of theirs.
        model: the parameters of the model.

    Raises:
        FieldError: if a value cannot be used, or the parts do not fit together.
    """

    format: int
    name: str
    goals: tuple[TaskGoal, ...]
    title: str = ""
    about: str = ""
    map: TaskMap | None = None
    graph: TaskGraph | None = None
    inputs: AnyInputs = ActionInputs()
    adaptability: TaskAdaptability = TaskAdaptability()
    model: TaskModel = TaskModel()

    def __post_init__(self) -> None:
        if self.format > FORMAT:
            raise FieldError(
                ("format",), f"is {self.format}, newer than this coadapt reads; expected {FORMAT}"
            )
        require(("format",), self.format == FORMAT, f"{FORMAT}", self.format)
        require_name(("name",), self.name)
        for name in ("title", "about"):
            length = len(getattr(self, name))
            require((name,), length <= LONGEST_TEXT, f"{LONGEST_TEXT:,} characters at most", length)
        require(("goals",), len(self.goals) <= MOST_GOALS, f"at most {MOST_GOALS}", len(self.goals))
        require_names(("goals",), [goal.name for goal in self.goals], MOST_GOALS)
        if (self.map is None) == (self.graph is None):
            found = "neither a map nor a graph" if self.map is None else "both a map and a graph"
            raise FieldError((), f"has {found}, expected one of them")
        _ = self.mode_prior
        size = len(msgspec.json.encode(self))
        few = f"so small that it takes at most {LARGEST_TASK:,} bytes"
        require((), size <= LARGEST_TASK, few, f"{size:,} as JSON")

    @property
    def mode_prior(self) -> tuple[float, ...] | None:
        """``M`` probabilities of the person's first goal, or None where they are all alike."""
        given = [goal.prior for goal in self.goals if goal.prior is not None]
        if not given:
            return None
        for i, goal in enumerate(self.goals):
            if goal.prior is None:
                raise FieldError(("goals", i, "prior"), "is missing, expected one for every goal")
        total = sum(given)
        key = ("goals", len(self.goals) - 1, "prior")
        require(key, abs(total - 1) <= 1e-9, "such that all sum to 1", f"{given[-1]:g}")
        return tuple(given)

    def world(self) -> World:
        """The place with its goals.

        Raises:
            FieldError: if drawing, states and goals do not fit together.
        """
        place = self.graph if self.map is None else self.map
        assert place is not None
        try:
            return place.build(self.name, self.goals)
        except FieldError:
            raise
        except ValueError as error:
            raise FieldError(("graph" if self.map is None else "map",), f"has {error}") from error

    def build(self) -> SharedAutonomy:
        """Place and person, the same for all robots.

        Raises:
            FieldError: if the parts do not fit together, or the problem would be too large.
        """
        world = self.world()
        alpha = self.adaptability.build(len(self.goals))
        memory = self.model.memory
        windows = count_windows(world.moves, list(world.start_chances), world.ends, memory)
        few = f"so short that there are at most {MOST_WINDOWS:,} windows of steps"
        key = ("model", "memory")
        require(key, windows <= MOST_WINDOWS, few, f"{memory} ({windows:.3g} windows)")
        hidden = len(alpha.prior) * len(self.goals)
        size = windows * world.actions * hidden
        few = (
            f"so small that windows times actions times hidden states are {MOST_NUMBERS:,} at most"
        )
        require((), size <= MOST_NUMBERS, few, f"{windows:,} x {world.actions} x {hidden}")
        model = SharedAutonomy(
            world,
            memory=memory,
            adaptability=alpha,
            mode_prior=self.mode_prior,
            disagreement_cost=self.model.disagreement_cost,
            action_disagreement_cost=self.model.action_disagreement_cost,
            discount=self.model.discount,
            step_cost=self.model.step_cost,
            inputs=None
            if self.inputs == ActionInputs()
            else self.inputs.build(world.action_names, np.asarray(world.directions)),
        )
        try:
            _ = model.modal_policies
        except ValueError as error:
            raise FieldError(("model", "step_cost"), f"cannot be used: {error}") from error
        return model
