"""Collaboration as a mixed-observability MDP (Sec. 2.3): robot and human both move the world.

Both act at the same time, so the robot acts on its forecast of what the human does and sees their
action afterwards. Disagreement is not punished: it impedes the task where the world makes it so.
Modes are seen, where they are deterministic and their actions give them away, or hidden.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, get_args

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.formalism.hidden_modes import HiddenModes
from coadapt.formalism.seen_modes import SeenModes
from coadapt.formalism.shared_autonomy import PAPER_ADAPTABILITY
from coadapt.human import filter as human_filter
from coadapt.human.adaptation import Adaptability, require_distribution
from coadapt.human.modal import maximum_entropy_policy
from coadapt.human.mode_pairs import NO_MODE, TIES, PairWindows, Ties
from coadapt.human.robot_steps import StepWindows
from coadapt.momdp.model import MOMDP, Root
from coadapt.momdp.transition import SparseTransition
from coadapt.worlds.joint import JointWorld

Observed = Literal["reached", "closed", "all"]
"""Which observed states a planning problem lists: those that can be reached; these and a state for
the end of the task; or every state of the world after every sequence of pairs of modes."""

OBSERVED: tuple[Observed, ...] = get_args(Observed)


@dataclass(frozen=True)
class Collaboration:
    """A world that a robot and a person move together.

    Attributes:
        world: states, moves, goals; one mode for each goal.
        memory: the ``k`` last steps that the person remembers.
        adaptability: values of alpha (then with a uniform prior, fixed over time), or an
            `Adaptability` with a prior and transition of its own.
        mode_prior: ``[M]`` the person's first mode; uniform by default.
        hidden_modes: whether modes are hidden; otherwise policies have to be deterministic and
            the human's actions different in every two modes.
        ties: which mode counts as most frequent of those seen equally often; only for modes that
            are seen.
        observed: which observed states the planning problem lists; "all" is for modes that are
            seen.
        discount: gamma, in [0, 1).
        step_cost: ``c`` in nats of the maximum-entropy policies that hidden modes have by default.
        robot_policies, human_policies: ``[M, X, A_r]`` and ``[M, X, A_h]``, the halves of the modal
            policies. By default those towards each goal: for hidden modes the halves of the
            maximum-entropy policy over pairs of actions, for modes that are seen the first pair of
            actions that begins a shortest path.

    Raises:
        ValueError: if a parameter is out of its range, or modes that should be seen do not show.
    """

    world: JointWorld
    memory: int = 3
    adaptability: Adaptability | Sequence[float] = PAPER_ADAPTABILITY
    mode_prior: Sequence[float] | None = None
    hidden_modes: bool = False
    ties: Ties = "latest"
    observed: Observed = "reached"
    discount: float = 0.99
    step_cost: float = 3.0
    robot_policies: FloatArray | None = None
    human_policies: FloatArray | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.discount < 1:
            raise ValueError(f"discount must lie in [0, 1), not {self.discount}")
        if self.ties not in TIES:
            raise ValueError(f"ties must be one of {', '.join(TIES)}, not {self.ties}")
        if self.observed not in OBSERVED:
            raise ValueError(f"observed must be one of {', '.join(OBSERVED)}, not {self.observed}")
        if self.hidden_modes and self.observed == "all":
            raise ValueError("observed must be reached or closed where modes are hidden, not all")
        modes, (states, *sizes) = len(self.world.goals), self.world.moves.shape[:3]
        halves = ("robot", self.robot_policies), ("human", self.human_policies)
        for (name, half), actions in zip(halves, sizes, strict=True):
            if half is not None:
                require_distribution(f"{name} policies", half, (modes, states, actions))
        # The derived pieces refuse bad values, so that errors surface where the model is made.
        _ = self.prior, self.alpha.rates(modes), self.windows

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
    def modal_policies(self) -> tuple[FloatArray, FloatArray]:
        """``[M, X, A_r]`` and ``[M, X, A_h]``: robot half and human half of each mode."""
        robot, human = self.robot_policies, self.human_policies
        if robot is None or human is None:
            pairs = np.stack([self._towards(goal) for goal in range(len(self.world.goals))])
            robot = pairs.sum(axis=3) if robot is None else robot
            human = pairs.sum(axis=2) if human is None else human
        return robot, human

    def _towards(self, goal: int) -> FloatArray:
        """``[X, A_r, A_h]`` the default policy over pairs of actions."""
        world = self.world.together
        if self.hidden_modes:
            states = world.goals[goal].states
            others = [x for x in world.goal_states if x not in states]
            policy = maximum_entropy_policy(
                world.moves, states, self.step_cost, others, world.chances
            )
        else:
            policy = np.eye(world.actions)[world.nearness(goal).argmax(axis=1)]
        return policy.reshape(self.world.moves.shape[:3])

    @cached_property
    def modes(self) -> SeenModes | HiddenModes:
        """How modes follow each other, and what is observed of it."""
        world = self.world
        robot, human = self.modal_policies
        likelihood = np.ascontiguousarray(np.moveaxis(human, 0, -1))
        if self.hidden_modes:
            steps = StepWindows.of(
                world.outcomes, list(world.starts), world.ends, self.memory, world.human_actions
            )
            return HiddenModes(steps, self.alpha, self.mode_names, robot, likelihood)
        pairs = PairWindows.of(
            world.outcomes,
            list(world.starts),
            world.ends,
            self.memory,
            _mode_shown(robot),
            _mode_shown(human),
            everything=self.observed == "all",
        )
        self._require_seen(pairs)
        return SeenModes(pairs, self.alpha, self.prior.sum(axis=0), likelihood, self.ties)

    def _require_seen(self, windows: PairWindows) -> None:
        world = self.world
        for name, half in zip(("robot", "human"), self.modal_policies, strict=True):
            if not np.isin(half, (0.0, 1.0)).all():
                raise ValueError(f"the {name} policies are not deterministic: modes cannot be seen")
        acts = self.modal_policies[1].argmax(axis=2)  # [M, X]
        for state in np.unique(windows.state[~world.ends[windows.state]]).tolist():
            if len(set(acts[:, state].tolist())) < len(world.goals):
                raise ValueError(
                    f"two modes have the same human action in {world.state_names[state]}: "
                    "modes cannot be seen there"
                )

    def after(self, window: IntArray, action: IntArray, human_action: IntArray) -> IntArray:
        """``[K, N]`` the windows that pairs of actions may lead to, `NO_WINDOW` after the last."""
        shape = (len(self.windows), self.world.actions, self.world.human_actions, -1)
        return self.windows.next.reshape(shape)[window, action, human_action]

    @property
    def windows(self) -> PairWindows | StepWindows:
        """What the person may remember, and with it the observed states."""
        return self.modes.windows

    @property
    def perceived(self) -> FloatArray:
        """``[W, A_r, M]``: the robot mode that the person sees once the robot has acted."""
        return self.modes.perceived

    @cached_property
    def prior(self) -> FloatArray:
        """``[A, M]`` joint belief over adaptability and mode before the first step."""
        modes = len(self.world.goals)
        prior = np.full(modes, 1 / modes) if self.mode_prior is None else np.array(self.mode_prior)
        require_distribution("mode prior", prior, (modes,))
        return np.outer(self.alpha.prior, prior)

    def correct(self, belief: FloatArray, window: IntArray, human_action: IntArray) -> FloatArray:
        """The belief ``[N, A, M]`` after the human actions ``[N]`` in windows ``[N]`` (Eq. 5)."""
        state = self.windows.state[window]
        return human_filter.correct(belief, self.modes.likelihood[state, human_action])

    def predict(
        self, belief: FloatArray, window: IntArray, action: IntArray, human_action: IntArray
    ) -> FloatArray:
        """The belief ``[N, A, M]`` before the next human action, from the corrected one."""
        return self.modes.predict(belief, window, action, human_action)

    @property
    def input_names(self) -> tuple[str, ...]:
        """The human's actions."""
        return self.world.human_action_names

    @property
    def input_likelihood(self) -> FloatArray:
        """``[X, A_h, M]`` the human half of the modal policies."""
        return self.modes.likelihood

    @cached_property
    def reward(self) -> FloatArray:
        """``[W, A_r, M]``: ``R_goal`` in a goal state, and nothing elsewhere."""
        rewards = np.zeros((len(self.windows), self.world.actions, len(self.world.goals)))
        for goal in self.world.goals:
            rewards[np.isin(self.windows.state, goal.states)] = goal.reward
        return rewards

    def kept_modes(self, window: int | IntArray, action: int | IntArray) -> FloatArray:
        """``[..., M, M]`` the mode of somebody who does not adapt, row ``m`` if they act in ``m``.

        Args:
            window: ``[...]`` before the robot's action.
            action: ``[...]`` the robot's action.
        """
        return self.modes.kept_modes(window, action)

    def outcome_chances(
        self, state: IntArray, action: IntArray, human_input: IntArray
    ) -> FloatArray:
        """``[K, A_h * N]``: what an action of the robot leads to also depends on the human's."""
        given = np.eye(self.world.human_actions)[human_input]
        chances = self.world.outcome_chances[state, action]  # [K, A_h, N]
        return (given[:, :, None] * chances).reshape(len(state), -1)

    def to_momdp(self) -> MOMDP:
        """The planning problem. Observed states are the `windows`, there is one observation.

        An edge of ``(x, a_r)`` belongs to a human action and an outcome; its map is the joint
        probability of these and the next hidden state.
        """
        world, windows, modes = self.world, self.windows, self.modes
        acts = modes.human_chance  # [W, A_h, Y]
        change, which = modes.change
        count, human_actions, hidden = acts.shape
        actions = world.actions
        rows, row = np.unique(acts.reshape(-1, hidden), axis=0, return_inverse=True)
        outcome = world.outcome_chances[windows.state]  # [W, A_r, A_h, N]
        going: BoolArray = (acts > 0).any(axis=2) & ~world.ends[windows.state][:, None]  # [W, A_h]
        possible = (outcome > 0) & going[:, None, :, None]
        x, a, h, _ = np.nonzero(possible)
        # Maps are alike where the human's chances, the change and the outcome's chance are.
        kind = row.reshape(count, human_actions)[x, h] * len(change) + which[x, a]
        parts: FloatArray = np.column_stack([kind.astype(np.float64), outcome[possible]])
        parts, edge_map = np.unique(parts, axis=0, return_inverse=True)
        first, second = np.divmod(parts[:, 0].astype(np.int64), len(change))
        maps = (parts[:, 1, None] * rows[first])[:, :, None] * change[second]
        edges = np.bincount(x * actions + a, minlength=count * actions)
        problem = MOMDP(
            edge_start=np.concatenate(([0], np.cumsum(edges))),
            edge_next=windows.next[possible.reshape(windows.next.shape)],
            edge_map=edge_map.ravel(),
            transition=SparseTransition.from_dense(maps),
            observation=np.ones((1, hidden, 1)),
            observation_index=np.zeros((actions, count), dtype=np.int64),
            reward=np.repeat(self.reward[:, :, :1], hidden, axis=2),
            discount=self.discount,
            roots=tuple(
                Root(
                    int(windows.beginning[start]),
                    modes.hidden(self.prior),
                    chance,
                    world.state_names[start],
                )
                for start, chance in world.starts.items()
            ),
            observed_names=modes.observed_names(world),
            hidden_names=modes.hidden_names,
            action_names=world.action_names,
            observation_names=("nothing",),
        )
        if self.observed != "closed":
            return problem
        # Imported now: who writes no file and wants no such state need not wait for the formats.
        from coadapt.momdp.files.file_form import file_form  # noqa: PLC0415

        return file_form(problem)[0]


def _mode_shown(policies: FloatArray) -> IntArray:
    """``[X, A]`` the one mode that takes each action, or `NO_MODE`; for ``[M, X, A]``."""
    takes = policies > 0
    return np.where(takes.sum(axis=0) == 1, takes.argmax(axis=0), NO_MODE)
