"""A robot that knows what kind of person it meets: what others are measured against.

It plans for exactly that person. Hidden are their kind and their mode, ``Y = K x M`` with index
``y = kind * |M| + mode``; how the two change, and which inputs they lead to, is what the person's
tables say (`coadapt.simulation.partners.tables`), whether the adaptation model could say it or not.
What it does not know is which goal they head for: that it believes of the first mode what the model
says, and learns from the inputs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import final

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.formalism import SharedAutonomy
from coadapt.momdp.model import MOMDP, Root
from coadapt.momdp.policy import AlphaVectorPolicy
from coadapt.momdp.transition import SparseTransition
from coadapt.robots import NO_INPUT, Decisions, MatchRule
from coadapt.robots.setup import Progress, planned_policy
from coadapt.simulation.partners import DescribedPartner, OwnMemory, PartnerTables


@dataclass(frozen=True, eq=False)
class KnownPerson:
    """A person and the world in which the robot meets them.

    Attributes:
        model: world and person, with the memory of the person.
        tables: the person.
    """

    model: SharedAutonomy
    tables: PartnerTables

    @classmethod
    def of(cls, model: SharedAutonomy, partner: DescribedPartner) -> KnownPerson:
        """What there is to know about ``partner``.

        Raises:
            ValueError: if ``partner`` remembers by other windows than those of some memory, or does
                not go with ``model``.
        """
        if isinstance(partner, OwnMemory):
            model = replace(model, memory=partner.memory)
        tables = partner.tables(model).checked(model)
        if not np.array_equal(tables.next, model.windows.next):
            raise ValueError("a memory of their own must be the last thing said about a person")
        return cls(model, tables)

    @cached_property
    def prior(self) -> FloatArray:
        """``[K, M]`` before the first input."""
        return self.tables.first_kind[:, None] * self.model.prior.sum(axis=0)

    @cached_property
    def likelihood(self) -> FloatArray:
        """``[X, O, K, M]`` chance of each input, the last one that of none if there may be none."""
        each = self.tables.inputs[self.tables.uses]  # [K, X, M, I + 1]
        silent = bool(each[..., -1].any())
        inputs = each.shape[-1] if silent else each.shape[-1] - 1
        return np.ascontiguousarray(np.moveaxis(each[..., :inputs], (1, 3), (0, 1)))

    @cached_property
    def moves(self) -> tuple[FloatArray, IntArray]:
        """``[D, Y, Y]`` how kind and mode change, and ``[W, A]`` which of them holds where."""
        tables = self.tables
        kinds, modes = tables.rate.shape
        seen, which = np.unique(tables.perceived.reshape(-1, modes), axis=0, return_inverse=True)
        answered = tables.rate[None] * seen[:, None]  # [D, K, M]
        stay = 1.0 - answered.sum(axis=2)
        mode = np.einsum("dkr,rn->dkn", answered, tables.answer)[:, :, None] + np.maximum(
            stay[:, :, None, None] * np.eye(modes), 0.0
        )  # [D, K, M, M']
        mode = mode @ tables.wander
        moved = np.einsum("dkmn,kl->dkmln", mode, tables.change)
        hidden = kinds * modes
        return moved.reshape(-1, hidden, hidden), which.reshape(tables.perceived.shape[:2])

    def to_momdp(self) -> MOMDP:
        """The planning problem of somebody who knows the person."""
        model, windows = self.model, self.model.windows
        base = model.to_momdp()
        hidden, outcomes, observed = self.prior.size, windows.next.shape[2], len(windows)
        chance = model.world.outcome_chances[windows.state]
        possible = (chance > 0) & ~model.world.ends[windows.state][:, None, None]
        maps, which = self.moves
        kind = np.repeat(which[:, :, None], outcomes, axis=2)[possible]
        parts, edge_map = np.unique(
            np.column_stack([kind, chance[possible]]), axis=0, return_inverse=True
        )
        joint = maps[parts[:, 0].astype(np.int64)] * parts[:, 1, None, None]
        observation = np.moveaxis(self.likelihood, 1, 3).reshape(model.world.states, hidden, -1)
        kinds = len(self.tables.first_kind)
        names = (*model.input_names, "none")[: observation.shape[2]]
        return replace(
            base,
            edge_map=edge_map.ravel(),
            transition=SparseTransition.from_dense(joint),
            observation=np.ascontiguousarray(observation),
            observation_index=np.tile(windows.state, (model.world.actions, 1)),
            reward=np.tile(model.reward, (1, 1, kinds)).reshape(observed, -1, hidden),
            roots=self._roots(names),
            hidden_names=tuple(f"kind {k} {m}" for k in range(kinds) for m in model.mode_names),
            observation_names=names,
        )

    def _roots(self, names: tuple[str, ...]) -> tuple[Root, ...]:
        roots: list[Root] = []
        for start, chance in self.model.world.start_chances.items():
            for i, name in enumerate(names):
                mass = self.prior * self.likelihood[start, i]
                total = float(mass.sum())
                if total > 0:
                    window = int(self.model.windows.beginning[start])
                    roots.append(Root(window, (mass / total).ravel(), chance * total, name))
        return tuple(roots)


@final
class KnowingRobot:
    """Does the best there is to do with one kind of person, by a plan with the match rule.

    Its belief ``[K, M]`` is over the kind of the person and their mode.

    Args:
        person: whom it knows.
        policy: a solution of ``person.to_momdp()``.
        match_rule: when to execute the person's input instead of the policy's action.
    """

    name = "knowing"

    def __init__(
        self, person: KnownPerson, policy: AlphaVectorPolicy, match_rule: MatchRule | None = None
    ) -> None:
        self.person = person
        self.model = person.model
        self.policy = policy
        self.match_rule = MatchRule() if match_rule is None else match_rule
        self.reset()

    @classmethod
    def planned(
        cls,
        model: SharedAutonomy,
        partner: DescribedPartner,
        match_rule: MatchRule,
        gap: float,
        progress: Progress | None = None,
    ) -> KnowingRobot:
        """The robot for ``partner``, planned now until its bounds are as close as ``gap``.

        Raises:
            ValueError: as `KnownPerson.of`.
        """
        person = KnownPerson.of(model, partner)
        return cls(person, planned_policy(person.to_momdp(), gap, progress), match_rule)

    @property
    def belief(self) -> FloatArray:
        """``[K, M]`` at the start of the episode."""
        return self._belief

    def reset(self, belief: FloatArray | None = None, window: int | None = None) -> None:
        """Begin an episode from ``belief``, by default from what it knows."""
        self._belief = self.person.prior if belief is None else belief

    def decide_many(
        self, windows: IntArray, human_inputs: IntArray, beliefs: FloatArray
    ) -> Decisions:
        """Decide in many situations at once, see `coadapt.robots.Decider`."""
        model, person = self.model, self.person
        state = model.windows.state[windows]
        given = human_inputs != NO_INPUT
        mass = beliefs * person.likelihood[state, human_inputs]
        # No input is the last observation where there may be none; else it says nothing.
        silent = person.likelihood.shape[1] > len(model.input_names)
        total = mass.sum(axis=(1, 2), keepdims=True)
        learns = (total > 0) & (given | silent)[:, None, None]
        belief = np.divide(mass, total, out=np.array(beliefs), where=learns)
        planned = self.policy.actions_at(windows, belief.reshape(len(windows), -1))
        perceived = model.perceived[windows, planned]
        agreement = self.match_rule.agreement(belief.sum(axis=1), perceived)
        asked = model.interface.asked(human_inputs)
        matched = self.match_rule.fires(agreement, asked)
        action = np.where(matched, asked, planned)
        maps, which = person.moves
        flat = belief.reshape(len(windows), -1)
        forecast = np.einsum("ny,nyz->nz", flat, maps[which[windows, action]])
        return Decisions(
            window=windows,
            state=state,
            human_input=human_inputs,
            asked=asked,
            action=action,
            planned=planned,
            agreement=agreement,
            matched=matched,
            belief=belief,
            forecast=forecast.reshape(belief.shape),
        )
