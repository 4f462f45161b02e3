"""A person as arrays: the one description from which episodes are drawn.

A person has a *mode*, the goal they head for, and a *kind*, which says how adaptable they are and
how they use their inputs. Both may change at every step. In one time step

1. the person gives an input, drawn from ``inputs`` for the state, their mode and their kind;
2. the robot acts, and the world moves;
3. they perceive the robot in mode ``m_r`` with the probability in ``perceived``, by what they
   remember, and answer it with the probability ``rate`` of their kind: the new mode is drawn from
   ``answer[m_r]``. Somebody who follows the adaptation model switches to ``m_r`` itself (Eq. 3-4).
   Who does not answer keeps their mode;
4. for reasons of their own the mode changes by ``wander``;
5. their kind changes by ``change``;
6. what they remember slides on by ``next``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.formalism import Collaboration, Model
from coadapt.human.adaptation import require_distribution

NOTHING_KEPT = np.zeros((0, 0, 0, 0))
"""Who does not answer stays in the mode they had."""


class PartnerTables(NamedTuple):
    """A person. Sizes: M modes, K kinds, L ways to use the inputs, X states, V windows of the
    person, A robot actions, N outcomes of each, I inputs."""

    first_mode: FloatArray  # [M] chance of each mode at the start
    first_kind: FloatArray  # [K] chance of each kind at the start
    inputs: FloatArray  # [L, X, M, I + 1] chance of each input; the last one is that of none
    uses: IntArray  # [K] which of the L tables each kind goes by
    rate: FloatArray  # [K, M] chance that who perceives a mode answers it
    answer: FloatArray  # [M, M] chance of each new mode, given the mode that is answered
    wander: FloatArray  # [M, M] chance of each mode after a step, given the one before
    change: FloatArray  # [K, K] chance of each kind after a step, given the one before
    perceived: FloatArray  # [V, A, M] chance that the robot is seen in each mode (Eq. 2)
    kept: FloatArray  # [V, A, M, M] the mode of who does not answer; [0, 0, 0, 0]: the one they had
    beginning: IntArray  # [X] the window without a past in each state
    next: IntArray  # [V, A, N] the window after each action and outcome

    def checked(self, model: Model) -> PartnerTables:
        """The same, with arrays as compiled code needs them.

        Raises:
            ValueError: if they do not fit each other or ``model``.
        """
        world = model.world
        modes, kinds, ways = len(world.goals), len(self.rate), len(self.inputs)
        windows, actions, outcomes = len(self.perceived), world.actions, model.windows.next.shape[2]
        inputs = (ways, world.states, modes, len(model.input_names) + 1)
        kept = (windows, actions, modes, modes) if len(self.kept) else (0, 0, 0, 0)
        if not (self.rate.shape == (kinds, modes) and np.all(abs(self.rate - 0.5) <= 0.5)):
            raise ValueError(f"rate of the partner must lie in [0, 1] with shape {(kinds, modes)}")
        return PartnerTables(
            first_mode=_distributions("first_mode", self.first_mode, (modes,)),
            first_kind=_distributions("first_kind", self.first_kind, (kinds,)),
            inputs=_distributions("inputs", self.inputs, inputs),
            uses=_indices("uses", self.uses, (kinds,), ways),
            rate=_floats(self.rate),
            answer=_distributions("answer", self.answer, (modes, modes)),
            wander=_distributions("wander", self.wander, (modes, modes)),
            change=_distributions("change", self.change, (kinds, kinds)),
            perceived=_distributions("perceived", self.perceived, (windows, actions, modes)),
            kept=_distributions("kept", self.kept, kept),
            beginning=_indices("beginning", self.beginning, (world.states,), windows),
            next=_indices("next", self.next, (windows, actions, outcomes), windows),
        )


def _floats(values: FloatArray) -> FloatArray:
    return np.array(values, dtype=np.float64, order="C")


def _distributions(name: str, rows: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    require_distribution(f"{name} of the partner", rows, shape)
    return _floats(rows)


def _indices(name: str, values: IntArray, shape: tuple[int, ...], count: int) -> IntArray:
    if values.shape != shape or np.any(values >= count):
        raise ValueError(f"{name} of the partner must be indices below {count} of shape {shape}")
    return np.array(values, dtype=np.int64, order="C")


def follower(
    model: Model,
    rate: FloatArray,
    first_mode: FloatArray,
    first_kind: FloatArray | None = None,
    change: FloatArray | None = None,
) -> PartnerTables:
    """A person who follows the adaptation model (Sec. 2.1 and 3).

    Args:
        model: the robot's model, which holds in all else.
        rate: ``[K, M]`` adaptability of each kind towards each mode.
        first_mode: ``[M]``.
        first_kind: ``[K]``; the first kind if None.
        change: ``[K, K]``, a drift of adaptability; nobody changes if None.
    """
    kinds, modes = rate.shape
    tables = PartnerTables(
        first_mode=first_mode,
        first_kind=np.eye(kinds)[0] if first_kind is None else first_kind,
        inputs=inputs_of(model)[None],
        uses=np.zeros(kinds, dtype=np.int64),
        rate=rate,
        answer=np.eye(modes),
        wander=np.eye(modes),
        change=np.eye(kinds) if change is None else change,
        perceived=model.perceived,
        kept=NOTHING_KEPT,
        beginning=model.windows.beginning,
        next=model.windows.next,
    )
    return remembering(tables, model)


def inputs_of(model: Model) -> FloatArray:
    """``[X, M, I + 1]`` chance of each input in each mode, the last one that of none."""
    likelihood = np.swapaxes(model.input_likelihood, 1, 2)
    if likelihood.shape[2] > len(model.input_names):
        return np.array(likelihood, order="C")
    return np.concatenate([likelihood, np.zeros((*likelihood.shape[:2], 1))], axis=2)


def remembering(tables: PartnerTables, model: Model) -> PartnerTables:
    """``tables`` of somebody who remembers as ``model`` says."""
    windows = model.windows
    kept = NOTHING_KEPT
    if isinstance(model, Collaboration) and not model.hidden_modes:
        window, action = np.indices((len(windows), model.world.actions))
        kept = model.kept_modes(window, action)
        kept[model.world.ends[windows.state]] = np.eye(len(model.world.goals))  # nothing follows
    return tables._replace(
        perceived=model.perceived, kept=kept, beginning=windows.beginning, next=windows.next
    )


def first_modes(model: Model, mode: int | None) -> FloatArray:
    """``[M]`` distribution of the first mode: the given one, or the model's prior if None.

    Raises:
        ValueError: if the model has no such mode.
    """
    modes = len(model.world.goals)
    if mode is None:
        return model.prior.sum(axis=0)
    if not 0 <= mode < modes:
        raise ValueError(f"mode {mode} is not one of 0 to {modes - 1}")
    return np.eye(modes)[mode]
