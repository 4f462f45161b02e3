"""Shared autonomy as a mixed-observability MDP (Sec. 5.1).

Observed is the window of the robot's last ``k`` steps, which ends in its state: what the person
remembers (`coadapt.human.history`). With a memory of one step ``X = X_r``. Hidden are the person's
adaptability and mode, ``Y = A x M`` with index ``y = alpha * |M| + m``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.formalism.reward import reward
from coadapt.human import filter as human_filter
from coadapt.human.adaptation import Adaptability, require_distribution
from coadapt.human.features import Features, feature_windows
from coadapt.human.history import NO_ACTION, Windows
from coadapt.human.inputs import Inputs
from coadapt.human.modal import maximum_entropy_policy
from coadapt.human.perceived import perceived_robot_mode
from coadapt.momdp.model import MOMDP, Root
from coadapt.momdp.transition import JumpTransition
from coadapt.worlds import World

PAPER_ADAPTABILITY = (0.0, 0.25, 0.5, 0.75, 1.0)
"""The values of alpha in Sec. 6.5."""


@dataclass(frozen=True)
class SharedAutonomy:
    """A world shared by a robot that moves and a person who steers: the model of Sec. 2 to 5.

    Attributes:
        world: states, moves, goals; one mode for each goal.
        memory: the ``k`` last steps from which the person infers the robot's mode, the present one
            among them; 1 to `coadapt.human.history.LONGEST_MEMORY`.
        features: what counts of the past steps, where all of them are too many to keep
            (`coadapt.human.features`); everything by default.
        adaptability: values of alpha, or rows of values, one for each goal (then with a uniform
            prior, fixed over time); or an `Adaptability` with a prior and transition of its own.
        mode_prior: ``[M]`` belief over the person's first mode; uniform by default.
        disagreement_cost: ``C`` of Eq. 8, at most 0.
        action_disagreement_cost: ``C_a``, at most 0: paid for the probability that the person wants
            another action (`coadapt.formalism.reward`). The paper names it as future work.
        discount: gamma, in [0, 1). The paper does not state it.
        step_cost: ``c`` of the maximum-entropy modal policies, in nats, or ``[X, A]`` costs of the
            single moves; not in the paper.
        policies: ``[M, X, A]`` modal policies to use instead of the maximum-entropy ones, for
            both halves of the joint policy.
        human_policies: ``[M, X, A]`` the human half where it is not the robot's: the robot actions
            that a person in each mode wants.
        inputs: what the person steers with; the robot's actions by default.

    Raises:
        ValueError: if a parameter is out of its range.
    """

    world: World
    memory: int = 1
    adaptability: Adaptability | Sequence[float] | Sequence[Sequence[float]] = PAPER_ADAPTABILITY
    mode_prior: Sequence[float] | None = None
    disagreement_cost: float = -0.32
    action_disagreement_cost: float = 0.0
    discount: float = 0.99
    step_cost: float | FloatArray = 3.0
    policies: FloatArray | None = None
    human_policies: FloatArray | None = None
    inputs: Inputs | None = None
    features: Features | None = None

    def __post_init__(self) -> None:
        for name, cost in (
            ("disagreement cost", self.disagreement_cost),
            ("action disagreement cost", self.action_disagreement_cost),
        ):
            if not -np.inf < cost <= 0:
                raise ValueError(f"{name} must be at most 0, not {cost}")
        if not 0 <= self.discount < 1:
            raise ValueError(f"discount must lie in [0, 1), not {self.discount}")
        world = self.world
        shape = (len(world.goals), world.states, world.actions)
        for name, policies in (
            ("policies", self.policies),
            ("human policies", self.human_policies),
        ):
            if policies is not None:
                require_distribution(name, policies, shape)
        if self.inputs is not None and len(self.inputs.likelihood) != world.actions:
            raise ValueError(
                f"inputs for {len(self.inputs.likelihood)} actions, but the world has "
                f"{world.actions}"
            )
        # The derived pieces refuse bad values; compute the cheap ones now, so that errors surface
        # where the model is made.
        _ = self.alpha.rates(len(world.goals)), self.prior, self.windows

    @cached_property
    def alpha(self) -> Adaptability:
        """The values, prior and transition of adaptability."""
        if isinstance(self.adaptability, Adaptability):
            return self.adaptability
        return Adaptability.over(self.adaptability)

    @cached_property
    def mode_names(self) -> tuple[str, ...]:
        """A mode is named after its goal."""
        return tuple(goal.name for goal in self.world.goals)

    @cached_property
    def modal_policies(self) -> FloatArray:
        """``[M, X, A]``: the robot half of each mode's policy (Sec. 3.1)."""
        if self.policies is not None:
            return self.policies
        world = self.world
        return np.stack(
            [
                maximum_entropy_policy(
                    world.moves,
                    goal.states,
                    self.step_cost,
                    [x for x in world.goal_states if x not in goal.states],
                    world.chances,
                )
                for goal in world.goals
            ]
        )

    @property
    def wishes(self) -> FloatArray:
        """``[M, X, A]``: the human half: the robot action that a person in each mode wants."""
        return self.modal_policies if self.human_policies is None else self.human_policies

    @cached_property
    def interface(self) -> Inputs:
        """What the person steers with."""
        if self.inputs is not None:
            return self.inputs
        return Inputs.actions(self.world.action_names, self.world.directions)

    @property
    def input_names(self) -> tuple[str, ...]:
        """What the person can steer with."""
        return self.interface.names

    @cached_property
    def windows(self) -> Windows:
        """What the person may remember: the observed states of the planning problem."""
        world, starts = self.world, list(self.world.start_chances)
        if self.features is not None:
            return feature_windows(world.moves, starts, world.ends, self.memory, self.features)
        return Windows.of(world.moves, starts, world.ends, self.memory)

    @cached_property
    def perceived(self) -> FloatArray:
        """``[W, A, M]``: ``P(m_r | w, a_r)`` in window ``w``, Eq. 2."""
        return perceived_robot_mode(self.modal_policies, self.windows.steps(self.world.moves))

    @cached_property
    def reward(self) -> FloatArray:
        """``[W, A, M]``: ``R(w, m_h, a_r)``, Eq. 6-8."""
        return reward(
            self.world,
            self.windows.state,
            self.perceived,
            self.disagreement_cost,
            self.wishes if self.action_disagreement_cost != 0 else None,
            self.action_disagreement_cost,
        )

    @cached_property
    def prior(self) -> FloatArray:
        """``[A, M]`` joint belief over adaptability and mode before the first input."""
        modes = len(self.world.goals)
        prior = np.full(modes, 1 / modes) if self.mode_prior is None else np.array(self.mode_prior)
        require_distribution("mode prior", prior, (modes,))
        return np.outer(self.alpha.prior, prior)

    @cached_property
    def input_likelihood(self) -> FloatArray:
        """``[X_r, O, M]``: ``O(a_h | m, x_r)`` of Sec. 5.1, by robot state.

        The last observation is that there is no input, if the interface has `Inputs.silence`.
        """
        return np.ascontiguousarray(np.moveaxis(self.interface.observed(self.wishes), 0, -1))

    def correct(
        self, belief: FloatArray, window: int | IntArray, human_input: int | IntArray
    ) -> FloatArray:
        """The belief ``[A, M]`` after the person's input in ``window`` (Eq. 5).

        Arrays ``[N]`` of windows and inputs go with beliefs ``[N, A, M]``.
        """
        state = self.windows.state[window]
        return human_filter.correct(belief, self.input_likelihood[state, human_input])

    def predict(
        self, belief: FloatArray, window: int | IntArray, action: int | IntArray
    ) -> FloatArray:
        """The belief ``[A, M]`` after the robot took ``action`` in ``window`` (Eq. 9).

        Arrays ``[N]`` of windows and actions go with beliefs ``[N, A, M]``.
        """
        alpha = self.alpha
        transition = None if alpha.is_fixed else alpha.transition
        return human_filter.predict(
            belief, alpha.values, self.perceived[window, action], transition
        )

    def kept_modes(self, window: int | IntArray, action: int | IntArray) -> FloatArray:
        """``[..., M, M]``: somebody who does not adapt keeps the mode in which they are."""
        modes = len(self.world.goals)
        return np.broadcast_to(np.eye(modes), (*np.shape(window), modes, modes))

    def outcome_chances(
        self, state: IntArray, action: IntArray, human_input: IntArray
    ) -> FloatArray:
        """``[K, N]`` the probability of each outcome of ``action``; inputs move nothing."""
        return self.world.outcome_chances[state, action]

    def one_way(self) -> SharedAutonomy:
        """The one-way model of Sec. 6.1: alpha fixed to 0 and equal rewards at all goals."""
        best = max(goal.reward for goal in self.world.goals)
        goals = tuple(replace(goal, reward=best) for goal in self.world.goals)
        return replace(self, world=replace(self.world, goals=goals), adaptability=(0.0,))

    def to_momdp(self) -> MOMDP:
        """The planning problem: ``{X, Y, A_r, T_x, T_alpha, T_mh, R, Omega, O}``.

        Observed states are the `windows`. The roots are the prior conditioned on each possible
        first input in the start state.
        """
        world, alpha, windows = self.world, self.alpha, self.windows
        actions = world.actions
        count, modes = self.prior.shape
        # One edge for each action and outcome.
        chance = world.outcome_chances[windows.state]  # [W, A, N]
        possible = (chance > 0) & ~world.ends[windows.state][:, None, None]
        targets, which = np.unique(self.perceived.reshape(-1, modes), axis=0, return_inverse=True)
        which = np.broadcast_to(which.reshape(len(windows), actions, 1), chance.shape)[possible]
        jumps = JumpTransition(
            rate=alpha.rates(modes),
            target=targets,
            mixing=None if alpha.is_fixed else alpha.transition,
        )
        transition = jumps
        if not world.is_deterministic:
            pairs: FloatArray = np.column_stack([which.astype(np.float64), chance[possible]])
            parts, which = np.unique(pairs, axis=0, return_inverse=True)
            transition = jumps.scaled(parts[:, 0].astype(np.int64), parts[:, 1])
        observation = np.moveaxis(self.input_likelihood, 2, 1)  # [X, M, O]
        return MOMDP(
            edge_start=np.concatenate(([0], np.cumsum(possible.sum(axis=2).ravel()))),
            edge_next=windows.next[possible],
            edge_map=which.ravel(),
            transition=transition,
            observation=np.ascontiguousarray(np.tile(observation, (1, count, 1))),
            observation_index=np.tile(windows.state, (actions, 1)),
            reward=np.tile(self.reward, (1, 1, count)),
            discount=self.discount,
            roots=self._roots(),
            observed_names=self._window_names(),
            hidden_names=tuple(
                f"{name} {mode}" for name in alpha.names for mode in self.mode_names
            ),
            action_names=world.action_names,
            observation_names=self.interface.observation_names,
        )

    def _window_names(self) -> tuple[str, ...]:
        """The first state of each window and the actions since, with where chance led them."""
        world, windows = self.world, self.windows
        names: list[str] = [world.state_names[first] for first in map(int, windows.first)]
        state = windows.first
        for taken, outcome in zip(windows.actions.T, windows.outcomes.T, strict=True):
            is_step = taken != NO_ACTION
            state = np.where(is_step, world.outcomes[state, taken, outcome], state)
            for w in np.flatnonzero(is_step):
                names[w] += f", {world.action_names[taken[w]]}"
                if not world.is_deterministic:
                    names[w] += f" to {world.state_names[state[w]]}"
        return tuple(names)

    def _roots(self) -> tuple[Root, ...]:
        roots: list[Root] = []
        for start, chance in self.world.start_chances.items():
            window = int(self.windows.beginning[start])
            for i, name in enumerate(self.interface.observation_names):
                likelihood = self.input_likelihood[start, i]
                probability = chance * float((self.prior * likelihood).sum())
                if probability > 0:
                    belief = human_filter.correct(self.prior, likelihood).ravel()
                    roots.append(Root(window, belief, probability, name))
        return tuple(roots)
