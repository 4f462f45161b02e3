"""Mutual adaptation: the MOMDP policy with the match rule (Sec. 5.3 and 6.1)."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.formalism import SharedAutonomy
from coadapt.momdp.model import MOMDP
from coadapt.momdp.policy import AlphaVectorPolicy, action_values
from coadapt.robots.decide import decide_by
from coadapt.robots.match import MatchRule
from coadapt.robots.robot import Decision, Decisions, one_situation
from coadapt.robots.tables import ANSWERS, RobotTables, robot_tables


class MutualAdaptation:
    """Guides a person who will follow, complies with a person who will not.

    Args:
        model: what the robot believes of world and person.
        policy: a solution of ``model.to_momdp()``.
        match_rule: when to execute the person's input instead of the policy's action.
    """

    name = "mutual_adaptation"

    def __init__(
        self,
        model: SharedAutonomy,
        policy: AlphaVectorPolicy,
        match_rule: MatchRule | None = None,
    ) -> None:
        self.model = model
        self.policy = policy
        self.match_rule = MatchRule() if match_rule is None else match_rule
        self.reset()

    @cached_property
    def _problem(self) -> MOMDP:
        """What the policy solves: needed for explanations, not for decisions."""
        return self.model.to_momdp()

    @cached_property
    def tables(self) -> RobotTables:
        """The robot as arrays."""
        threshold = self.match_rule.threshold
        return robot_tables(self.model, ANSWERS, policy=self.policy, threshold=threshold)

    @property
    def planning_model(self) -> SharedAutonomy:
        """The model."""
        return self.model

    @property
    def belief(self) -> FloatArray:
        """``[A, M]`` belief behind the last decision, or at the start of the episode."""
        return self._belief

    def reset(self, belief: FloatArray | None = None, window: int | None = None) -> None:
        """Begin an episode from ``belief`` ``[A, M]``, by default the model's prior."""
        start = self.model.prior if belief is None else belief
        self._belief = self._forecast = start
        self._expected = None if window is None else np.array([window])

    def act(self, state: int, human_input: int | None) -> int:
        """The action to execute in ``state`` after ``human_input``.

        Raises:
            ValueError: see `Robot.act`.
        """
        return self.decide(state, human_input).action

    def decide(self, state: int, human_input: int | None) -> Decision:
        """As `act`, with what led to it."""
        situation = one_situation(self.model, state, human_input, self._forecast, self._expected)
        decision = self.decide_many(*situation)[0]
        self._belief, self._forecast = decision.belief, decision.forecast
        self._expected = self.model.windows.next[decision.window, decision.action]
        return decision

    def decide_many(
        self, windows: IntArray, human_inputs: IntArray, beliefs: FloatArray
    ) -> Decisions:
        """Decide in many situations at once, see `Robot.decide_many`.

        The events of one time step are in `coadapt.robots.kernels.decide`.
        """
        return decide_by(self.tables, windows, human_inputs, beliefs)

    def action_values(self, decision: Decision) -> FloatArray:
        """``[A_r]`` value of each action by one step of look-ahead to the policy's value."""
        return action_values(self._problem, self.policy, decision.window, decision.belief.ravel())
