"""How far the solver's two main loops are from the limits of the machine.

    python benchmarks/limits.py ../shared/problems/TagAvoid.pomdpx --seconds 8

First the limits are measured: multiplications with addition a second from the nearest cache, and
the bytes a second that can be read from arrays of the size of each cache and from memory. Then a
problem is solved for some seconds, and every node of the search is made to look at all alpha
vectors and at all upper-bound points of its observed state once more, which is what the search does
with the new ones.

Printed for the look-ups of alpha vectors: products a second, as a part of the limit of arithmetic,
and the bytes of vectors read a second, as a part of the limit for arrays of that size. For the
upper bound: points a second and the bytes of their records.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import Any

import numba
import numpy as np

import coadapt as ca
from coadapt.momdp.sarsop.bounds import refresh_lower, refresh_upper
from coadapt.momdp.sarsop.search import Search, compile_kernels
from coadapt.momdp.sarsop.tree import ENTRIES, GROUPS, NODES, NONE

REPEATS = 5

SIZES = {"32 kB": 1 << 12, "1 MB": 1 << 17, "16 MB": 1 << 21, "256 MB": 1 << 25}
"""Numbers of 8 bytes."""


@numba.njit(fastmath=True)
def multiply(a: Any, b: Any, rounds: int) -> float:
    """``rounds`` sweeps of ``b += s a`` over two short arrays."""
    for r in range(rounds):
        s = 1e-9 * r
        for i in range(a.shape[0]):
            b[i] += s * a[i]
    return b[0]


@numba.njit(fastmath=True)
def add_up(a: Any) -> float:
    """The sum of ``a``: eight bytes read and one addition for each number."""
    total = 0.0
    for i in range(a.shape[0]):
        total += a[i]
    return total


@numba.njit
def all_lower(tree: Any, nodes: int, scratch: Any) -> float:
    """Every node looks at all alpha vectors of its observed state."""
    total = 0.0
    for n in range(nodes):
        tree.nodes[n]["vectors_seen"] = NONE
        total += refresh_lower(tree, n, scratch)
    return total


@numba.njit
def all_upper(tree: Any, nodes: int, scratch: Any) -> float:
    """Every node looks at all upper-bound points of its observed state."""
    total = 0.0
    for n in range(nodes):
        tree.nodes[n]["points_seen"] = NONE
        total += refresh_upper(tree, n, scratch)
    return total


def best_time(call: Any, *arguments: Any) -> float:
    """Seconds of processor time, the least of some calls after a first."""
    call(*arguments)
    taken: list[float] = []
    for _ in range(REPEATS):
        start = time.process_time()
        call(*arguments)
        taken.append(time.process_time() - start)
    return min(taken)


def limits() -> tuple[float, dict[int, float]]:
    """Products a second, and bytes a second by the size of the array in bytes."""
    a, b = np.ones(512), np.zeros(512)
    rounds = 400_000
    products = rounds * len(a) / best_time(multiply, a, b, rounds)
    rates: dict[int, float] = {}
    for count in SIZES.values():
        numbers = np.ones(count)
        times = max(1, (1 << 26) // count)

        def sweep(numbers: Any = numbers, times: int = times) -> None:
            for _ in range(times):
                add_up(numbers)

        rates[8 * count] = times * 8 * count / best_time(sweep)
    return products, rates


def limit_for(rates: dict[int, float], size: int) -> float:
    """The rate measured for the smallest array that holds ``size`` bytes."""
    return next((rate for held, rate in rates.items() if held >= size), list(rates.values())[-1])


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("problem", type=Path)
    parser.add_argument("--seconds", type=float, default=8.0, help="of search")
    given = parser.parse_args()
    products, rates = limits()
    print(f"limit: {products / 1e9:.2f} billion products a second")
    for held, rate in rates.items():
        print(f"limit: {rate / 1e9:.1f} GB/s read from {held / 2**20:g} MB")
    compile_kernels()
    search = Search(ca.read_pomdp(given.problem))
    start = time.process_time()
    while time.process_time() - start < given.seconds:
        if search.run(1e-3, 0.0, 200) is not None:
            break
    tree: Any = search._tree
    nodes = int(tree.used[NODES])
    scratch: Any = search._scratch
    x, entries = tree.nodes["x"][:nodes], tree.nodes["entries"][:nodes]
    hidden, lanes = tree.lane_alpha.shape[1:]
    groups = chain(tree.newest_group, tree.groups["older"])
    vectors = np.array([sum(int(tree.groups[g]["filled"]) for g in found) for found in groups])
    taken = best_time(all_lower, tree, nodes, scratch)
    done = float((entries * vectors[x]).sum())
    # One look-up reads the vectors of one observed state.
    held = -(-int(vectors.max()) // lanes) * lanes * hidden * 8
    print(
        f"{nodes:,} nodes, {vectors.sum():,} alpha vectors in "
        f"{int(tree.used[GROUPS]) * hidden * lanes * 8 / 2**20:.1f} MB, at most "
        f"{held / 2**20:.2f} MB for one observed state"
    )
    print(
        f"look-ups: {done / taken / 1e9:.2f} billion products a second "
        f"({done / taken / products:.0%} of arithmetic), {8 * done / taken / 1e9:.1f} GB/s "
        f"({8 * done / taken / limit_for(rates, held):.0%} of reading)"
    )
    points = np.array([len(found) for found in chain(tree.newest_point, tree.points["older"])])
    taken = best_time(all_upper, tree, nodes, scratch)
    done = float(points[x].sum())
    record = tree.points.dtype.itemsize
    held = int(points.max()) * record
    print(
        f"upper bounds: {done / taken / 1e6:.0f} million points a second, "
        f"{record * done / taken / 1e9:.1f} GB/s of records "
        f"({record * done / taken / limit_for(rates, held):.0%} of reading {held / 2**20:.2f} MB)"
    )
    print(f"beliefs: {int(tree.used[ENTRIES]):,} probabilities")
    return 0


def chain(newest: Any, older: Any) -> list[list[int]]:
    """For each observed state what its list holds, from the newest to the oldest."""
    found: list[list[int]] = []
    for first in map(int, newest):
        here: list[int] = []
        at = first
        while at != NONE:
            here.append(at)
            at = int(older[at])
        found.append(here)
    return found


if __name__ == "__main__":
    sys.exit(main())
