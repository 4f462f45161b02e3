"""A cell of a sweep: everything that its result depends on, and the key made of it."""

from __future__ import annotations

from functools import cached_property
from hashlib import sha256

import msgspec
import numpy as np

from coadapt import __version__
from coadapt.robots.setup import RobotSetup
from coadapt.robots.task_setup import AnySetup, TaskSetup
from coadapt.simulation.sweep.grid import FORMAT
from coadapt.simulation.sweep.people import Person

PLAN_ASIDE = ("match_threshold",)
"""What a robot's setup has and its plan does not depend on."""


class Cell(msgspec.Struct, frozen=True, kw_only=True, dict=True):
    """One combination of a grid.

    Attributes:
        setup: the robot and its task.
        match_rule: whether it follows the match rule; None where that makes no difference.
        partner: the simulated person.
        seed, episodes, trials, carry_belief, exact, tolerance, max_steps: as in the sweep. Those
            that make no difference have their defaults.
        format: version of the format.
        coadapt: version of the package; another one may come to other results.
    """

    setup: AnySetup
    match_rule: bool | None
    partner: Person
    seed: int
    episodes: int
    trials: int
    carry_belief: bool
    exact: bool
    tolerance: float
    max_steps: int
    format: int = FORMAT
    coadapt: str = __version__

    @cached_property
    def content(self) -> bytes:
        """Everything as JSON without blanks, the names in alphabetical order."""
        return msgspec.json.encode(self, order="sorted")

    @cached_property
    def key(self) -> str:
        """The SHA-256 of `content`, 64 hexadecimal digits."""
        return sha256(self.content).hexdigest()

    @cached_property
    def plan_key(self) -> str:
        """The same for cells whose robots follow one plan."""
        values = msgspec.to_builtins(self.setup)
        kept = {name: value for name, value in values.items() if name not in PLAN_ASIDE}
        return sha256(msgspec.json.encode(kept, order="sorted")).hexdigest()

    @property
    def rewards(self) -> dict[str, float]:
        """What each goal of the task is worth."""
        return rewards_of(self.setup)

    def rng(self) -> np.random.Generator:
        """The cell's own random stream: it depends on the content and on nothing else."""
        return np.random.default_rng(np.random.SeedSequence(int(self.key, 16)))


def tidy(setup: AnySetup) -> AnySetup:
    """``setup`` with each number of the type it has in files, and no description of its task.

    So equal setups have equal contents however they were made.
    """
    if isinstance(setup, TaskSetup):
        task = msgspec.structs.replace(setup.task, title="", about="")
        setup = msgspec.structs.replace(setup, task=task)
        return msgspec.convert(msgspec.to_builtins(setup), TaskSetup)
    return msgspec.convert(msgspec.to_builtins(setup), RobotSetup)


def rewards_of(setup: AnySetup) -> dict[str, float]:
    """What each goal of a setup's task is worth."""
    if isinstance(setup, RobotSetup):
        return {"left": setup.left_reward, "right": setup.right_reward}
    return {goal.name: goal.reward for goal in setup.task.goals}
