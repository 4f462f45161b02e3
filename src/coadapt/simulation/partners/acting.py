"""The one place where a person described by arrays acts."""

from __future__ import annotations

from typing import final

import numpy as np

from coadapt.formalism import Model
from coadapt.simulation.draw import NOTHING, draw, draw_part
from coadapt.simulation.partners.person import (
    NEW_MODE,
    AnyPartner,
    DescribedPartner,
    Partner,
    Person,
)
from coadapt.simulation.partners.tables import PartnerTables


@final
class ActingPartner:
    """A `Partner` by its tables. The compiled loop draws the same numbers in the same order.

    Args:
        tables: the person.
    """

    def __init__(self, tables: PartnerTables) -> None:
        self._tables = tables

    def begin(
        self, model: Model, state: int, before: Person | None, rng: np.random.Generator
    ) -> Person:
        """See `Partner.begin`. Their kind lasts, what they remembered does not."""
        tables = self._tables
        kind = draw(tables.first_kind, rng) if before is None else before.kind
        mode = NEW_MODE if before is None else before.mode
        mode = draw(tables.first_mode, rng) if mode == NEW_MODE else mode
        return Person(mode, kind, int(tables.beginning[state]))

    def act(self, model: Model, state: int, person: Person, rng: np.random.Generator) -> int | None:
        """See `Partner.act`."""
        tables = self._tables
        chances = tables.inputs[tables.uses[person.kind], state, person.mode]
        drawn = draw(chances, rng)
        return drawn if drawn < len(chances) - 1 else None

    def react(
        self,
        model: Model,
        window: int,
        person: Person,
        action: int,
        outcome: int,
        rng: np.random.Generator,
    ) -> Person:
        """See `Partner.react`. ``window`` is not looked at: they remember by themselves."""
        tables, mode, own = self._tables, person.mode, person.window
        answered = draw_part(tables.rate[person.kind] * tables.perceived[own, action], rng)
        if answered != NOTHING:
            mode = draw(tables.answer[answered], rng)
        elif len(tables.kept):
            mode = draw(tables.kept[own, action, mode], rng)
        mode = draw(tables.wander[mode], rng)
        kind = draw(tables.change[person.kind], rng)
        return Person(mode, kind, int(tables.next[own, action, outcome]))

    def seen_apart(self, person: Person, action: int) -> float:
        """The probability that they see the robot in another mode than their own."""
        return 1.0 - float(self._tables.perceived[person.window, action, person.mode])


def acting(partner: AnyPartner, model: Model) -> Partner:
    """Somebody to simulate step by step.

    Raises:
        ValueError: if a description does not go with ``model``, or its tables are no tables.
    """
    if isinstance(partner, DescribedPartner):
        return ActingPartner(partner.tables(model).checked(model))
    return partner
