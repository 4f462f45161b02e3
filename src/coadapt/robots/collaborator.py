"""A robot that moves the world together with a person, both at the same time (Sec. 2.3)."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.formalism.collaboration import Collaboration
from coadapt.human.history import NO_WINDOW
from coadapt.momdp.model import MOMDP
from coadapt.momdp.policy import AlphaVectorPolicy, action_values
from coadapt.robots.decide import decide_by, plan_by
from coadapt.robots.robot import NO_INPUT, Decision, Decisions, one_situation
from coadapt.robots.tables import FORESEES, RobotTables, robot_tables


class Collaborator:
    """Acts on what it expects of the person, and learns from what they did.

    A decision takes the human action of the same step too. It does not depend on it: the action is
    the one that `plan` gives before the human acts.

    Args:
        model: what the robot believes of world and person.
        policy: a solution of ``model.to_momdp()``.
    """

    name = "collaborator"

    def __init__(self, model: Collaboration, policy: AlphaVectorPolicy) -> None:
        self.model = model
        self.policy = policy
        self.reset()

    @cached_property
    def _problem(self) -> MOMDP:
        """What the policy solves: needed for explanations, not for decisions."""
        return self.model.to_momdp()

    @cached_property
    def tables(self) -> RobotTables:
        """The robot as arrays."""
        return robot_tables(self.model, FORESEES, policy=self.policy)

    @property
    def planning_model(self) -> Collaboration:
        """The model."""
        return self.model

    @property
    def belief(self) -> FloatArray:
        """``[A, M]`` belief after the last human action, or at the start of the episode."""
        return self._belief

    def reset(self, belief: FloatArray | None = None, window: int | None = None) -> None:
        """Begin an episode from ``belief`` ``[A, M]``, by default the model's prior."""
        start = self.model.prior if belief is None else belief
        self._belief = self._forecast = start
        self._expected: IntArray | None = None if window is None else np.array([window])

    def plan(self, state: int) -> int:
        """The action to take in ``state``, before the human action is known.

        Raises:
            ValueError: if the state is out of range or a goal, or neither a start nor the one to
                which the last actions led.
        """
        windows, _, beliefs = one_situation(self.model, state, None, self._forecast, self._expected)
        return int(plan_by(self.tables, windows, beliefs)[0])

    def act(self, state: int, human_input: int | None) -> int:
        """What `plan` gives; then takes account of the human action of this step.

        Raises:
            ValueError: as `decide`.
        """
        return self.decide(state, human_input).action

    def decide(self, state: int, human_input: int | None) -> Decision:
        """As `act`, with what led to it.

        Raises:
            ValueError: as `plan`, or if there is no human action or one that shows no mode.
        """
        situation = one_situation(self.model, state, human_input, self._forecast, self._expected)
        decisions = self.decide_many(*situation)
        (self._expected,) = self.model.after(
            decisions.window, decisions.action, decisions.human_input
        )
        self._belief, self._forecast = decisions.belief[0], decisions.forecast[0]
        return decisions[0]

    def decide_many(
        self, windows: IntArray, human_inputs: IntArray, beliefs: FloatArray
    ) -> Decisions:
        """Decide in many situations at once, see `Robot.decide_many`.

        The robot acts, and sees what the human did at the same time. The events of one time step
        are in `coadapt.robots.kernels.decide`.

        Raises:
            ValueError: if a human action is missing or shows no mode.
        """
        if np.any(human_inputs == NO_INPUT):
            raise ValueError("a collaboration needs an action of the human in every step")
        decisions = decide_by(self.tables, windows, human_inputs, beliefs)
        after = self.model.after(windows, decisions.action, human_inputs)
        impossible = after[:, 0] == NO_WINDOW
        if impossible.any():
            name = self.model.input_names[int(human_inputs[impossible.argmax()])]
            raise ValueError(f"the human action {name} belongs to no mode there")
        return decisions

    def action_values(self, decision: Decision) -> FloatArray:
        """``[A_r]`` value of each action under the belief after the human action was seen."""
        hidden = self.model.modes.hidden(decision.belief)
        return action_values(self._problem, self.policy, decision.window, hidden)
