"""Random factored problems, as text and as arrays worked out one assignment at a time."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st

from tests.momdp.strategies import random_rows

Assignment = dict[str, int]


@dataclass(frozen=True)
class Table:
    """``value[parents..., variable]``, or ``value[parents...]`` for a reward."""

    variable: str
    parents: tuple[str, ...]
    value: np.ndarray

    def at(self, assignment: Assignment) -> float:
        names = (*self.parents, self.variable)[: self.value.ndim]
        return float(self.value[tuple(assignment[name] for name in names)])


@dataclass(frozen=True)
class Factored:
    """Sizes of all variables, and the tables of each section."""

    observed: dict[str, int]
    hidden: dict[str, int]
    actions: dict[str, int]
    seen: dict[str, int]
    start: list[Table]
    moves: list[Table]
    sights: list[Table]
    gains: list[Table]

    def text(self, split: bool) -> str:
        """The `.pomdpx` file.

        Args:
            split: give each value of a table's first axis its own entry, after one that sets all
                cells to something else; otherwise one entry lists everything.
        """

        def values(size: int) -> str:
            return f"<ValueEnum>{' '.join(f'v{i}' for i in range(size))}</ValueEnum>"

        states = [
            f'<StateVar vnamePrev="{name}" vnameCurr="{name}+" fullyObs="{full}">{values(size)}'
            "</StateVar>"
            for full, group in (("true", self.observed), ("false", self.hidden))
            for name, size in group.items()
        ]
        others = [
            f'<{kind} vname="{name}">{values(size)}</{kind}>'
            for kind, group in (("ActionVar", self.actions), ("ObsVar", self.seen))
            for name, size in group.items()
        ]
        gains = [f'<RewardVar vname="{table.variable}"/>' for table in self.gains]

        def entries(table: Table, kind: str) -> str:
            value, axes = table.value, table.value.ndim
            parts = [("- " * axes, value)]
            if split and axes:
                rest = "- " * (axes - 1)
                parts = [(f"v{i} {rest}", value[i]) for i in range(len(value))]
                parts.insert(0, ("* " * axes, np.array(0.5)))
            return "".join(
                f"<Entry><Instance>{instance}</Instance><{kind}>"
                f"{' '.join(repr(float(v)) for v in values.ravel())}</{kind}></Entry>"
                for instance, values in parts
            )

        def section(name: str, element: str, kind: str, tables: list[Table]) -> str:
            parts = [
                f"<{element}><Var>{t.variable}</Var><Parent>{' '.join(t.parents) or 'null'}"
                f"</Parent><Parameter>{entries(t, kind)}</Parameter></{element}>"
                for t in tables
            ]
            return f"<{name}>{''.join(parts)}</{name}>"

        return (
            "<pomdpx><Discount>0.5</Discount>"
            + section("RewardFunction", "Func", "ValueTable", self.gains)
            + section("ObsFunction", "CondProb", "ProbTable", self.sights)
            + section("StateTransitionFunction", "CondProb", "ProbTable", self.moves)
            + section("InitialStateBelief", "CondProb", "ProbTable", self.start)
            + f"<Variable>{''.join([*states, *gains, *others])}</Variable></pomdpx>"
        )

    def all(self, *groups: dict[str, int], after: bool = False) -> list[Assignment]:
        """All assignments to the variables of ``groups``, the first the most significant."""
        sizes = {f"{k}+" if after else k: n for group in groups for k, n in group.items()}
        ranges = [range(size) for size in sizes.values()]
        return [dict(zip(sizes, v, strict=True)) for v in itertools.product(*ranges)]

    def joint(self) -> np.ndarray:
        """``[X, A, Y, X', Y']``: the product of all factors."""
        axes = (
            self.all(self.observed),
            self.all(self.actions),
            self.all(self.hidden),
            self.all(self.observed, after=True),
            self.all(self.hidden, after=True),
        )
        return self._filled(axes, self.moves)

    def observation(self) -> np.ndarray:
        """``[A, X', Y', O]``."""
        axes = (
            self.all(self.actions),
            self.all(self.observed, after=True),
            self.all(self.hidden, after=True),
            self.all(self.seen),
        )
        return self._filled(axes, self.sights)

    def initial(self) -> np.ndarray:
        """``[X, Y]``."""
        return self._filled((self.all(self.observed), self.all(self.hidden)), self.start)

    def reward(self) -> np.ndarray:
        """``[X, A, Y]``: the expectation of the sum of the reward tables."""
        axes = (
            self.all(self.observed),
            self.all(self.actions),
            self.all(self.hidden),
            self.all(self.observed, after=True),
            self.all(self.hidden, after=True),
        )
        total = sum(self._filled(axes, [table]) for table in self.gains)
        return (total * self.joint()).sum(axis=(3, 4))

    def _filled(self, axes: tuple[list[Assignment], ...], tables: list[Table]) -> np.ndarray:
        out = np.empty([len(axis) for axis in axes])
        for index in np.ndindex(*out.shape):
            assignment: Assignment = {}
            for axis, i in zip(axes, index, strict=True):
                assignment |= axis[i]
            out[index] = np.prod([table.at(assignment) for table in tables])
        return out


@st.composite
def factored_problems(draw: st.DrawFn) -> Factored:
    """Up to two variables of each kind; any parents that make no circle."""
    sizes = st.integers(1, 3)

    def group(letter: str, least: int, most: int) -> dict[str, int]:
        count = draw(st.integers(least, most))
        return {f"{letter}{i}": draw(sizes) for i in range(count)}

    observed = group("x", 0, 2)
    hidden = group("y", 0 if observed else 1, 2)
    actions, seen = group("a", 1, 2), group("o", 0, 2)
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    zeros = draw(st.sampled_from((0.0, 0.4, 0.7)))
    size = {**observed, **hidden, **actions, **seen}
    size |= {f"{name}+": n for name, n in {**observed, **hidden}.items()}

    def some(names: list[str]) -> tuple[str, ...]:
        if not names:
            return ()
        return tuple(draw(st.lists(st.sampled_from(names), unique=True, max_size=3)))

    def conditional(name: str, names: list[str]) -> Table:
        parents = some(names)
        shape = tuple(size[parent] for parent in (*parents, name))
        return Table(name, parents, random_rows(rng, shape, zeros))

    before = [*observed, *hidden]
    order = draw(st.permutations(before))
    start = [conditional(name, order[:i]) for i, name in enumerate(order)]
    order = [f"{name}+" for name in draw(st.permutations(before))]
    after = [conditional(name, [*before, *actions, *order[:i]]) for i, name in enumerate(order)]
    gains: list[Table] = []
    for i in range(draw(st.integers(1, 2))):
        parents = some([*before, *actions, *order])
        value = rng.integers(-3, 4, size=[size[parent] for parent in parents]) * 1.0
        gains.append(Table(f"r{i}", parents, value))
    sights = [conditional(name, [*actions, *order]) for name in seen]
    return Factored(observed, hidden, actions, seen, start, after, sights, gains)
