"""Writes problems as `.pomdpx` files, with the shortest digits that read back exactly.

The observed and the hidden state are one variable each. What a problem has and the format has not
is added first, see `coadapt.momdp.files.file_form`.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import BinaryIO, final

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.momdp.files.atomic import replacing
from coadapt.momdp.files.file_form import as_sparse, file_form
from coadapt.momdp.files.pomdpx_choices import ALL, choices
from coadapt.momdp.files.pomdpx_conditional import Rows, conditionals
from coadapt.momdp.files.pomdpx_text import Writer, file_names
from coadapt.momdp.files.values import SUM_TOLERANCE, joined, shortest
from coadapt.momdp.model import MOMDP

ENTRY, NUMBER, ZERO = 75, 19, 2
"""Rough lengths in characters: an entry without its numbers, a number, a zero."""


def write_pomdpx(problem: MOMDP, path: str | os.PathLike[str]) -> None:
    """Write ``problem`` to a `.pomdpx` file, which appears complete or not at all.

    A problem with one root and without ends reads back the same. Otherwise states are added after
    its own, see `coadapt.momdp.files.file_form`; only a start state changes the optimal value, by
    the factor ``problem.discount``, and the file's description says so.

    Args:
        problem: one that `coadapt.check_momdp` accepts.
        path: where to write.

    Raises:
        coadapt.errors.InputError: if the file cannot be written.
    """
    closed, factor = file_form(problem)
    with replacing(path) as file:
        _ProblemWriter(file, closed, factor).write(len(problem.observed_names))


@final
class _ProblemWriter:
    """Writes one problem of the form that the format can hold."""

    def __init__(self, file: BinaryIO, problem: MOMDP, factor: float) -> None:
        self._to = Writer(file)
        self._problem = problem
        self._factor = factor
        self._x = file_names(problem.observed_names)
        self._y = file_names(problem.hidden_names)
        self._a = file_names(problem.action_names)
        self._o = file_names(problem.observation_names)
        # A group of the one value that reading adds is left out.
        self._has_y = self._y != ("y0",)
        self._has_x = self._x != ("x0",) or not self._has_y

    def write(self, own_states: int) -> None:
        """Write the whole file.

        Args:
            own_states: how many of the observed states are the problem's own.
        """
        line = self._to.line
        line('<?xml version="1.0" encoding="UTF-8"?>')
        line('<pomdpx version="1.0" id="coadapt">')
        note = "Values are those of the problem."
        if self._factor != 1.0:
            note = (
                "The start state costs one step: values are those of the problem times "
                f"{shortest(self._factor)}."
            )
        added = len(self._x) - own_states
        line(f"<Description>{added} observed states were added. {note}</Description>")
        line(f"<Discount>{shortest(self._problem.discount)}</Discount>")
        self._variables()
        for section, write in (
            ("InitialStateBelief", self._start),
            ("StateTransitionFunction", self._transition),
            ("ObsFunction", self._observation),
            ("RewardFunction", self._reward),
        ):
            line(f"<{section}>")
            write()
            line(f"</{section}>")
        line("</pomdpx>")

    def _variables(self) -> None:
        line, values = self._to.line, self._to.values
        line("<Variable>")
        for has, name, names, seen in (
            (self._has_x, "x", self._x, "true"),
            (self._has_y, "y", self._y, "false"),
        ):
            if has:
                line(
                    f'<StateVar vnamePrev="{name}_0" vnameCurr="{name}_1" fullyObs="{seen}">'
                    f"{values(names, 's')}</StateVar>"
                )
        line(f'<ObsVar vname="o">{values(self._o, "o")}</ObsVar>')
        line(f'<ActionVar vname="a">{values(self._a, "a")}</ActionVar>')
        line('<RewardVar vname="r"/>')
        line("</Variable>")

    def _present(self, *words: tuple[str, str]) -> list[str]:
        """The words of the variables that the file has: pairs of variable and word."""
        has = {"x": self._has_x, "y": self._has_y, "a": True, "o": True}
        return [word for variable, word in words if has[variable]]

    def _start(self) -> None:
        roots = self._problem.roots
        chance = np.zeros(len(self._x))
        for root in roots:
            chance[root.x] = root.probability
        if self._has_x:
            self._to.begin_table("CondProb", "x_0", ())
            self._to.entry(["-"], joined(chance))
            self._to.end_table("CondProb")
        if not self._has_y:
            return
        if all(np.array_equal(root.belief, roots[0].belief) for root in roots):
            self._to.begin_table("CondProb", "y_0", ())
            self._to.entry(["-"], joined(roots[0].belief))
        else:
            self._to.begin_table("CondProb", "y_0", ["x_0"])
            self._to.entry(["*", "-"], "uniform")
            for root in roots:
                self._to.entry([self._x[root.x], "-"], joined(root.belief))
        self._to.end_table("CondProb")

    def _transition(self) -> None:
        problem = self._problem
        split = conditionals(problem, as_sparse(problem.transition))
        if self._has_x:
            self._observed_transition(split.chance)
        if not self._has_y:
            return
        parents = self._present(("a", "a"), ("x", "x_0"))
        if split.by_edge:
            self._to.begin_table("CondProb", "y_1", [*parents, "x_1", "y_0"])
            self._to.entry(["*", "*", "*", "-", "-"], "identity")
            actions = len(self._a)
            row = np.repeat(np.arange(len(problem.edge_start) - 1), np.diff(problem.edge_start))
            for edge, choice in enumerate(split.choice):
                x, a = divmod(int(row[edge]), actions)
                where = [self._a[a], self._x[x], self._x[int(problem.edge_next[edge])]]
                self._map(where, split.maps[int(choice)], fresh=False)
        else:
            self._to.begin_table("CondProb", "y_1", [*parents, "y_0"])
            for i, (a, x, choice) in enumerate(choices(split.choice)):
                self._map(self._where(a, x), split.maps[choice], fresh=i == 0)
        self._to.end_table("CondProb")

    def _where(self, a: int, x: int) -> list[str]:
        action = "*" if a == ALL else self._a[a]
        return self._present(("a", action), ("x", "*" if x == ALL else self._x[x]))

    def _observed_transition(self, chance: FloatArray) -> None:
        problem = self._problem
        by_y = chance.shape[1] > 1 and self._has_y
        self._to.begin_table("CondProb", "x_1", ["a", "x_0", *(["y_0"] if by_y else [])])
        for x, name in enumerate(self._x):
            ranges = [problem.edges(x, a) for a in range(len(self._a))]
            edges = [
                (problem.edge_next[list(r)].tobytes(), chance[list(r)].tobytes()) for r in ranges
            ]
            same = all(edge == edges[0] for edge in edges)
            for a in range(1 if same else len(self._a)):
                action = "*" if same else self._a[a]
                for e in ranges[a]:
                    to = self._x[int(problem.edge_next[e])]
                    if not by_y:
                        self._to.entry([action, name, to], shortest(chance[e, 0]))
                    elif (chance[e] == chance[e, 0]).all():
                        self._to.entry([action, name, "*", to], shortest(chance[e, 0]))
                    else:
                        self._to.entry([action, name, "-", to], joined(chance[e]))
        self._to.end_table("CondProb")

    def _map(self, where: Sequence[str], rows: Rows, *, fresh: bool) -> None:
        """Entries of a conditional map; ``fresh`` if nothing was set there before."""
        size = len(self._y)
        data = np.asarray(rows.data, dtype=np.float64)
        start = np.asarray(rows.indptr, dtype=np.int64)
        column = np.asarray(rows.indices, dtype=np.int64)
        if len(data) == size and (data == 1).all() and (column == np.arange(size)).all():
            self._to.entry([*where, "-", "-"], "identity")
            return
        length = np.diff(start)
        # Cell by cell, or the whole row where that is shorter.
        whole = length * (ENTRY + NUMBER) > ENTRY + size * ZERO + length * NUMBER
        cost = np.where(
            whole, ENTRY + size * ZERO + length * NUMBER, length * (ENTRY + NUMBER)
        ).sum()
        if size * size * ZERO + len(data) * NUMBER + ENTRY < cost:
            self._to.entry([*where, "-", "-"], joined(rows.toarray()))
            return
        if not fresh and not whole.all():
            self._to.entry([*where, "*", "*"], "0")
        for y, name in enumerate(self._y):
            part = slice(int(start[y]), int(start[y + 1]))
            if whole[y]:
                row = np.zeros(size)
                row[column[part]] = data[part]
                self._to.entry([*where, name, "-"], joined(row))
            else:
                for to, value in zip(column[part], data[part], strict=True):
                    self._to.entry([*where, name, self._y[int(to)]], shortest(value))

    def _observation(self) -> None:
        problem = self._problem
        parents = self._present(("a", "a"), ("x", "x_1"), ("y", "y_1"))
        self._to.begin_table("CondProb", "o", parents)
        stack = problem.observation.copy()
        # What no transition reaches may be anything; the file needs distributions.
        stack[np.abs(stack.sum(axis=2) - 1) > SUM_TOLERANCE] = 1.0 / stack.shape[2]
        flat = stack.reshape(len(stack), -1)
        _, first, number = np.unique(flat, axis=0, return_index=True, return_inverse=True)
        index = first[number.ravel()[problem.observation_index]]
        texts: dict[int, list[tuple[list[str], str]]] = {}
        for a, x, choice in choices(index):
            if choice not in texts:
                texts[choice] = self._sights(stack[choice])
            for rest, numbers in texts[choice]:
                self._to.entry([*self._where(a, x), *rest], numbers)
        self._to.end_table("CondProb")

    def _sights(self, rows: FloatArray) -> list[tuple[list[str], str]]:
        """Entries of an observation matrix ``[Y, O]``: the end of the instance, and the numbers."""
        if not self._has_y:
            return [(["-"], joined(rows[0]))]
        different, number = np.unique(rows, axis=0, return_inverse=True)
        number = number.ravel()
        usual = int(np.argmax(np.bincount(number)))
        others = np.flatnonzero(number != usual)
        width = rows.shape[1] * NUMBER
        if len(others) and (len(others) + 1) * (ENTRY + width) > len(rows) * width:
            return [(["-", "-"], joined(rows))]
        exceptions = [([self._y[int(y)], "-"], joined(rows[y])) for y in others]
        return [(["*", "-"], joined(different[usual])), *exceptions]

    def _reward(self) -> None:
        reward = self._problem.reward.transpose(1, 0, 2)  # [A, X, Y]
        parents = self._present(("a", "a"), ("x", "x_0"), ("y", "y_0"))
        self._to.begin_table("Func", "r", parents)
        flat = np.ascontiguousarray(reward).reshape(-1, reward.shape[2])
        known: dict[bytes, int] = {}
        index: IntArray = np.array(
            [known.setdefault(row.tobytes(), i) for i, row in enumerate(flat)]
        )
        for a, x, choice in choices(index.reshape(reward.shape[:2])):
            row = flat[choice]
            rest = self._present(("y", "*" if (row == row[0]).all() else "-"))
            numbers = shortest(row[0]) if "-" not in rest else joined(row)
            self._to.entry([*self._where(a, x), *rest], numbers, "ValueTable")
        self._to.end_table("Func")
