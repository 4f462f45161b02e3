"""The filter over adaptability and mode (Eq. 5 and 9), in the order of one time step.

The joint belief ``b(alpha, m)`` is an array ``[A, M]``; leading axes hold several beliefs. At each
step the person's input corrects it; the robot's action, as the person perceives it, predicts it
into the next step.
"""

from __future__ import annotations

import numpy as np

from coadapt.arrays import FloatArray


def correct(belief: FloatArray, likelihood: FloatArray) -> FloatArray:
    """Condition on an input: ``b(alpha, m) <- eta O(a_h | m, x) b(alpha, m)``.

    Args:
        belief: ``[..., A, M]``.
        likelihood: ``[..., M]`` probability ``O(a_h | m, x)`` of the input under every mode.

    Returns:
        ``[..., A, M]``. An input that no mode in the belief explains says nothing about them: the
        belief is returned as it was.
    """
    mass = belief * likelihood[..., None, :]
    total = mass.sum(axis=(-2, -1), keepdims=True)
    return np.divide(mass, total, out=belief.copy(), where=total > 0)


def predict(
    belief: FloatArray, alpha: FloatArray, perceived: FloatArray, transition: FloatArray | None
) -> FloatArray:
    """Carry the belief through ``T_mh`` and ``T_alpha`` (the sums of Eq. 9).

    ``T_mh`` of Eq. 3-4 is, for each ``alpha``, the identity with weight ``1 - alpha`` plus a jump
    to the perceived robot mode with weight ``alpha``, so the sum over ``m`` needs no matrix. Where
    ``alpha`` is ``[A, M]`` the jump to ``m'`` has weight ``alpha[m'] * perceived[m']``.

    Args:
        belief: ``[..., A, M]``.
        alpha: adaptability, ``[A]``, or ``[A, M]`` by goal.
        perceived: ``[..., M]`` the person's distribution over robot modes, Eq. 2.
        transition: ``[A, A]`` ``T_alpha``, or None for the identity.

    Returns:
        ``[..., A, M]``.
    """
    if alpha.ndim == 1:
        stay = (1.0 - alpha)[:, None]
        switch = alpha[:, None] * perceived[..., None, :]
    else:
        switch = alpha * perceived[..., None, :]
        # Rounding must not make it negative where a switch is certain.
        stay = np.maximum(1.0 - switch.sum(axis=-1, keepdims=True), 0.0)
    moved = stay * belief + switch * belief.sum(axis=-1, keepdims=True)
    return moved if transition is None else np.einsum("ij,...im->...jm", transition, moved)
