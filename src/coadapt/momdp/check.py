"""Whether a planning problem means what it says: every row a distribution, every index in range.

`check_momdp` tests a `MOMDP` that was built by hand, by a program or by a file reader, and says
what is wrong and where. Solvers trust a problem that has passed. The work is linear in the size of
the arrays: maps over hidden states are looked at row by row and never expanded to matrices.
"""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.momdp.mistakes import (
    Mistakes,
    MOMDPError,
    MOMDPWarning,
    Names,
    Place,
    labels,
    row_of_edge,
)
from coadapt.momdp.model import MOMDP
from coadapt.momdp.transition import HiddenTransition, SparseTransition

__all__ = ["MOMDPError", "MOMDPWarning", "check_momdp"]

TOLERANCE = 1e-6
"""How far a sum of probabilities may be from 1."""

LIMIT = 20
"""Number of mistakes that an error lists."""

ROUNDING = 1e-9
"""How far above 1 a single probability may be."""


def check_momdp(problem: MOMDP, *, tolerance: float = TOLERANCE, limit: int = LIMIT) -> None:
    """Raise unless ``problem`` is a MOMDP that a solver can read.

    Checked are

    * types, shapes and lengths of all arrays: ``float64`` and ``int64``, contiguous;
    * that indices are in range, numbers finite, probabilities not negative, and that no successor
      of an ``(x, a)`` is listed twice;
    * ``sum_{x', y'} P(x', y' | x, y, a) = 1`` for every ``y`` of every ``(x, a)`` with successors;
    * that ``O(. | a, x', y')`` is a distribution wherever an edge of ``a`` leads to ``x'`` and its
      map to ``y'``;
    * discount, roots and names.

    Where a shape is wrong the numbers are not looked at, and where a number is out of range the
    sums are not.

    Args:
        problem: the problem to check.
        tolerance: how far a sum of probabilities may be from 1.
        limit: number of mistakes that the error lists.

    Raises:
        MOMDPError: if anything is wrong: a list of what, where, and what was expected.

    Warns:
        MOMDPWarning: if no root leads to some of the observed states.
    """
    mistakes = Mistakes(limit)
    if _arrays_fit(problem, mistakes):
        names = Names(problem)
        _check_values(problem, mistakes, names)
        if not mistakes.found:
            _check_successors(problem, mistakes, names)
            _check_transition_rows(problem, mistakes, names, tolerance)
            _check_observation_rows(problem, mistakes, names, tolerance)
        _check_roots(problem, mistakes, names, tolerance)
        _check_labels(problem, mistakes)
    if mistakes.found:
        raise MOMDPError(mistakes.found, mistakes.omitted)
    _warn_unreachable(problem, limit)


def _arrays_fit(problem: MOMDP, mistakes: Mistakes) -> bool:
    """Whether types, dimensions and lengths allow looking at the contents."""
    t = problem.transition
    arrays: list[tuple[str, object, str, int]] = [
        ("edge_start", problem.edge_start, "int64", 1),
        ("edge_next", problem.edge_next, "int64", 1),
        ("edge_map", problem.edge_map, "int64", 1),
        ("observation", problem.observation, "float64", 3),
        ("observation_index", problem.observation_index, "int64", 2),
        ("reward", problem.reward, "float64", 3),
    ]
    if isinstance(t, SparseTransition):
        arrays.append(("transition.row_start", t.row_start, "int64", 1))
        arrays.append(("transition.column", t.column, "int64", 1))
        arrays.append(("transition.value", t.value, "float64", 1))
    else:
        arrays.append(("transition.rate", t.rate, "float64", 2))
        arrays.append(("transition.target", t.target, "float64", 2))
        if t.mixing is not None:
            arrays.append(("transition.mixing", t.mixing, "float64", 2))
    for r, root in enumerate(problem.roots):
        arrays.append((f"the belief of root {r}", root.belief, "float64", 1))
    # A list rather than a generator: every array is looked at.
    return all([_is_array(mistakes, *array) for array in arrays]) and _lengths_fit(
        problem, mistakes
    )


