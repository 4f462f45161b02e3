"""Numbers as text, to arrays and back."""

from __future__ import annotations

import re
from collections.abc import Sequence

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


def numbers(path: object, line: int, tokens: Sequence[str], what: str) -> FloatArray:
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


def shortest(value: float) -> str:
    """The shortest text that reads back as exactly ``value``."""
    text = repr(float(value))
    return text.removesuffix(".0")


def joined(values: FloatArray) -> str:
    """``values`` of any shape as text, separated by spaces."""
    return " ".join([shortest(value) for value in values.ravel().tolist()])
