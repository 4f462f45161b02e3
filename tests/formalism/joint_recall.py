"""Collaboration from its definitions, slowly: all that is kept is the whole history."""

from __future__ import annotations

from dataclasses import dataclass

from coadapt.formalism.collaboration import Collaboration
from coadapt.human import Adaptability

Step = tuple[int, int, int, int]
"""A state, the robot action and the human action taken there, the state they led to."""

Belief = dict[tuple[int, ...], float]
"""Weights of hidden states: (adaptability,), or (adaptability, mode) where modes are hidden."""


@dataclass(frozen=True)
class JointRecall:
    """The equations as functions of the steps since ``start``, oldest first."""

    model: Collaboration
    start: int

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
    def human_actions(self) -> range:
        return range(self.model.world.human_actions)

    @property
    def hidden(self) -> list[tuple[int, ...]]:
        kinds = range(len(self.alpha.values))
        if self.model.hidden_modes:
            return [(i, m) for i in kinds for m in self.modes]
        return [(i,) for i in kinds]

    def state(self, steps: list[Step]) -> int:
        return steps[-1][3] if steps else self.start

    def following(
        self, steps: list[Step], action: int, human_action: int
    ) -> list[tuple[list[Step], float]]:
        """The histories one step longer, with their probabilities."""
        world, x = self.model.world, self.state(steps)
        if world.chances is None:
            return [
                (
                    [*steps, (x, action, human_action, int(world.moves[x, action, human_action]))],
                    1.0,
                )
            ]
        return [
            ([*steps, (x, action, human_action, int(to))], float(chance))
            for to, chance in zip(
                world.moves[x, action, human_action],
                world.chances[x, action, human_action],
                strict=True,
            )
            if chance > 0
        ]

    def done(self, steps: list[Step]) -> bool:
        return self.state(steps) in [goal.at for goal in self.model.world.goals]

    def prior(self) -> Belief:
        assert self.model.mode_prior is not None
        if not self.model.hidden_modes:
            return {(i,): float(p) for i, p in enumerate(self.alpha.prior)}
        return {
            (i, m): float(p) * q
            for i, p in enumerate(self.alpha.prior)
            for m, q in enumerate(self.model.mode_prior)
        }

    def rate(self, i: int, m: int) -> float:
        """Readiness of the people of kind ``i`` to switch to mode ``m``."""
        values = self.alpha.values
        return float(values[i] if values.ndim == 1 else values[i, m])

    # Modes that are seen.

    def shown(self, half: int, state: int, action: int) -> int | None:
        """The only mode that takes an action; of the robot (half 0) or of the human (half 1)."""
        takes = [m for m in self.modes if self.model.modal_policies[half][m, state, action] > 0]
        return takes[0] if len(takes) == 1 else None

    def frequent(self, modes: list[int | None]) -> dict[int, float]:
        """The mode that occurs most often, as probabilities; none where there is no mode."""
        known = [m for m in modes if m is not None]
        most = max((known.count(m) for m in known), default=0)
        leaders = [m for m in self.modes if most and known.count(m) == most]
        if self.model.ties == "even" or not leaders:
            return {m: 1 / len(leaders) for m in leaders}
        in_order = known if self.model.ties == "earliest" else known[::-1]
        return {next(m for m in in_order if m in leaders): 1.0}

    def seen_mode_chance(self, steps: list[Step], i: int, mode: int) -> float:
        """Eq. 3-4 with what the last ``k`` pairs of modes tell."""
        assert self.model.mode_prior is not None
        if not steps:
            return self.model.mode_prior[mode]
        recent = steps[-self.model.memory :]
        own = self.frequent([self.shown(1, x, h) for x, _, h, _ in recent])
        robot = self.frequent([self.shown(0, x, a) for x, a, _, _ in recent])
        if not robot:  # nothing seen of the robot
            robot = dict.fromkeys(self.modes, 1 / len(self.modes))
        return sum(
            p * q * (self.rate(i, r) * (mode == r) + (1 - self.rate(i, r)) * (mode == m))
            for m, p in own.items()
            for r, q in robot.items()
        )

    # Modes that are hidden.

    def perceived(self, steps: list[Step]) -> list[float]:
        """Eq. 1-2, ``steps`` ending with the present one; its human action is not looked at."""
        weight = [1.0 for _ in self.modes]
        for x, a, _, _ in steps[-self.model.memory :]:
            weight = [
                w * float(self.model.modal_policies[0][m, x, a]) for m, w in enumerate(weight)
            ]
        total = sum(weight)
        return [w / total if total > 0 else 1 / len(weight) for w in weight]

    # Both.

    def human_chance(self, steps: list[Step], y: tuple[int, ...], human_action: int) -> float:
        policy = self.model.modal_policies[1][:, self.state(steps), human_action]
        if self.model.hidden_modes:
            return float(policy[y[1]])
        return sum(self.seen_mode_chance(steps, y[0], m) * float(policy[m]) for m in self.modes)

    def hidden_moves(self, steps: list[Step], y: tuple[int, ...], y_next: tuple[int, ...]) -> float:
        """After the last of ``steps``."""
        share = float(self.alpha.transition[y[0], y_next[0]])
        if not self.model.hidden_modes:
            return share
        return share * sum(
            chance
            * (
                self.rate(y[0], r) * (y_next[1] == r)
                + (1 - self.rate(y[0], r)) * (y_next[1] == y[1])
            )
            for r, chance in enumerate(self.perceived(steps))
        )

    def name(self, steps: list[Step]) -> str:
        """The name of the observed state of the planning problem."""
        world = self.model.world
        parts = [world.state_names[self.state(steps)]]
        if not self.model.hidden_modes:
            named = {None: "none", **{m: goal.name for m, goal in enumerate(world.goals)}}
            for x, a, h, _ in steps[-self.model.memory :]:
                parts.append(f"{named[self.shown(1, x, h)]}/{named[self.shown(0, x, a)]}")
            return ", ".join(parts)
        for x, a, _, _ in steps[max(0, len(steps) - self.model.memory + 1) :]:
            parts.append(f"{world.state_names[x]} {world.action_names[a]}")
        if steps:
            parts.append(f"human {world.human_action_names[steps[-1][2]]}")
        return ", ".join(parts)

    def best(self, belief: Belief, steps: list[Step], horizon: int) -> float:
        """The largest expected discounted reward of ``horizon`` actions, ``belief`` its weight."""
        if horizon == 0:
            return 0.0
        if self.done(steps):
            goal = [g.at for g in self.model.world.goals].index(self.state(steps))
            return sum(belief.values()) * self.model.world.goals[goal].reward
        values: list[float] = []
        for a in self.actions:
            value = 0.0
            for h in self.human_actions:
                mass = {y: p * self.human_chance(steps, y, h) for y, p in belief.items()}
                if not any(mass.values()):
                    continue
                for later, chance in self.following(steps, a, h):
                    forecast = dict.fromkeys(belief, 0.0)
                    for y, p in mass.items():
                        for y_next in forecast:
                            forecast[y_next] += chance * p * self.hidden_moves(later, y, y_next)
                    value += self.model.discount * self.best(forecast, later, horizon - 1)
            values.append(value)
        return max(values)
