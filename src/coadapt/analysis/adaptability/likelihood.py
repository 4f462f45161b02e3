"""How likely a participant's inputs are for each value of their adaptability.

The person is a hidden Markov model: in mode ``m`` they give an input by the human half of the modal
policy, then their mode changes by what they perceive of the robot's action (Eq. 3-4). The actions
themselves say nothing more of the person, since the robot knows of them only what the recording
holds too. So for a fixed alpha

    P(inputs | alpha) = sum over modes  P(m^0) prod_t O(a_h^t | m^t, x^t) T_mh(m^t, m^{t+1}; alpha),

a polynomial in alpha. Alpha is taken to stay the same throughout a participant's trials.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from coadapt.analysis.adaptability.recordings import Recordings
from coadapt.analysis.kernels.adaptability import Steps, log_likelihood
from coadapt.arrays import FloatArray, IntArray
from coadapt.formalism import SharedAutonomy
from coadapt.human.remembered import locate
from coadapt.robots import NO_INPUT


@dataclass(frozen=True)
class PersonModel:
    """What a fit takes a person for, beside their adaptability.

    Attributes:
        model: world, modes, memory and inputs.
        mode_lasts: whether the mode lasts from one trial to the next; else a person begins every
            trial with a mode drawn from the model's prior.
        first_mode: index of the mode in which they are known to begin, or None for the model's
            prior.
        lapse: probability of an input at random, all alike, in [0, 1): hands slip.

    Raises:
        ValueError: if a number is out of its range.
    """

    model: SharedAutonomy
    mode_lasts: bool = False
    first_mode: int | None = None
    lapse: float = 0.0

    def __post_init__(self) -> None:
        if not 0 <= self.lapse < 1:
            raise ValueError(f"the lapse rate must lie in [0, 1), not {self.lapse}")
        modes = len(self.model.mode_names)
        if self.first_mode is not None and not 0 <= self.first_mode < modes:
            raise ValueError(f"mode {self.first_mode} is not one of 0 to {modes - 1}")

    @property
    def prior(self) -> FloatArray:
        """``[M]`` distribution of the first mode."""
        if self.first_mode is None:
            return self.model.prior.sum(axis=0)
        return np.eye(len(self.model.mode_names))[self.first_mode]

    def steps(self, recordings: Recordings) -> Steps:
        """What the likelihood depends on, step by step."""
        window = windows_of(self.model, recordings)
        return Steps(
            first_trial=recordings.first_trial,
            first_step=recordings.first_step,
            emission=self._emission(recordings),
            perceived=self.model.perceived[window, recordings.action],
            prior=self.prior,
            is_kept=self.mode_lasts,
        )

    @cached_property
    def input_chances(self) -> FloatArray:
        """``[X, O, M]`` the model's ``O(a_h | m, x)`` with lapses, `coadapt.human.inputs`."""
        chance = self.model.input_likelihood
        if self.lapse == 0:
            return chance
        inputs, silence = len(self.model.input_names), self.model.interface.silence
        at_random = np.full((chance.shape[1], 1), (1.0 - silence) / inputs)
        at_random[inputs:] = silence
        return (1.0 - self.lapse) * chance + self.lapse * at_random

    def _emission(self, recordings: Recordings) -> FloatArray:
        """``[S, M]`` probability of the input in each mode; 1 where none could be given."""
        chance = self.input_chances[recordings.state, recordings.human_input]
        if self.model.interface.silence > 0:
            return chance
        return np.where((recordings.human_input != NO_INPUT)[:, None], chance, 1.0)


def log_likelihoods(person: PersonModel, recordings: Recordings, alpha: FloatArray) -> FloatArray:
    """``[P, J]`` log likelihood (nats) of each participant's inputs at each alpha of ``[J]``."""
    out = np.empty((len(recordings), len(alpha)))
    log_likelihood(person.steps(recordings), np.asarray(alpha, dtype=np.float64), out)
    return out


def windows_of(model: SharedAutonomy, recordings: Recordings) -> IntArray:
    """``[S]`` what the person remembered at each step, indices in ``model.windows``.

    Raises:
        ValueError: if a state does not follow from the step before and its past is not known.
    """
    windows = model.windows
    if windows.memory == 1:
        return recordings.state
    found = np.empty(len(recordings.state), dtype=np.int64)
    for first, last in zip(recordings.first_step[:-1], recordings.first_step[1:], strict=True):
        expected = None
        for s in range(first, last):
            found[s] = locate(windows, expected, int(recordings.state[s]))
            expected = windows.next[found[s], recordings.action[s]]
    return found
