"""Numbers as text."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.errors import InputError
from coadapt.momdp.files import values
from coadapt.momdp.files.values import numbers, pieces, probabilities, read_numbers


@given(st.text(alphabet="ab \n\t\u2003", max_size=200), st.integers(1, 20))
def test_pieces_are_the_words(text: str, size: int) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(values, "PIECE", size)
        assert [word for words in pieces(text) for word in words] == text.split()


@pytest.mark.parametrize("size", [1, 3, 1000])
def test_tables_in_pieces(monkeypatch: pytest.MonkeyPatch, size: int) -> None:
    monkeypatch.setattr(values, "PIECE", size)
    text = " 0.5\n1e-3 0 1 "
    np.testing.assert_array_equal(read_numbers("f", 3, text, 4, numbers), [0.5, 1e-3, 0, 1])
    assert read_numbers("f", 3, " ", 0, numbers).shape == (0,)
    for count in (0, 3, 5):
        with pytest.raises(InputError, match=f"f:3: found 4 numbers, expected {count}"):
            read_numbers("f", 3, text, count, numbers)
    with pytest.raises(InputError, match="f:3: found 'x', expected a number"):
        read_numbers("f", 3, text + "x", 5, numbers)
    with pytest.raises(InputError, match="f:3: found '2', expected a probability"):
        read_numbers("f", 3, text + "2", 5, probabilities)