def _is_array(mistakes: Mistakes, name: str, value: object, kind: str, axes: int) -> bool:
    wanted = f"expected a contiguous {kind} array with {axes} axes"
    if not isinstance(value, np.ndarray):
        return mistakes.expect(False, f"{name} is a {type(value).__name__}, {wanted}")
    array: NDArray[np.generic] = value  # pyright: ignore[reportUnknownVariableType]
    found = f"{array.dtype} array of shape {array.shape}"
    if not array.flags.c_contiguous:
        found = f"non-contiguous {found}"
    right = array.dtype == np.dtype(kind) and array.ndim == axes and array.flags.c_contiguous
    return mistakes.expect(bool(right), f"{name} is a {found}, {wanted}")


def _lengths_fit(problem: MOMDP, mistakes: Mistakes) -> bool:
    x, y, a, _ = problem.shape
    if not mistakes.expect(
        min(problem.shape) > 0,
        f"the numbers of observed states, hidden states, actions and observations are "
        f"{problem.shape}, expected at least 1 of each",
    ):
        return False
    t = problem.transition
    edges = len(problem.edge_next)
    starts = [("edge_start", problem.edge_start, edges)]
    sizes: list[tuple[str, object, object]] = [
        ("the length of edge_map", len(problem.edge_map), edges),
        ("the length of edge_start", len(problem.edge_start), x * a + 1),
        ("the second axis of observation", problem.observation.shape[1], y),
        ("the shape of observation_index", problem.observation_index.shape, (a, x)),
        ("the number of hidden states of the transition", t.hidden, y),
    ]
    for r, root in enumerate(problem.roots):
        sizes.append((f"the length of the belief of root {r}", len(root.belief), y))
    if isinstance(t, SparseTransition):
        starts.append(("transition.row_start", t.row_start, len(t.column)))
        sizes.append(("the length of transition.value", len(t.value), len(t.column)))
        rest = (len(t.row_start) - 1) % max(1, t.hidden)
        sizes.append((f"the length of transition.row_start, less 1, modulo {t.hidden},", rest, 0))
    else:
        blocks, values = t.rate.shape
        sizes.append(("the second axis of transition.target", t.target.shape[1], values))
        if t.mixing is not None:
            sizes.append(("the shape of transition.mixing", t.mixing.shape, (blocks, blocks)))
    fits = [mistakes.expect(f == w, f"{name} is {f}, expected {w}") for name, f, w in sizes]
    return all(fits) and all([_is_start(mistakes, *start) for start in starts])


def _is_start(mistakes: Mistakes, name: str, start: IntArray, end: int) -> bool:
    found = f"{name} goes from {start[:1]} to {start[-1:]}"
    return mistakes.expect(
        start[:1].tolist() == [0] and start[-1:].tolist() == [end],
        f"{found}, expected from 0 to {end}",
    ) and mistakes.expect_nowhere(
        np.diff(start) < 0,
        lambda at: (
            f"{name}[{at[0] + 1}] is {start[at[0] + 1]}, expected at least the {start[at[0]]} "
            "before it"
        ),
    )


def _check_values(problem: MOMDP, mistakes: Mistakes, names: Names) -> None:
    """That every number is finite and in its range."""
    x, y, _, _ = problem.shape
    t = problem.transition
    gamma = problem.discount
    mistakes.expect(0 <= gamma < 1, f"discount is {gamma}, expected at least 0 and below 1")
    probabilities = [("observation", problem.observation, "matrix y' o")]
    indices = [
        ("the successor", problem.edge_next, "edge", x),
        ("the map", problem.edge_map, "edge", t.count),
        ("observation_index", problem.observation_index, "a x'", len(problem.observation)),
    ]
    if isinstance(t, SparseTransition):
        probabilities.append(("transition.value", t.value, "entry"))
        indices.append(("transition.column", t.column, "entry", y))
    else:
        probabilities.append(("transition.rate", t.rate, "block value"))
        probabilities.append(("transition.target", t.target, "map value"))
        if t.mixing is not None:
            probabilities.append(("transition.mixing", t.mixing, "block block'"))
    for name, values, axes in probabilities:
        _expect_values(mistakes, names, name, values, axes, (0, 1 + ROUNDING))
    for name, values, axes, size in indices:
        _expect_values(mistakes, names, name, values, axes, (0, size - 1))
    _expect_values(mistakes, names, "reward", problem.reward, "x a y", (-np.inf, np.inf))


