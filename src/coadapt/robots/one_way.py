"""One-way adaptation: the robot adapts to the person, never the other way (Sec. 6.1)."""

from __future__ import annotations

from coadapt.arrays import FloatArray, IntArray
from coadapt.formalism import SharedAutonomy
from coadapt.momdp.policy import AlphaVectorPolicy
from coadapt.robots.match import MatchRule
from coadapt.robots.mutual import MutualAdaptation
from coadapt.robots.robot import Decision, Decisions
from coadapt.robots.tables import RobotTables


class OneWayAdaptation:
    """Infers the person's goal and assists them towards it.

    It is the mutual-adaptation robot of the model with alpha fixed to 0 and equal rewards at all
    goals. Its belief has shape ``[1, M]``.

    Args:
        model: the model of the other conditions; `SharedAutonomy.one_way` is taken of it.
        policy: a solution of ``model.one_way().to_momdp()``.
        match_rule: as for `MutualAdaptation`.
    """

    name = "one_way_adaptation"

    def __init__(
        self,
        model: SharedAutonomy,
        policy: AlphaVectorPolicy,
        match_rule: MatchRule | None = None,
    ) -> None:
        self.model = model
        self._robot = MutualAdaptation(model.one_way(), policy, match_rule)

    @property
    def tables(self) -> RobotTables:
        """The robot as arrays."""
        return self._robot.tables

    @property
    def planning_model(self) -> SharedAutonomy:
        """The one-way model."""
        return self._robot.model

    @property
    def policy(self) -> AlphaVectorPolicy:
        """The solution of the one-way model."""
        return self._robot.policy

    @property
    def match_rule(self) -> MatchRule:
        """When the person's input is executed instead of the policy's action."""
        return self._robot.match_rule

    @property
    def belief(self) -> FloatArray:
        """``[1, M]`` belief behind the last decision, or at the start of the episode."""
        return self._robot.belief

    def reset(self, belief: FloatArray | None = None, window: int | None = None) -> None:
        """Begin an episode from ``belief`` ``[1, M]``, by default the model's prior."""
        self._robot.reset(belief, window)

    def act(self, state: int, human_input: int | None) -> int:
        """The action to execute, see `MutualAdaptation.act`."""
        return self._robot.act(state, human_input)

    def decide(self, state: int, human_input: int | None) -> Decision:
        """As `act`, with what led to it."""
        return self._robot.decide(state, human_input)

    def decide_many(
        self, windows: IntArray, human_inputs: IntArray, beliefs: FloatArray
    ) -> Decisions:
        """Decide in many situations at once, see `Robot.decide_many`."""
        return self._robot.decide_many(windows, human_inputs, beliefs)

    def action_values(self, decision: Decision) -> FloatArray:
        """``[A_r]`` value of each action in the one-way model."""
        return self._robot.action_values(decision)
