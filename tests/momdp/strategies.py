"""Random small MOMDPs.

Hypothesis draws the sizes, the structure and a seed; numpy draws the numbers. A failing example is
so shrunk to few states, and still repeats.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from hypothesis import strategies as st

from coadapt.arrays import FloatArray
from coadapt.momdp import MOMDP, JumpTransition, Root

DISCOUNTS = (0.0, 0.3, 0.5, 0.7)


def random_rows(rng: np.random.Generator, shape: tuple[int, ...], zeros: float) -> FloatArray:
    """Distributions along the last axis, each other entry 0 with probability ``zeros``."""
    weight = rng.exponential(size=shape) * (rng.random(shape) >= zeros)
    # A row left empty gets one entry.
    empty = weight.sum(axis=-1) == 0
    weight[empty, rng.integers(shape[-1], size=int(empty.sum()))] = 1.0
    return weight / weight.sum(axis=-1, keepdims=True)


def random_roots(rng: np.random.Generator, x: int, y: int, zeros: float) -> list[Root]:
    """One to three roots."""
    count = int(rng.integers(1, 4))
    beliefs = random_rows(rng, (count, y), zeros)
    chances = random_rows(rng, (count,), 0.0)
    return [
        Root(int(rng.integers(x)), belief, float(chance), f"root {i}")
        for i, (belief, chance) in enumerate(zip(beliefs, chances, strict=True))
    ]


@st.composite
def sparse_momdps(
    draw: st.DrawFn,
    *,
    sizes: int = 3,
    discounts: Sequence[float] = DISCOUNTS,
    revealing: bool = False,
) -> MOMDP:
    """Any transitions: x' and y' each depend on the other or not, some states end the task.

    With ``revealing`` the roots are certain of y and x' tells much about it, so that most beliefs
    rule something out.
    """
    least = 2 if revealing else 1
    x, y = (draw(st.integers(least, sizes), label=name) for name in ("X", "Y"))
    a, o = (draw(st.integers(1, sizes), label=name) for name in ("A", "O"))
    x_by_y = revealing or draw(st.booleans(), label="x' depends on y")
    y_by_x = draw(st.booleans(), label="y' depends on x'")
    zeros = draw(st.sampled_from((0.5, 0.8) if revealing else (0.0, 0.5, 0.8)), label="zeros")
    terminal = draw(st.sets(st.integers(0, x - 1), max_size=x - 1), label="terminal")
    discount = draw(st.sampled_from(discounts), label="discount")
    rng = np.random.default_rng(draw(st.integers(0, 2**32), label="seed"))
    return MOMDP.from_arrays(
        transition_x=random_rows(rng, (x, a, y, x) if x_by_y else (x, a, x), zeros),
        transition_y=random_rows(rng, (x, a, x, y, y) if y_by_x else (x, a, y, y), zeros),
        observation=random_rows(rng, (a, x, y, o), zeros),
        reward=rng.uniform(-1, 1, size=(x, a, y)),
        discount=discount,
        roots=random_roots(rng, x, y, 1.0 if revealing else zeros),
        terminal=sorted(terminal),
    )


@st.composite
def jump_momdps(
    draw: st.DrawFn,
    *,
    sizes: int = 3,
    discounts: Sequence[float] = DISCOUNTS,
    mixing: bool = False,
) -> MOMDP:
    """x moves deterministically; y stays or jumps within its block; some actions end the task.

    With ``mixing`` there are always two blocks, and moves between them.
    """
    x, a, o = (draw(st.integers(1, sizes), label=name) for name in ("X", "A", "O"))
    blocks = draw(st.integers(2 if mixing else 1, 2), label="blocks")
    values = draw(st.integers(1, 3 if blocks == 1 else 2), label="values")
    mixes = mixing or draw(st.booleans(), label="mixes")
    zeros = draw(st.sampled_from((0.0, 0.5)), label="zeros")
    discount = draw(st.sampled_from(discounts), label="discount")
    rng = np.random.default_rng(draw(st.integers(0, 2**32), label="seed"))
    goes_on = rng.random(x * a) < 0.8
    edges, maps = int(goes_on.sum()), 2
    # Rates of exactly 0 and 1 are the ones that matter most.
    rate = np.clip(rng.uniform(-0.3, 1.3, size=(blocks, values)), 0.0, 1.0)
    return MOMDP(
        edge_start=np.concatenate(([0], np.cumsum(goes_on))),
        edge_next=rng.integers(x, size=edges),
        edge_map=rng.integers(maps, size=edges),
        transition=JumpTransition(
            rate=rate,
            target=random_rows(rng, (maps, values), zeros),
            mixing=random_rows(rng, (blocks, blocks), zeros) if mixes else None,
        ),
        observation=random_rows(rng, (2, blocks * values, o), zeros),
        observation_index=rng.integers(2, size=(a, x)),
        reward=rng.uniform(-1, 1, size=(x, a, blocks * values)),
        discount=discount,
        roots=tuple(random_roots(rng, x, blocks * values, zeros)),
        observed_names=tuple(f"x{i}" for i in range(x)),
        hidden_names=tuple(f"y{i}" for i in range(blocks * values)),
        action_names=tuple(f"a{i}" for i in range(a)),
        observation_names=tuple(f"o{i}" for i in range(o)),
    )


def momdps(*, sizes: int = 3, discounts: Sequence[float] = DISCOUNTS) -> st.SearchStrategy[MOMDP]:
    """A random MOMDP with at most ``sizes`` of everything (4 hidden states with jumps)."""
    return sparse_momdps(sizes=sizes, discounts=discounts) | jump_momdps(
        sizes=sizes, discounts=discounts
    )


def beliefs(problem: MOMDP, rng: np.random.Generator) -> list[tuple[int, FloatArray]]:
    """For every observed state a random belief, some with zeros, and the certain ones."""
    x_count, y_count, _, _ = problem.shape
    some = [*random_rows(rng, (2, y_count), 0.4), *np.eye(y_count)]
    return [(x, belief) for x in range(x_count) for belief in some]