def _expect_values(
    mistakes: Mistakes,
    names: Names,
    name: str,
    values: FloatArray | IntArray,
    axes: str,
    limits: tuple[float, float],
) -> bool:
    low, high = limits
    wanted = "a finite number" if high == np.inf else f"{low:g} to {high:g}"
    return mistakes.expect_nowhere(
        ~((values >= low) & (values <= high) & np.isfinite(values)),
        lambda at: f"{name} in {names(axes, at)} is {values[at]}, expected {wanted}",
    )


def _check_successors(problem: MOMDP, mistakes: Mistakes, names: Names) -> None:
    """That no two edges of one (x, a) lead to the same x'."""
    pairs = row_of_edge(problem) * problem.shape[0] + problem.edge_next
    order = np.argsort(pairs, kind="stable")
    repeated = np.zeros(len(pairs), dtype=np.bool_)
    repeated[order[1:]] = np.diff(pairs[order]) == 0
    mistakes.expect_nowhere(
        repeated,
        lambda at: (
            f"{names('edge', at)} leads to {names('x', (int(problem.edge_next[at]),))} as an edge "
            "before it does, expected one edge for each successor"
        ),
    )


def _check_transition_rows(
    problem: MOMDP, mistakes: Mistakes, names: Names, tolerance: float
) -> None:
    x, y, a, _ = problem.shape
    t = problem.transition
    if not isinstance(t, SparseTransition):
        jump = t.target @ t.rate.T  # [K, B]
        mistakes.expect_nowhere(
            jump > 1 + ROUNDING,
            lambda at: (
                f"the probability of a jump in {names('map block', at)} of the transition is "
                f"{jump[at]}, expected at most 1"
            ),
        )
        if t.mixing is not None:
            mixing = t.mixing.sum(axis=1)
            mistakes.expect_nowhere(
                np.abs(mixing - 1) > tolerance,
                lambda at: f"row {at[0]} of transition.mixing sums to {mixing[at]}, expected 1",
            )
    ones = np.ones(len(problem.edge_map))
    uses = sparse.csr_array((ones, problem.edge_map, problem.edge_start), shape=(x * a, t.count))
    sums = np.asarray(uses @ t.row_sums()).reshape(x, a, y)
    goes_on = np.diff(problem.edge_start).reshape(x, a, 1) > 0
    mistakes.expect_nowhere(
        goes_on & (np.abs(sums - 1) > tolerance),
        lambda at: (
            f"the successors of {names('x a y', at)} have total probability {sums[at]}, expected 1"
        ),
    )


def _check_observation_rows(
    problem: MOMDP, mistakes: Mistakes, names: Names, tolerance: float
) -> None:
    t = problem.transition
    actions = row_of_edge(problem) % problem.shape[2]
    used = problem.observation_index[actions, problem.edge_next]  # [E]
    meets = sparse.csr_array(
        (np.ones(len(used)), (used, problem.edge_map)), shape=(len(problem.observation), t.count)
    )
    arrives = _arrives(t)
    reached = np.asarray(meets @ arrives.astype(np.float64)) > 0  # [K, Y]
    sums = problem.observation.sum(axis=2)

    def mistake(at: Place) -> str:
        edge = int(np.argmax((used == at[0]) & arrives[problem.edge_map, at[1]]))
        where = names("a x' y'", (int(actions[edge]), int(problem.edge_next[edge]), at[1]))
        return f"the observations in {where} have total probability {sums[at]}, expected 1"

    mistakes.expect_nowhere(reached & (np.abs(sums - 1) > tolerance), mistake)


