"""Shared autonomy from its definitions, slowly: all that is kept is the whole history."""

from __future__ import annotations

from dataclasses import dataclass

from coadapt import SharedAutonomy
from coadapt.human import Adaptability

Step = tuple[int, int]
"""A robot state and the action taken there."""

Belief = dict[tuple[int, int], float]
"""Probabilities of pairs of an adaptability's index and a mode."""


@dataclass(frozen=True)
class Recall:
    """The equations of the paper as functions of the steps so far, oldest first."""

    model: SharedAutonomy

    @property
    def alpha(self) -> Adaptability:
        assert isinstance(self.model.adaptability, Adaptability)
        return self.model.adaptability

    @property
    def modes(self) -> range:
        return range(len(self.model.world.goals))

    @property
    def actions(self) -> range:
        return range(self.model.world.actions)

    def state(self, steps: list[Step]) -> int:
        if not steps:
            return self.model.world.start
        return int(self.model.world.moves[steps[-1]])

    def done(self, steps: list[Step]) -> bool:
        return self.state(steps) in self.model.world.goal_states

    def seen(self, steps: list[Step]) -> list[float]:
        """Eq. 1-2: ``P(m_r | x^{t-k+1}, a^{t-k+1}, ..., x^t, a^t)``, ``steps`` ending at t."""
        weight = [1.0 for _ in self.modes]
        for x, a in steps[-self.model.memory :]:
            weight = [w * self.model.modal_policies[m, x, a] for m, w in enumerate(weight)]
        total = sum(weight)
        return [w / total if total > 0 else 1 / len(weight) for w in weight]

    def reward(self, steps: list[Step], action: int, mode: int) -> float:
        """Eq. 6-8."""
        world, x = self.model.world, self.state(steps)
        if x in world.goal_states:
            return world.goals[world.goal_states.index(x)].reward
        seen = self.seen([*steps, (x, action)])
        return sum(self.model.disagreement_cost * seen[m_r] for m_r in self.modes if m_r != mode)

    def mode_moves(self, steps: list[Step], i: int, mode: int, mode_next: int) -> float:
        """Eq. 3-4 after the last of ``steps``, for the adaptability with index ``i``."""
        alpha = float(self.alpha.values[i])
        return sum(
            chance * (alpha * (mode_next == m_r) + (1 - alpha) * (mode_next == mode))
            for m_r, chance in enumerate(self.seen(steps))
        )

    def input_chance(self, steps: list[Step], mode: int, human_input: int) -> float:
        """``O(a_h | m, x)`` in the state to which ``steps`` led."""
        return float(self.model.modal_policies[mode, self.state(steps), human_input])

    def prior(self) -> Belief:
        assert self.model.mode_prior is not None
        return {
            (i, m): float(p) * float(q)
            for i, p in enumerate(self.alpha.prior)
            for m, q in enumerate(self.model.mode_prior)
        }

    def after_input(self, belief: Belief, steps: list[Step], human_input: int) -> Belief:
        """Not normalised."""
        return {
            (i, m): p * self.input_chance(steps, m, human_input) for (i, m), p in belief.items()
        }

    def after_action(self, belief: Belief, steps: list[Step]) -> Belief:
        """Carried through T_mh and T_alpha by the last of ``steps``."""
        moved = dict.fromkeys(belief, 0.0)
        for (i, m), p in belief.items():
            for j, m_next in moved:
                share = float(self.alpha.transition[i, j])
                moved[j, m_next] += p * share * self.mode_moves(steps, i, m, m_next)
        return moved

    def best(self, belief: Belief, steps: list[Step], horizon: int) -> float:
        """The largest expected discounted reward of ``horizon`` actions, ``belief`` its weight."""
        if horizon == 0:
            return 0.0
        values: list[float] = []
        for a in self.actions:
            value = sum(p * self.reward(steps, a, m) for (_, m), p in belief.items())
            if not self.done(steps):
                later = [*steps, (self.state(steps), a)]
                forecast = self.after_action(belief, later)
                value += self.model.discount * sum(
                    self.best(self.after_input(forecast, later, o), later, horizon - 1)
                    for o in self.actions
                )
            values.append(value)
        return max(values)
