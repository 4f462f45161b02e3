"""The planning problem: a Markov decision process of which a part of the state is observed.

A mixed-observability MDP (Ong, Png, Hsu, Lee 2010) has states ``(x, y)``: the robot sees ``x``
and holds a belief over ``y``. One step: the robot in ``(x, y)`` takes action ``a``, collects
``R(x, a, y)``, the state moves to ``(x', y')`` with probability ``P(x', y' | x, y, a)`` and the
robot sees ``x'`` and an observation ``o ~ O(o | a, x', y')``. A POMDP is the case ``|X| = 1``.

Where an ``(x, a)`` has no successor the episode ends after its reward: no sink state is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Self

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.momdp.transition import HiddenTransition, SparseTransition


@dataclass(frozen=True)
class Root:
    """A belief from which planning starts.

    Attributes:
        x: index of the observed state.
        belief: ``[Y]`` distribution over hidden states.
        probability: chance of starting here, in (0, 1]; the roots of a problem sum to 1.
        label: what distinguishes this root, for example the first observation.
    """

    x: int
    belief: FloatArray
    probability: float = 1.0
    label: str = ""


@dataclass(frozen=True)
class MOMDP:
    """A mixed-observability MDP in the form the solver reads.

    Successors are kept as a list of *edges*: edge ``e`` of ``(x, a)`` leads to ``edge_next[e]``
    and moves the hidden state by map ``edge_map[e]`` of ``transition``, whose entries are the
    joint ``P(x', y' | x, y, a)``. Build small problems from plain arrays with `from_arrays`, and
    test whatever you built with `coadapt.check_momdp`.

    Attributes:
        edge_start: ``[X * A + 1]``; the edges of ``(x, a)`` are
            ``edge_start[x * A + a] : edge_start[x * A + a + 1]``. An empty range ends the episode.
        edge_next: ``[E]`` observed state each edge leads to.
        edge_map: ``[E]`` index of its map in ``transition``.
        transition: the stack of hidden maps.
        observation: ``[K, Y, O]`` stack of distributions ``O(o | y')``.
        observation_index: ``[A, X]`` which of them holds after action ``a`` in observed state x'.
        reward: ``[X, A, Y]`` immediate rewards.
        discount: in [0, 1).
        roots: the beliefs to plan from, at least one.
        observed_names, hidden_names, action_names, observation_names: labels, used in files,
            reports and error messages.
    """

    edge_start: IntArray
    edge_next: IntArray
    edge_map: IntArray
    transition: HiddenTransition
    observation: FloatArray
    observation_index: IntArray
    reward: FloatArray
    discount: float
    roots: tuple[Root, ...]
    observed_names: tuple[str, ...] = field(repr=False)
    hidden_names: tuple[str, ...] = field(repr=False)
    action_names: tuple[str, ...] = field(repr=False)
    observation_names: tuple[str, ...] = field(repr=False)

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """``(|X|, |Y|, |A|, |O|)``."""
        x, a, y = self.reward.shape
        return x, y, a, self.observation.shape[2]

    @property
    def states(self) -> int:
        """``|X| * |Y|``, the size of the flat state space."""
        return self.reward.shape[0] * self.reward.shape[2]

    def edges(self, x: int, a: int) -> range:
        """The edge indices of ``(x, a)``."""
        row = x * self.reward.shape[1] + a
        return range(int(self.edge_start[row]), int(self.edge_start[row + 1]))

    @property
    def terminal(self) -> BoolArray:
        """``[X]`` observed states in which every action ends the episode."""
        x, a, _ = self.reward.shape
        return np.diff(self.edge_start).reshape(x, a).sum(axis=1) == 0

    def __repr__(self) -> str:
        x, y, a, o = self.shape
        return (
            f"MOMDP({x} observed x {y} hidden states, {a} actions, {o} observations, "
            f"discount {self.discount:g}, {len(self.roots)} roots)"
        )

    @classmethod
    def from_arrays(
        cls,
        transition_x: FloatArray,
        transition_y: FloatArray,
        observation: FloatArray,
        reward: FloatArray,
        discount: float,
        roots: Sequence[Root],
        *,
        terminal: Sequence[int] = (),
        observed_names: Sequence[str] | None = None,
        hidden_names: Sequence[str] | None = None,
        action_names: Sequence[str] | None = None,
        observation_names: Sequence[str] | None = None,
    ) -> Self:
        """A problem from dense arrays, for models small enough to write down.

        Args:
            transition_x: ``[X, A, X']``, or ``[X, A, Y, X']`` where it depends on the hidden state.
            transition_y: ``[X, A, Y, Y']``, or ``[X, A, X', Y, Y']`` where it depends on x'.
            observation: ``[A, X', Y', O]``.
            reward: ``[X, A, Y]``.
            discount: in [0, 1).
            roots: beliefs to plan from.
            terminal: observed states that end the episode; their transitions are ignored.
            observed_names, hidden_names, action_names, observation_names: labels; numbered by
                default.

        Raises:
            ValueError: if the shapes do not fit together.
        """
        x_count, a_count, y_count = reward.shape
        o_count = observation.shape[-1]
        by_y = transition_x if transition_x.ndim == 4 else transition_x[:, :, None, :]
        by_next = transition_y if transition_y.ndim == 5 else transition_y[:, :, None, :, :]
        _expect("transition_x", by_y.shape, (x_count, a_count, (1, y_count), x_count))
        _expect("transition_y", by_next.shape, (x_count, a_count, (1, x_count), y_count, y_count))
        _expect("observation", observation.shape, (a_count, x_count, y_count, o_count))
        start: list[int] = [0]
        following: list[int] = []
        maps: list[FloatArray] = []
        for x in range(x_count):
            for a in range(a_count):
                for x_next in () if x in terminal else range(x_count):
                    chance = by_y[x, a, :, x_next]
                    if np.any(chance != 0):
                        hidden = by_next[x, a, x_next if by_next.shape[2] > 1 else 0]
                        following.append(x_next)
                        maps.append(chance[:, None] * hidden)
                start.append(len(following))
        stacked = np.array(maps).reshape(len(maps), y_count, y_count)
        return cls(
            edge_start=np.array(start, dtype=np.int64),
            edge_next=np.array(following, dtype=np.int64),
            edge_map=np.arange(len(maps), dtype=np.int64),
            transition=SparseTransition.from_dense(stacked),
            observation=observation.reshape(a_count * x_count, y_count, o_count),
            observation_index=np.arange(a_count * x_count, dtype=np.int64).reshape(
                a_count, x_count
            ),
            reward=np.asarray(reward, dtype=np.float64),
            discount=float(discount),
            roots=tuple(roots),
            observed_names=_names(observed_names, "x", x_count),
            hidden_names=_names(hidden_names, "y", y_count),
            action_names=_names(action_names, "a", a_count),
            observation_names=_names(observation_names, "o", o_count),
        )


def _expect(name: str, found: tuple[int, ...], wanted: tuple[int | tuple[int, int], ...]) -> None:
    fits = len(found) == len(wanted) and all(
        size in (want if isinstance(want, tuple) else (want,))
        for size, want in zip(found, wanted, strict=True)
    )
    if not fits:
        raise ValueError(f"{name} has shape {found}; the reward's shape asks for {wanted}")


def _names(given: Sequence[str] | None, prefix: str, count: int) -> tuple[str, ...]:
    if given is None:
        return tuple(f"{prefix}{i}" for i in range(count))
    if len(given) != count:
        raise ValueError(f"{len(given)} names for {count} values of {prefix}")
    return tuple(given)


def return_range(problem: MOMDP) -> tuple[float, float]:
    """Bounds of the discounted sum of rewards of an episode that may end at any time."""
    worst, best = float(problem.reward.min()), float(problem.reward.max())
    forever = 1.0 / (1.0 - problem.discount)
    return min(worst, worst * forever), max(best, best * forever)
