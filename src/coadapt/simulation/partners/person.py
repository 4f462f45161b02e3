"""Simulated people: who they are, and what changes of them during an episode."""

from __future__ import annotations

from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from coadapt.formalism import Model
from coadapt.simulation.partners.tables import PartnerTables

NEW_MODE = -1
"""Instead of a mode: the person has yet to choose a goal."""


class Person(NamedTuple):
    """What changes of a person during an episode; the episode loop holds it.

    Attributes:
        mode: index of the goal that they head for.
        kind: what else they may change in, counted from 0: which of its kinds a `PartnerTables`
            finds them in, or whatever a partner of your own counts.
        window: what they remember, an index in windows of their own; of no use to a partner that
            is content with the windows of the model.
    """

    mode: int
    kind: int = 0
    window: int = 0


class Partner(Protocol):
    """Somebody who steers: a simulated person, or a program that stands in for a real one.

    A partner is a description, the same in all episodes. What changes is in the `Person` that its
    methods are given and return.
    """

    def begin(
        self, model: Model, state: int, before: Person | None, rng: np.random.Generator
    ) -> Person:
        """The person at the start of a trial in robot state ``state``.

        Args:
            model: the robot's model of world and people.
            state: the first robot state.
            before: the same person at the end of their last trial; None in their first. The mode
                is `NEW_MODE` where they are to choose a goal anew.
            rng: source of all that is left to chance.
        """
        ...

    def act(self, model: Model, state: int, person: Person, rng: np.random.Generator) -> int | None:
        """The input in robot state ``state``, or None for no input."""
        ...

    def react(
        self,
        model: Model,
        window: int,
        person: Person,
        action: int,
        outcome: int,
        rng: np.random.Generator,
    ) -> Person:
        """The person after the robot took ``action``.

        Args:
            model: the robot's model.
            window: index in ``model.windows`` of the steps before the action.
            person: the person before it.
            action: the robot's action.
            outcome: which of its outcomes it had, an index in ``model.windows.next[window,
                action]``.
            rng: source of all that is left to chance.
        """
        ...


@runtime_checkable
class DescribedPartner(Protocol):
    """A person described by arrays. All that coadapt provides are, and run in compiled code."""

    def tables(self, model: Model) -> PartnerTables:
        """The arrays for the world and the inputs of ``model``.

        Raises:
            ValueError: if the description does not go with that model.
        """
        ...


AnyPartner = Partner | DescribedPartner
"""Whom a simulation takes."""