def _arrives(t: HiddenTransition) -> BoolArray:
    """``[K, Y']`` whether map ``k`` gives ``y'`` any probability, whatever it starts from."""
    if isinstance(t, SparseTransition):
        map_of_entry = np.repeat(np.arange(t.count * t.hidden), np.diff(t.row_start)) // t.hidden
        arrives = np.zeros((t.count, t.hidden), dtype=np.bool_)
        possible = t.value > 0
        arrives[map_of_entry[possible], t.column[possible]] = True
        return arrives
    jump = t.target[:, None, :] * t.rate  # [K, B, M]
    # y = (i, m) keeps its mass unless it jumps elsewhere with certainty.
    arrives = (jump > 0) | (jump.sum(axis=2, keepdims=True) - jump < 1)
    if t.mixing is not None:
        arrives = (t.mixing.T > 0).astype(np.float64) @ arrives.astype(np.float64) > 0
    return arrives.reshape(t.count, t.hidden)


def _check_roots(problem: MOMDP, mistakes: Mistakes, names: Names, tolerance: float) -> None:
    if not mistakes.expect(len(problem.roots) > 0, "there are no roots, expected at least one"):
        return
    states = problem.shape[0]
    for r, root in enumerate(problem.roots):
        what = f"root {r} ({root.label})" if root.label else f"root {r}"
        mistakes.expect(0 <= root.x < states, f"{what} has x {root.x}, expected 0 to {states - 1}")
        mistakes.expect(
            0 < root.probability <= 1 + tolerance,
            f"{what} has probability {root.probability}, expected above 0 and at most 1",
        )
        name = f"the belief of {what}"
        if _expect_values(mistakes, names, name, root.belief, "y", (0, 1 + ROUNDING)):
            total = float(root.belief.sum())
            mistakes.expect(abs(total - 1) <= tolerance, f"{name} sums to {total}, expected 1")
    total = sum(root.probability for root in problem.roots)
    mistakes.expect(
        abs(total - 1) <= tolerance, f"the probabilities of the roots sum to {total}, expected 1"
    )


def _check_labels(problem: MOMDP, mistakes: Mistakes) -> None:
    for letter, given, count in labels(problem):
        mistakes.expect(
            len(given) == count, f"there are {len(given)} names of {letter}, expected {count}"
        )
        first: dict[str, int] = {}
        for i, label in enumerate(given):
            if (known := first.setdefault(label, i)) != i:
                mistakes.expect(
                    False,
                    f"{letter} {i} is named {label!r} as {letter} {known} is, expected different "
                    "names",
                )


def _warn_unreachable(problem: MOMDP, limit: int) -> None:
    # Slow to import, and a command that reads a file does not need it.
    from scipy.sparse import csgraph  # noqa: PLC0415

    x, _, a, _ = problem.shape
    possible: BoolArray = np.any(_arrives(problem.transition), axis=1)[problem.edge_map]
    source = row_of_edge(problem)[possible] // a
    roots = np.array([root.x for root in problem.roots])
    # State X is a start in front of all roots.
    row = np.concatenate((source, np.full(len(roots), x)))
    column = np.concatenate((problem.edge_next[possible], roots))
    graph = sparse.csr_array((np.ones(len(row)), (row, column)), shape=(x + 1, x + 1))
    reached = csgraph.breadth_first_order(graph, x, return_predecessors=False)
    missing = np.setdiff1d(np.arange(x), reached)
    if len(missing):
        names = Names(problem)
        listed = ", ".join(names("x", (int(i),)) for i in missing[:limit])
        more = f" and {len(missing) - limit} more" if len(missing) > limit else ""
        warnings.warn(
            f"no root leads to {len(missing)} of {x} observed states: {listed}{more}",
            MOMDPWarning,
            stacklevel=3,
        )
