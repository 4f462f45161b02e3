"""The filter over adaptability and mode for one belief, see `coadapt.human.filter`."""

from __future__ import annotations

from coadapt.arrays import FloatArray
from coadapt.jit import bare
from coadapt.robots.tables import RobotTables


@bare
def copy(belief: FloatArray, out: FloatArray) -> None:
    """Write ``belief`` ``[L, M]`` to ``out``."""
    values, modes = belief.shape
    for i in range(values):
        for m in range(modes):
            out[i, m] = belief[i, m]


@bare
def correct(likelihood: FloatArray, belief: FloatArray) -> None:
    """Condition ``belief`` ``[L, M]`` on an input of ``likelihood`` ``[M]`` (Eq. 5), in place.

    An input that no mode explains changes nothing.
    """
    values, modes = belief.shape
    total = 0.0
    for i in range(values):
        for m in range(modes):
            total += belief[i, m] * likelihood[m]
    if total > 0.0:
        for i in range(values):
            for m in range(modes):
                belief[i, m] = belief[i, m] * likelihood[m] / total


@bare
def predict(
    r: RobotTables, perceived: FloatArray, belief: FloatArray, out: FloatArray, scratch: FloatArray
) -> None:
    """Write ``belief`` after the robot was seen in each mode with ``perceived`` ``[M]`` to ``out``.

    The sums of Eq. 9: within each value of alpha somebody switches or stays, then alpha changes.
    """
    values, modes = belief.shape
    for i in range(values):
        mass = 0.0
        away = 0.0
        for m in range(modes):
            mass += belief[i, m]
            away += r.rate[i, m] * perceived[m]
        # Rounding must not make it negative where a switch is certain.
        stay = max(1.0 - away, 0.0) if r.by_goal else 1.0 - r.rate[i, 0]
        for m in range(modes):
            out[i, m] = stay * belief[i, m] + r.rate[i, m] * perceived[m] * mass
    mix(r.mixing, out, scratch)


@bare
def predict_seen(
    r: RobotTables,
    window: int,
    action: int,
    human_action: int,
    belief: FloatArray,
    out: FloatArray,
    scratch: FloatArray,
) -> None:
    """As `predict` where modes are seen: alpha changes, and the window tells of the mode."""
    values, modes = belief.shape
    reached = r.following[window, action, human_action]
    for i in range(values):
        mass = 0.0
        for m in range(modes):
            mass += belief[i, m]
        for m in range(modes):
            out[i, m] = mass
    mix(r.mixing, out, scratch)
    for i in range(values):
        for m in range(modes):
            out[i, m] *= r.mode_chance[reached, i, m]


@bare
def mix(mixing: FloatArray, out: FloatArray, scratch: FloatArray) -> None:
    """Carry ``out`` ``[L, M]`` through ``T_alpha`` ``[L, L]``, in place; nothing if it is empty.

    ``scratch`` has room for ``L`` numbers.
    """
    if mixing.shape[0] == 0:
        return
    values, modes = out.shape
    for m in range(modes):
        for i in range(values):
            scratch[i] = out[i, m]
            out[i, m] = 0.0
        for i in range(values):
            for j in range(values):
                out[j, m] += scratch[i] * mixing[i, j]
