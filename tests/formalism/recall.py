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
class Past:
    """All that happened: the steps, oldest first, and where the robot is now."""

    steps: tuple[Step, ...]
    state: int

    def then(self, action: int, state: int) -> Past:
        """After one step more."""
        return Past((*self.steps, (self.state, action)), state)


@dataclass(frozen=True)
class Recall:
    """The equations of the paper as functions of the past."""

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

    @property
    def observations(self) -> range:
        """The inputs, and none at all if that may be."""
        model = self.model
        silence = 0.0 if model.inputs is None else model.inputs.silence
        count = model.world.actions if model.inputs is None else len(model.inputs.names)
        return range(count + (silence > 0))

    def goal(self, past: Past) -> int | None:
        """The goal that the robot is in."""
        for g, goal in enumerate(self.model.world.goals):
            if past.state in goal.states:
                return g
        return None

    def moves(self, state: int, action: int) -> dict[int, float]:
        """T_x: where the action may lead, and how probably."""
        world = self.model.world
        if world.chances is None:
            return {int(world.moves[state, action]): 1.0}
        outcomes = zip(world.moves[state, action], world.chances[state, action], strict=True)
        return {int(x): float(p) for x, p in outcomes if p > 0}

    def seen(self, past: Past, action: int) -> list[float]:
        """Eq. 1-2: ``P(m_r | x^{t-k+1}, a^{t-k+1}, ..., x^t, a^t)`` with ``action`` at t."""
        weight = [1.0 for _ in self.modes]
        for x, a in (*past.steps, (past.state, action))[-self.model.memory :]:
            weight = [w * self.model.modal_policies[m, x, a] for m, w in enumerate(weight)]
        total = sum(weight)
        return [w / total if total > 0 else 1 / len(weight) for w in weight]

    def wish(self, state: int, mode: int, action: int) -> float:
        """The human half of the modal policy."""
        given = self.model.human_policies
        return float((self.model.modal_policies if given is None else given)[mode, state, action])

    def reward(self, past: Past, action: int, mode: int) -> float:
        """Eq. 6-8, the cost of the move, and the penalty for another action than wanted."""
        model, world, goal = self.model, self.model.world, self.goal(past)
        if goal is not None:
            return world.goals[goal].reward
        seen = self.seen(past, action)
        total = sum(model.disagreement_cost * seen[m_r] for m_r in self.modes if m_r != mode)
        wanted = sum(self.wish(past.state, mode, a) for a in self.actions if a != action)
        total += model.action_disagreement_cost * wanted
        return total - (0.0 if world.costs is None else float(world.costs[past.state, action]))

    def mode_moves(self, past: Past, action: int, i: int, mode: int, mode_next: int) -> float:
        """Eq. 3-4 after ``action``, for the adaptability with index ``i``."""
        alpha = self.alpha.rates(len(self.modes))[i]
        return sum(
            chance * (alpha[m_r] * (mode_next == m_r) + (1 - alpha[m_r]) * (mode_next == mode))
            for m_r, chance in enumerate(self.seen(past, action))
        )

    def input_chance(self, state: int, mode: int, observation: int) -> float:
        """``O(a_h | m, x)``; the observation after the inputs is that there was none."""
        inputs = self.model.inputs
        if inputs is None:
            return self.wish(state, mode, observation)
        if observation == len(inputs.names):
            return inputs.silence
        wished = sum(
            self.wish(state, mode, a) * float(inputs.likelihood[a, observation])
            for a in self.actions
        )
        return (1 - inputs.silence) * wished

    def prior(self) -> Belief:
        assert self.model.mode_prior is not None
        return {
            (i, m): float(p) * float(q)
            for i, p in enumerate(self.alpha.prior)
            for m, q in enumerate(self.model.mode_prior)
        }

    def after_input(self, belief: Belief, state: int, observation: int) -> Belief:
        """Not normalised."""
        return {
            (i, m): p * self.input_chance(state, m, observation) for (i, m), p in belief.items()
        }

    def after_action(self, belief: Belief, past: Past, action: int) -> Belief:
        """Carried through T_mh and T_alpha."""
        moved = dict.fromkeys(belief, 0.0)
        for (i, m), p in belief.items():
            for j, m_next in moved:
                share = float(self.alpha.transition[i, j])
                moved[j, m_next] += p * share * self.mode_moves(past, action, i, m, m_next)
        return moved

    def best(self, belief: Belief, past: Past, horizon: int) -> float:
        """The largest expected discounted reward of ``horizon`` actions, ``belief`` its weight."""
        if horizon == 0:
            return 0.0
        values: list[float] = []
        for a in self.actions:
            value = sum(p * self.reward(past, a, m) for (_, m), p in belief.items())
            if self.goal(past) is None:
                forecast = self.after_action(belief, past, a)
                for x, chance in self.moves(past.state, a).items():
                    value += (
                        self.model.discount
                        * chance
                        * sum(
                            self.best(
                                self.after_input(forecast, x, o), past.then(a, x), horizon - 1
                            )
                            for o in self.observations
                        )
                    )
            values.append(value)
        return max(values)
