"""Numbers as text, to arrays and back."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from coadapt.arrays import FloatArray
from coadapt.errors import FileError, excerpt

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
INTEGER = re.compile(r"[+-]?\d+", re.ASCII)

EXACT_SUM = 1e-12
"""A sum this close to 1 is left as it is, so that what was written is read back to the bit."""

SUM_TOLERANCE = 1e-4
"""A sum this close to 1 is taken for a rounded 1, and its terms are divided by it."""

PROBABILITY_TOLERANCE = 1e-9
"""How far above 1 a single probability may be."""

MAX_DIGITS = 18
"""Digits of a whole number."""

PIECE = 1 << 16
"""Characters that are split into words at a time."""

SPACE = re.compile(r"\s")


def is_number(token: str) -> bool:
    """Whether ``token`` is a decimal number: no ``nan``, ``inf`` or separators."""
    return NUMBER.fullmatch(token) is not None


def whole_number(path: object, line: int, token: str, what: str) -> int:
    """The whole number ``token``, at least 1.

    Raises:
        FileError: if it is something else.
    """
    if INTEGER.fullmatch(token) is None or len(token) > MAX_DIGITS or int(token) < 1:
        raise FileError(path, line, f"found {excerpt(token)}, expected {what}")
    return int(token)


def one_number(path: object, line: int, token: str, what: str) -> float:
    """The finite number ``token``.

    Raises:
        FileError: if it is something else.
    """
    if not is_number(token) or not np.isfinite(float(token)):
        raise FileError(path, line, f"found {excerpt(token)}, expected {what}")
    return float(token)


def numbers(path: object, line: int, tokens: Sequence[str], what: str = "a number") -> FloatArray:
    """The finite numbers ``tokens``, as an array ``[N]``.

    Raises:
        FileError: naming the first token that is something else.
    """
    if len(tokens) == 1:
        return np.array([one_number(path, line, tokens[0], what)])
    try:
        parsed = np.array(tokens, dtype=np.float64)
    except ValueError:
        parsed = None
    # Python also reads `1_0`, and digits of other scripts.
    joined = "".join(tokens)
    if parsed is None or "_" in joined or not joined.isascii() or not np.isfinite(parsed).all():
        for token in tokens:
            one_number(path, line, token, what)
        raise FileError(path, line, f"found {excerpt(joined)}, expected {what}")
    return parsed


def probabilities(path: object, line: int, tokens: Sequence[str]) -> FloatArray:
    """The probabilities ``tokens``, as an array ``[N]``.

    Raises:
        FileError: naming the first token that is none.
    """
    parsed = numbers(path, line, tokens, "a probability")
    wrong = (parsed < 0) | (parsed > 1 + PROBABILITY_TOLERANCE)
    if wrong.any():
        found = tokens[int(np.argmax(wrong))]
        raise FileError(path, line, f"found {excerpt(found)}, expected a probability from 0 to 1")
    return parsed


def pieces(text: str) -> Iterator[list[str]]:
    """The words of ``text``, some at a time: a word takes many times the memory of its letters."""
    at = 0
    while (gap := SPACE.search(text, at + PIECE)) is not None:
        yield text[at : gap.start()].split()
        at = gap.start()
    yield text[at:].split()


def read_numbers(
    path: object,
    line: int,
    text: str,
    count: int,
    read: Callable[[object, int, list[str]], FloatArray],
) -> FloatArray:
    """The ``count`` numbers in ``text``, as an array ``[count]``.

    Args:
        path, line: where ``text`` stands.
        text: the numbers, separated by white space.
        count: how many there must be.
        read: turns words into numbers.

    Raises:
        FileError: if ``read`` raises it, or there are more or fewer numbers.
    """
    parts: list[FloatArray] = []
    missing = count
    for words in pieces(text):
        missing -= len(words)
        parts.append(read(path, line, words[: len(words) + min(missing, 0)]))
        if missing < 0:
            break
    if missing != 0:
        found = sum(len(words) for words in pieces(text))
        raise FileError(path, line, f"found {found} numbers, expected {count}")
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def shortest(value: float) -> str:
    """The shortest text that reads back as exactly ``value``."""
    text = repr(float(value))
    return text.removesuffix(".0")


def joined(values: FloatArray) -> str:
    """``values`` of any shape as text, separated by spaces."""
    return " ".join([shortest(value) for value in values.ravel().tolist()])
