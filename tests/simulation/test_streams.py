"""The compiled numbers are numpy's."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from coadapt.simulation.draw import Streams
from coadapt.simulation.kernels.streams import fill, new_stream

WORD = st.one_of(st.integers(0, 2**64 - 1), st.sampled_from((0, 1, 2**63, 2**64 - 1)))


@given(WORD, st.one_of(st.integers(0, 2**63 - 1), st.integers(0, 10)), st.integers(1, 40))
@settings(max_examples=200)
def test_numbers_are_those_of_numpy(key: int, i: int, count: int) -> None:
    found = np.empty(count)
    with np.errstate(over="ignore"):
        fill(new_stream(), np.uint64(key), i, found)
    np.testing.assert_array_equal(found, Streams(key)[i].random(count))


def test_a_known_answer() -> None:
    # philox4x64-10 with counter and key of all bits set, from the test vectors (kat_vectors) of
    # Random123 by Salmon et al.: the first word is 87b092c3013fe90b.
    generator = np.random.Philox(key=2**128 - 1, counter=2**256 - 2)
    assert int(generator.random_raw()) == 0x87B092C3013FE90B


def test_streams_differ_and_depend_on_the_seed_alone() -> None:
    streams = Streams.of(np.random.default_rng(1))
    assert streams.key == Streams.of(np.random.default_rng(1)).key
    assert streams.key != Streams.of(np.random.default_rng(2)).key
    first = [streams[i].random() for i in range(100)]
    assert len(set(first)) == 100
    assert first == [streams[i].random() for i in range(100)]
