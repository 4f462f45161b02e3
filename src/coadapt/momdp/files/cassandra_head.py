"""The first part of a `.pomdp` file: discount, values, states, actions, observations, start."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from coadapt.arrays import FloatArray
from coadapt.errors import FileError, excerpt
from coadapt.momdp.files.cassandra_tokens import Tokens
from coadapt.momdp.files.layered import WILD
from coadapt.momdp.files.limits import MAX_VALUES
from coadapt.momdp.files.values import (
    EXACT_SUM,
    INTEGER,
    MAX_DIGITS,
    SUM_TOLERANCE,
    is_number,
    one_number,
    whole_number,
)

KEYWORDS = frozenset(
    ("discount", "values", "states", "actions", "observations", "start", "T", "O", "R")
)
"""Words that begin a part of the file when a colon follows."""

NAME = re.compile(r"[^\W\d][^\s:*#]*")
"""The name of a state, an action or an observation."""


@dataclass(frozen=True)
class Names:
    """The values of states, actions or observations.

    Attributes:
        kind: what they are, in the singular.
        labels: their names; numbers are given a letter in front.
        index: the index of every name that the file may use.
    """

    kind: str
    labels: tuple[str, ...]
    index: dict[str, int]

    def __len__(self) -> int:
        return len(self.labels)

    def read(self, tokens: Tokens) -> int:
        """The index that the next word names, or `WILD`.

        Raises:
            FileError: if it names none.
        """
        word = tokens.peek()
        found = WILD if word == "*" else self.find(word)
        if found is None:
            raise tokens.error(
                f"{_article(self.kind)} {self.kind}, its number below {len(self)}, or '*'"
            )
        tokens.next(self.kind)
        return found

    def find(self, word: str | None) -> int | None:
        """The index that ``word`` names, or None."""
        if word is None:
            return None
        if word in self.index:
            return self.index[word]
        if INTEGER.fullmatch(word) and len(word) <= MAX_DIGITS and 0 <= int(word) < len(self):
            return int(word)
        return None

    def name(self, index: int) -> str:
        """The label of ``index``; `WILD` is any."""
        return f"{self.kind} {self.labels[index] if index >= 0 else '*'}"


@dataclass(frozen=True)
class Head:
    """What a file declares before its tables.

    Attributes:
        discount: in [0, 1).
        sign: 1 for rewards, -1 for costs.
        states, actions, observations: the names.
        start: ``[S]`` the initial belief.
    """

    discount: float
    sign: float
    states: Names
    actions: Names
    observations: Names
    start: FloatArray


def read_head(tokens: Tokens) -> Head:
    """Read up to the first table.

    Raises:
        FileError: if something is missing, twice there or not what the grammar asks for.
    """
    seen: dict[str, int] = {}
    discount = sign = 1.0
    names: dict[str, Names] = {}
    start: FloatArray | None = None
    while (word := tokens.peek()) is not None and word not in ("T", "O", "R"):
        line = tokens.line
        if word not in KEYWORDS:
            raise tokens.error("discount, values, states, actions, observations, start, T, O or R")
        if word in seen:
            raise FileError(
                tokens.path,
                line,
                f"found {word} again, expected it once (it is on line {seen[word]})",
            )
        seen[word] = line
        tokens.next(word)
        if word == "start":
            if "states" not in names:
                raise FileError(tokens.path, line, "found start, expected states before it")
            start = _read_start(tokens, names["states"])
            continue
        tokens.expect(":")
        if word == "discount":
            discount = _read_discount(tokens)
        elif word == "values":
            if tokens.peek() not in ("reward", "cost"):
                raise tokens.error("reward or cost")
            sign = 1.0 if tokens.next("reward or cost") == "reward" else -1.0
        else:
            names[word] = _read_names(tokens, word)
    for word in ("discount", "states", "actions", "observations"):
        if word not in seen:
            raise FileError(
                tokens.path,
                tokens.line,
                f"found no {word} before the tables, expected '{word}: ...'",
            )
    if start is None:
        start = np.full(len(names["states"]), 1.0 / len(names["states"]))
    return Head(discount, sign, names["states"], names["actions"], names["observations"], start)


def _read_discount(tokens: Tokens) -> float:
    line = tokens.line
    word = tokens.next("a discount")
    discount = one_number(tokens.path, line, word, "a discount of at least 0 and below 1")
    if not 0 <= discount < 1:
        raise FileError(
            tokens.path,
            line,
            f"found discount {excerpt(word)}, expected at least 0 and below 1: without "
            "discounting the value of going on for ever need not be finite",
        )
    return discount


def _read_names(tokens: Tokens, word: str) -> Names:
    kind = word.removesuffix("s")
    line = tokens.line
    first = tokens.peek()
    if first is not None and is_number(first):
        tokens.next(word)
        count = whole_number(tokens.path, line, first, f"how many {word} there are, or their names")
        if count > MAX_VALUES:
            raise FileError(
                tokens.path, line, f"found {count} {word}, expected at most {MAX_VALUES:,}"
            )
        return Names(kind, tuple(f"{kind[0]}{i}" for i in range(count)), {})
    index: dict[str, int] = {}
    while (name := tokens.peek()) is not None and not _begins_part(tokens):
        if NAME.fullmatch(name) is None or not name.isprintable():
            raise tokens.error(f"the name of {_article(kind)} {kind}, which starts with a letter")
        if name in index:
            raise tokens.error(f"each name of {_article(kind)} {kind} once")
        if len(index) == MAX_VALUES:
            raise tokens.error(f"at most {MAX_VALUES:,} {word}")
        index[name] = len(index)
        tokens.next(kind)
    if not index:
        raise tokens.error(f"how many {word} there are, or their names")
    return Names(kind, tuple(index), index)


def _begins_part(tokens: Tokens) -> bool:
    word, after = tokens.peek(), tokens.peek(1)
    return word in KEYWORDS and (
        after == ":" or (word == "start" and after in ("include", "exclude"))
    )


def _read_start(tokens: Tokens, states: Names) -> FloatArray:
    """The belief ``[S]`` of one of the five forms of ``start``."""
    size = len(states)
    mode = tokens.peek()
    if mode in ("include", "exclude"):
        tokens.next("include or exclude")
        tokens.expect(":")
        listed = np.zeros(size, dtype=np.bool_)
        line = tokens.line
        while tokens.peek() is not None and not _begins_part(tokens):
            state = states.read(tokens)
            if state == WILD:
                listed[:] = True
            else:
                listed[state] = True
        if mode == "exclude":
            listed = ~listed
        if not listed.any():
            raise FileError(
                tokens.path, line, "found no state to start from, expected at least one"
            )
        return listed / listed.sum()
    tokens.expect(":")
    line = tokens.line
    word = tokens.peek()
    if word is None:
        raise tokens.error("a state, 'uniform', or a probability for every state")
    if word == "uniform":
        tokens.next("uniform")
        return np.full(size, 1.0 / size)
    after = tokens.peek(1)
    alone = after is None or not is_number(after)
    if not is_number(word) or (
        alone and INTEGER.fullmatch(word) and (size > 1 or float(word) == 0)
    ):
        state = states.find(word)
        if state is None:
            raise tokens.error("a state, 'uniform', or a probability for every state")
        tokens.next("a state")
        belief = np.zeros(size)
        belief[state] = 1.0
        return belief
    belief = tokens.numbers(size, f"{size} probabilities to start from")
    if (belief < 0).any():
        raise FileError(
            tokens.path, line, f"found start probability {belief.min():g}, expected at least 0"
        )
    total = float(belief.sum())
    if abs(total - 1) > SUM_TOLERANCE:
        raise FileError(
            tokens.path, line, f"found start probabilities that sum to {total:.9g}, expected 1"
        )
    return belief if abs(total - 1) <= EXACT_SUM else belief / total


def _article(word: str) -> str:
    return "an" if word and word[0] in "aeiou" else "a"
