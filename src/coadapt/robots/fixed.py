"""No adaptation: the robot goes to the optimal goal, deaf to inputs (Sec. 6.1)."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.formalism import SharedAutonomy
from coadapt.robots.decide import decide_by
from coadapt.robots.robot import Decision, Decisions, one_situation
from coadapt.robots.tables import FIXED, RobotTables, robot_tables


class NoAdaptation:
    """Follows a shortest path to the goal with the largest reward.

    Where moves are uncertain it does what brings it there soonest (`World.nearness`). Of several
    actions alike in that it takes the one with the lowest index. It learns nothing: its belief
    stays what it was at the start of the episode.

    Args:
        model: gives the world and its goals.

    Raises:
        ValueError: if the optimal goal cannot be reached from the start.
    """

    name = "no_adaptation"

    def __init__(self, model: SharedAutonomy) -> None:
        self.model = model
        world = model.world
        self._nearness = world.nearness(world.optimal_goal)
        if not self._nearness[list(world.start_chances)].any(axis=1).all():
            goal = world.goals[world.optimal_goal].name
            raise ValueError(f"the optimal goal, {goal}, cannot be reached from the start")
        self.reset()

    @cached_property
    def tables(self) -> RobotTables:
        """The robot as arrays."""
        return robot_tables(self.model, FIXED, going=np.argmax(self._nearness, axis=1))

    @property
    def planning_model(self) -> SharedAutonomy:
        """The model."""
        return self.model

    @property
    def belief(self) -> FloatArray:
        """``[A, M]`` the belief given at the start, by default the model's prior."""
        return self._belief

    def reset(self, belief: FloatArray | None = None, window: int | None = None) -> None:
        """Begin an episode."""
        self._belief = self.model.prior if belief is None else belief
        self._expected = None if window is None else np.array([window])

    def act(self, state: int, human_input: int | None) -> int:
        """The next action of a shortest path from ``state``; the input is not looked at.

        Raises:
            ValueError: see `Robot.act`.
        """
        return self.decide(state, human_input).action

    def decide(self, state: int, human_input: int | None) -> Decision:
        """As `act`, with the whole decision."""
        situation = one_situation(self.model, state, human_input, self._belief, self._expected)
        decision = self.decide_many(*situation)[0]
        self._expected = self.model.windows.next[decision.window, decision.action]
        return decision

    def decide_many(
        self, windows: IntArray, human_inputs: IntArray, beliefs: FloatArray
    ) -> Decisions:
        """Decide in many situations at once, see `Robot.decide_many`."""
        return decide_by(self.tables, windows, human_inputs, beliefs)

    def action_values(self, decision: Decision) -> FloatArray:
        """``[A_r]`` discounted reward of the optimal goal after each action."""
        world = self.model.world
        reward = world.goals[world.optimal_goal].reward
        worth = reward * self._discounted_nearness[decision.state]
        return np.where(self._nearness[decision.state] == 0, -np.inf, worth)

    @cached_property
    def _discounted_nearness(self) -> FloatArray:
        """``[X, A_r]`` nearness with the model's discount: needed for explanations alone."""
        world = self.model.world
        return world.nearness(world.optimal_goal, self.model.discount)
