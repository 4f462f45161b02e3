"""Mutual adaptation: the MOMDP policy with the match rule (Sec. 5.3 and 6.1)."""

from __future__ import annotations

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.formalism import SharedAutonomy
from coadapt.momdp.policy import AlphaVectorPolicy, action_values
from coadapt.robots.match import MatchRule
from coadapt.robots.robot import NO_INPUT, Decision, Decisions, one_situation


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
        self._problem = model.to_momdp()
        self.reset()

    @property
    def planning_model(self) -> SharedAutonomy:
        """The model."""
        return self.model

    @property
    def belief(self) -> FloatArray:
        """``[A, M]`` belief behind the last decision, or at the start of the episode."""
        return self._belief

    def reset(self, belief: FloatArray | None = None) -> None:
        """Begin an episode from ``belief`` ``[A, M]``, by default the model's prior."""
        start = self.model.prior if belief is None else belief
        self._belief = self._forecast = start

    def act(self, state: int, human_input: int | None) -> int:
        """The action to execute in ``state`` after ``human_input``.

        Raises:
            ValueError: if state or input are out of range, or the state is a goal.
        """
        return self.decide(state, human_input).action

    def decide(self, state: int, human_input: int | None) -> Decision:
        """As `act`, with what led to it."""
        situation = one_situation(self.model, state, human_input, self._forecast)
        decision = self.decide_many(*situation)[0]
        self._belief, self._forecast = decision.belief, decision.forecast
        return decision

    def decide_many(
        self, states: IntArray, human_inputs: IntArray, beliefs: FloatArray
    ) -> Decisions:
        """Decide in many situations at once, see `Robot.decide_many`.

        The lines are the events of one time step in their order.
        """
        model = self.model
        given = human_inputs != NO_INPUT
        corrected = model.correct(beliefs, states, human_inputs)
        belief = np.where(given[:, None, None], corrected, beliefs)
        planned = self.policy.actions_at(states, belief.reshape(len(states), model.prior.size))
        agreement = self.match_rule.agreement(belief.sum(axis=-2), model.perceived[states, planned])
        matched = self.match_rule.fires(agreement, human_inputs)
        action = np.where(matched, human_inputs, planned)
        forecast = model.predict(belief, states, action)
        return Decisions(
            states, human_inputs, action, planned, agreement, matched, belief, forecast
        )

    def action_values(self, decision: Decision) -> FloatArray:
        """``[A_r]`` value of each action by one step of look-ahead to the policy's value."""
        return action_values(self._problem, self.policy, decision.state, decision.belief.ravel())
