"""How much a file may ask for: checked before memory is allocated.

A short file can declare a problem of any size. The limits keep what a reader allocates below about
one gigabyte; a problem within them is read whatever its file looks like.
"""

from __future__ import annotations

import math

from coadapt.errors import FileError

MAX_FILE_BYTES = 1 << 29
"""Size of a file that is read, in bytes."""

MAX_VALUES = 1_000_000
"""Values of one variable: states, actions or observations declared by a number or by a list."""

MAX_REWARDS = 25_000_000
"""``|X| * |A| * |Y|``, the entries of the reward array (8 bytes each)."""

MAX_OBSERVATIONS = 25_000_000
"""Entries of the stack of different observation matrices, ``K * |Y| * |O|`` (8 bytes each)."""

MAX_ENTRIES = 10_000_000
"""Entries different from 0 of the hidden transitions, and rows of their stack, ``K * |Y|``."""

MAX_PAIRS = 500_000
"""Pairs of an observed state and an action, ``|X| * |A|``, in a `.pomdpx` file."""

MAX_CELLS = 5_000_000
"""Rows of one table that the wildcards and matrices of a file may set, over all of its entries."""

MAX_DEPTH = 200
"""Depth to which the elements of an XML file may be nested."""

MAX_POLICY = 40_000_000
"""Numbers in all alpha vectors of a policy (8 bytes each)."""

MAX_NODES = 250_000
"""Elements of all decision diagrams of a file."""

MAX_CHARACTERS = 50_000_000
"""Characters in the names of all combinations of several variables."""

MAX_VARIABLES = 1000
"""Variables of a problem, of all kinds together."""


def check_size(
    path: object, line: int | None, what: str, sizes: tuple[int, ...], limit: int
) -> None:
    """Refuse what is too large.

    Args:
        path, line: the place that asked for it.
        what: names the product, for example ``states x actions``.
        sizes: the factors of the product.
        limit: largest product that is accepted.

    Raises:
        FileError: if the product exceeds ``limit``.
    """
    if math.prod(sizes) > limit:
        factors = " x ".join(str(size) for size in sizes)
        raise FileError(path, line, f"found {factors} {what}, expected at most {limit:,} in all")
