"""The part of a task that describes a goal."""

from __future__ import annotations

import msgspec

from coadapt.errors import excerpt
from coadapt.requirements import require, require_chance, require_name, require_reward

FREE, OBSTACLE, START = ".", "#", "@"
"""Symbols of a map; goals have symbols of their own."""


class TaskGoal(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A goal.

    Attributes:
        name: what people call it.
        reward: what reaching it is worth.
        symbol: the character of its cells on the map, by default the first letter of its name.
        states: its states in a graph, by default the one of its name.
        prior: probability that the person heads for it at first; given for all goals or for none.
    """

    name: str
    reward: float
    symbol: str | None = None
    states: tuple[str, ...] | None = None
    prior: float | None = None

    def __post_init__(self) -> None:
        require_name(("name",), self.name)
        require_reward(("reward",), self.reward)
        if self.symbol is not None:
            one = len(self.symbol) == 1 and self.symbol.isprintable() and not self.symbol.isspace()
            taken = self.symbol in (FREE, OBSTACLE, START)
            wanted = f"one character other than {FREE} {OBSTACLE} {START}"
            require(("symbol",), one and not taken, wanted, excerpt(self.symbol))
        if self.prior is not None:
            require_chance(("prior",), self.prior, most_included=True)

    @property
    def mark(self) -> str:
        """The character of its cells on a map."""
        return self.name[0] if self.symbol is None else self.symbol
