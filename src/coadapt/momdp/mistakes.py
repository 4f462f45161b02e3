"""What is wrong with a planning problem: mistakes, collected, and the names of their places."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from coadapt.arrays import BoolArray, IntArray
from coadapt.momdp.model import MOMDP

EXAMPLES = 5
"""Number of places that are named for one kind of mistake."""

Place = tuple[int, ...]
"""Index of an entry of an array."""


class MOMDPError(ValueError):
    """A problem that is not a valid MOMDP.

    Attributes:
        problems: what is wrong, one sentence each.
        omitted: number of further mistakes that are not listed.
    """

    def __init__(self, problems: Sequence[str], omitted: int = 0) -> None:
        super().__init__(tuple(problems), omitted)
        self.problems = tuple(problems)
        self.omitted = omitted

    def __str__(self) -> str:
        lines = ["not a valid MOMDP:", *(f"  - {problem}" for problem in self.problems)]
        if self.omitted:
            lines.append(f"  and {self.omitted} more")
        return "\n".join(lines)


class MOMDPWarning(UserWarning):
    """A valid MOMDP that contains something its author may not have meant."""


class Mistakes:
    """A list of mistakes of bounded length.

    Args:
        limit: number of mistakes to keep; the rest is counted.
    """

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.found: list[str] = []
        self.omitted = 0

    def expect(self, holds: bool, mistake: str) -> bool:
        """Note ``mistake`` unless ``holds``, which is returned."""
        if not holds and len(self.found) < self.limit:
            self.found.append(mistake)
        elif not holds:
            self.omitted += 1
        return holds

    def expect_nowhere(self, wrong: BoolArray, mistake: Callable[[Place], str]) -> bool:
        """Note a mistake for every True entry of ``wrong``; whether there is none.

        Args:
            wrong: an array of any shape.
            mistake: says in a sentence what is wrong at an index. Called for the first few only.
        """
        if not wrong.any():
            return True
        places = np.argwhere(wrong)
        for place in places[:EXAMPLES]:
            self.expect(False, mistake(tuple(int(i) for i in place)))
        self.omitted += max(0, len(places) - EXAMPLES)
        return False


class Names:
    """Says where something is: ``names("x a", (2, 0))`` is ``x 2 (door), a 0 (left)``.

    Args:
        problem: gives the labels; those of the wrong number are left out.
    """

    def __init__(self, problem: MOMDP) -> None:
        self._row = row_of_edge(problem)
        self._actions = problem.shape[2]
        self._labels = {
            letter: given for letter, given, size in labels(problem) if len(given) == size
        }

    def __call__(self, axes: str, place: Place) -> str:
        """Name ``place``.

        Args:
            axes: for each index what it counts: x, y, a, o with a prime for what follows an
                action, ``edge``, or another word.
            place: the index.
        """
        return ", ".join(self._one(axis, i) for axis, i in zip(axes.split(), place, strict=True))

    def _one(self, axis: str, i: int) -> str:
        if axis == "edge":
            return f"edge {i} of {self('x a', divmod(int(self._row[i]), self._actions))}"
        given = self._labels.get(axis.rstrip("'"))
        return f"{axis} {i}" if given is None else f"{axis} {i} ({given[i]})"


def labels(problem: MOMDP) -> list[tuple[str, tuple[str, ...], int]]:
    """For each of x, y, a, o: the letter, its labels, and how many there should be."""
    given = (
        problem.observed_names,
        problem.hidden_names,
        problem.action_names,
        problem.observation_names,
    )
    return list(zip("xyao", given, problem.shape, strict=True))


def row_of_edge(problem: MOMDP) -> IntArray:
    """``[E]`` the ``x * A + a`` of every edge."""
    return np.repeat(np.arange(len(problem.edge_start) - 1), np.diff(problem.edge_start))
