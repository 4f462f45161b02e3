"""Which key gives which input."""

from __future__ import annotations

from coadapt.human import Inputs
from coadapt.human.inputs import EIGHT_DIRECTIONS
from coadapt.play.table import arrow

ARROW_KEYS = {"left": "←", "forward": "↑", "right": "→", "back": "↓"}
"""Inputs that have an arrow key, by their names."""

MOST_NUMBERED = 9
"""Inputs with a number key of their own: the first ones, in their order."""


def keys(inputs: Inputs) -> str:
    """The keys in one line: the arrows, then numbers with the inputs that have no arrow."""
    arrows = [key for name, key in ARROW_KEYS.items() if name in inputs.names]
    others = [
        f"{i} {arrow(inputs.directions[i - 1]) if name in EIGHT_DIRECTIONS else name}"
        for i, name in enumerate(inputs.names[:MOST_NUMBERED], start=1)
        if name not in ARROW_KEYS
    ]
    return "  ".join([" ".join(arrows), *others] if arrows else others)


def numbered(inputs: Inputs, number: int) -> str | None:
    """The name of the input with the key ``number``, or None."""
    return inputs.names[number - 1] if number <= len(inputs.names) else None
