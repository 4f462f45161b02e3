"""Counter-based random numbers, bit for bit those of `numpy.random.Philox`.

Philox4x64-10 (Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3") turns a key and a
counter into four numbers by ten rounds of

    (c0, c1, c2, c3) <- (hi(M1 c2) ^ c1 ^ k0, lo(M1 c2), hi(M0 c0) ^ c3 ^ k1, lo(M0 c0))

with ``hi`` and ``lo`` the halves of a product of 128 bits; after each round the key grows by
``(W0, W1)``. The counter begins with 1 and grows by 1 for every four numbers.
"""

from __future__ import annotations

from typing import Any, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from coadapt.arrays import FloatArray, IntArray
from coadapt.jit import bare, kernel

Word: TypeAlias = Any
"""A number of 64 bits without sign; sums and products wrap around."""

M0 = np.uint64(0xD2E7470EE14C6C93)
M1 = np.uint64(0xCA5A826395121157)
W0 = np.uint64(0x9E3779B97F4A7C15)
W1 = np.uint64(0xBB67AE8584CAA73B)
LOW = np.uint64(0xFFFFFFFF)
HALF = np.uint64(32)
ELEVEN = np.uint64(11)
ROUNDS = 10
WORDS = 4

STEP = 1.0 / 9007199254740992.0
"""Between neighbouring numbers that `uniform` gives: 2 ** -53."""

NOTHING = -1
"""See `coadapt.simulation.draw`."""


class Stream(NamedTuple):
    """The numbers of one episode."""

    word: npt.NDArray[np.uint64]  # [4] those computed last
    key: npt.NDArray[np.uint64]  # [2]
    place: IntArray  # [2] how many of them are used up, and the counter behind them


def new_stream() -> Stream:
    """A stream to begin."""
    return Stream(
        np.zeros(WORDS, dtype=np.uint64),
        np.zeros(2, dtype=np.uint64),
        np.zeros(2, dtype=np.int64),
    )


@bare
def high(a: Word, b: Word) -> Word:
    """The upper half of ``a * b``, by the products of 32 bits."""
    low = (a & LOW) * (b & LOW)
    middle = (a >> HALF) * (b & LOW) + (low >> HALF)
    other = (a & LOW) * (b >> HALF) + (middle & LOW)
    return (a >> HALF) * (b >> HALF) + (middle >> HALF) + (other >> HALF)


@bare
def begin_stream(s: Stream, key: Word, i: int) -> None:
    """Go to the first number of stream ``i``."""
    s.key[0] = key
    s.key[1] = np.uint64(i)
    s.place[0] = WORDS
    s.place[1] = 0


@bare
def uniform(s: Stream) -> float:
    """The next number in [0, 1)."""
    if s.place[0] == WORDS:
        s.place[0] = 0
        s.place[1] += 1
        refill(s)
    word = s.word[s.place[0]]
    s.place[0] += 1
    return np.int64(word >> ELEVEN) * STEP


@bare
def refill(s: Stream) -> None:
    """Compute the four numbers of the counter."""
    c0 = np.uint64(s.place[1])
    c1 = np.uint64(0)
    c2 = np.uint64(0)
    c3 = np.uint64(0)
    k0 = s.key[0]
    k1 = s.key[1]
    for _ in range(ROUNDS):
        high0 = high(M0, c0)
        high1 = high(M1, c2)
        c0, c1, c2, c3 = high1 ^ c1 ^ k0, M1 * c2, high0 ^ c3 ^ k1, M0 * c0
        k0 = k0 + W0
        k1 = k1 + W1
    s.word[0] = c0
    s.word[1] = c1
    s.word[2] = c2
    s.word[3] = c3


@bare
def draw(s: Stream, chances: FloatArray) -> int:
    """An index drawn from a distribution, see `coadapt.simulation.draw.draw`."""
    drawn = draw_part(s, chances)
    if drawn == NOTHING:
        for i in range(chances.shape[0]):
            if chances[i] > 0.0:
                drawn = i
    return drawn


@bare
def draw_part(s: Stream, chances: FloatArray) -> int:
    """An index, or `NOTHING`, see `coadapt.simulation.draw.draw_part`."""
    possible = False
    for i in range(chances.shape[0]):
        if chances[i] == 1.0:
            return i
        if chances[i] > 0.0:
            possible = True
    if possible:
        left = uniform(s)
        for i in range(chances.shape[0]):
            left -= chances[i]
            if left < 0.0:
                return i
    return NOTHING


@kernel
def fill(s: Stream, key: Word, i: int, out: FloatArray) -> None:
    """Write the first numbers of stream ``i`` to ``out``: for tests."""
    begin_stream(s, key, i)
    for j in range(out.shape[0]):
        out[j] = uniform(s)
