"""A robot as arrays: what compiled code needs to decide as it does."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.formalism import Model, SharedAutonomy
from coadapt.formalism.collaboration import Collaboration
from coadapt.formalism.seen_modes import SeenModes
from coadapt.momdp.policy import AlphaVectorPolicy

ANSWERS = 0
"""The robot plans after the person's input, and may do what it asks for."""

FORESEES = 1
"""The robot plans before it sees the human's action."""

FIXED = 2
"""The robot knows what to do in every state and learns nothing."""

NO_CHANGE = np.zeros((0, 0))
"""Instead of ``T_alpha``: the identity."""


class RobotTables(NamedTuple):
    """A robot. Sizes: W windows, X states, A actions, M modes, L values of adaptability, O inputs,
    P vectors, Y hidden states of the policy: L * M, or L where modes are seen."""

    rule: int  # ANSWERS, FORESEES or FIXED
    state: IntArray  # [W] in which each window ends
    perceived: FloatArray  # [W, A, M] (Eq. 2)
    likelihood: FloatArray  # [X, O, M] of the inputs
    asks: IntArray  # [O] the action that each input asks for, or NO_ACTION
    threshold: float  # agreement from which the input is executed
    start: IntArray  # [W + 1] of the vectors of each window
    value: FloatArray  # [P * Y]; vector v of w has alpha(y) at start[w] * Y + y * (number at w) + v
    action: IntArray  # [P] of each vector
    going: IntArray  # [X] the action of a FIXED robot
    rate: FloatArray  # [L, M] readiness to switch to each mode
    by_goal: bool  # whether it differs from mode to mode
    mixing: FloatArray  # [L, L] T_alpha, or NO_CHANGE
    mode_chance: FloatArray  # [W, L, M] of the next mode where modes are seen, else [0, 0, 0]
    following: IntArray  # [W, A, O] a window that follows each pair of actions, else [0, 0, 0]
    room: int  # numbers that a decision needs at a time


@runtime_checkable
class TabledRobot(Protocol):
    """A robot that can be told as arrays: all of coadapt's can."""

    @property
    def tables(self) -> RobotTables:
        """The arrays."""
        ...


def robot_tables(
    model: Model,
    rule: int,
    *,
    policy: AlphaVectorPolicy | None = None,
    threshold: float = np.inf,
    going: IntArray | None = None,
) -> RobotTables:
    """The arrays of a robot.

    Args:
        model: what it believes of world and people.
        rule: how it decides.
        policy: of a robot that plans.
        threshold: agreement from which one that `ANSWERS` executes the input.
        going: ``[X]`` of one that is `FIXED`.
    """
    modes = len(model.world.goals)
    inputs = len(model.input_names)
    start, value, action = _columns(policy, len(model.windows))
    mode_chance, following = np.zeros((0, 0, 0)), np.zeros((0, 0, 0), dtype=np.int64)
    if isinstance(model, Collaboration) and isinstance(model.modes, SeenModes):
        mode_chance = model.modes.mode_chance
        # Which outcome their actions had says nothing about the mode.
        following = model.windows.next[:, :, :: model.modes.branching]
    asks = np.full(inputs, -1)
    if isinstance(model, SharedAutonomy):
        asks = model.interface.asks
    alpha = model.alpha
    return RobotTables(
        rule=rule,
        state=as_ints(model.windows.state),
        perceived=as_floats(model.perceived),
        likelihood=as_floats(model.input_likelihood),
        asks=as_ints(asks),
        threshold=float(threshold),
        start=start,
        value=value,
        action=action,
        going=as_ints(np.zeros(0, dtype=np.int64) if going is None else going),
        rate=as_floats(alpha.rates(modes)),
        by_goal=alpha.is_by_goal,
        mixing=as_floats(NO_CHANGE if alpha.is_fixed else alpha.transition),
        mode_chance=as_floats(mode_chance),
        following=as_ints(following),
        room=max(int(np.max(np.diff(start))), len(alpha.values)),
    )


def as_floats(values: FloatArray) -> FloatArray:
    """A copy as kernels need it: of one type, in one order, to be written to."""
    return np.array(values, dtype=np.float64, order="C")


def as_ints(values: IntArray) -> IntArray:
    """As `as_floats`, for indices."""
    return np.array(values, dtype=np.int64, order="C")


def _columns(
    policy: AlphaVectorPolicy | None, windows: int
) -> tuple[IntArray, FloatArray, IntArray]:
    """The vectors of each window side by side, so that they are looked up together."""
    if policy is None:
        none = np.zeros(0, dtype=np.int64)
        return np.zeros(windows + 1, dtype=np.int64), np.zeros(0), none
    start = as_ints(policy.start)
    parts = [policy.vectors[a:b].T.ravel() for a, b in pairwise(start)]
    return start, as_floats(np.concatenate(parts)), as_ints(policy.actions)
