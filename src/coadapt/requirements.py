"""What the values of a description must be, and the error that says which one is not."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

from coadapt.errors import InputError, excerpt

Key = tuple[str | int, ...]
"""Where a value stands: names of tables and keys, and numbers of entries from 0."""

NAME = re.compile(r"\w[\w .'()+/-]{0,59}")
"""Letters, digits and a few signs, at most 60 of them."""

LARGEST_REWARD = 1e6

MOST_STATES = 10_000
"""Cells or states."""

MOST_ACTIONS = 30


class FieldError(InputError):
    """A value of a description, for example of a task, cannot be used.

    Attributes:
        key: where it stands, for example ``("goals", 1, "reward")``.
        problem: the rest of the sentence that begins with that place.
    """

    def __init__(self, key: Key, problem: str) -> None:
        super().__init__(f"{dotted(key)} {problem}" if key else problem)
        self.key = key
        self.problem = problem


def dotted(key: Key) -> str:
    """``("goals", 1, "reward")`` as ``goals[1].reward``."""
    text = ""
    for part in key:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def require(key: Key, holds: bool, wanted: str, found: object) -> None:
    """Raise FieldError unless ``holds``: "KEY must be WANTED, not FOUND"."""
    if not holds:
        raise FieldError(key, f"must be {wanted}, not {found}")


def require_name(key: Key, name: str) -> None:
    """Raise FieldError unless ``name`` can be a label."""
    signs = "1 to 60 letters, digits, blanks or . ' ( ) + / - _, beginning with a letter or digit"
    require(key, NAME.fullmatch(name) is not None, signs, excerpt(name))


def require_names(key: Key, names: Sequence[str], most: int) -> None:
    """Raise FieldError unless there are 1 to ``most`` labels, all different."""
    require(key, 1 <= len(names) <= most, f"1 to {most:,} names", f"{len(names):,}")
    for name in names:
        require_name(key, name)
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise FieldError(key, f"has {excerpt(twice)} twice, expected different names")


def require_reward(key: Key, value: float) -> None:
    """Raise FieldError unless ``value`` is a number that can be a reward."""
    wanted = f"a number of size {LARGEST_REWARD:g} at most"
    require(key, abs(value) <= LARGEST_REWARD, wanted, value)


def require_chance(key: Key, value: float, most: float = 1.0, *, most_included: bool) -> None:
    """Raise FieldError unless ``value`` lies between 0 and ``most``."""
    holds = 0 <= value <= most if most_included else 0 <= value < most
    wanted = f"from 0 to {most:g}" if most_included else f"at least 0 and below {most:g}"
    require(key, holds, wanted, value)


def require_distribution(key: Key, values: Sequence[float], count: int) -> None:
    """Raise FieldError unless ``values`` are ``count`` probabilities that sum to 1."""
    require(key, len(values) == count, f"{count} probabilities", len(values))
    require(key, all(0 <= v <= 1 for v in values), "probabilities", list(values))
    require(key, abs(sum(values) - 1) <= 1e-9, "probabilities that sum to 1", list(values))


def require_known(key: Key, name: str, known: Collection[str], what: str) -> None:
    """Raise FieldError unless ``name`` is one of the ``known``; ``what`` says what they are."""
    if name not in known:
        raise FieldError(key, f"names {excerpt(name)}, expected one of the {what}")
