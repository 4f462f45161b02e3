"""What participants did, as plain records: all that a fit needs of a log or a study."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from coadapt.arrays import IntArray
from coadapt.simulation import Episode


@dataclass(frozen=True)
class RecordedTrial:
    """One trial of one participant, step by step.

    Attributes:
        state: ``[S]`` the robot state in which each input was given.
        human_input: ``[S]`` the inputs, `coadapt.robots.NO_INPUT` where there was none.
        action: ``[S]`` what the robot then did.
    """

    state: Sequence[int] | IntArray
    human_input: Sequence[int] | IntArray
    action: Sequence[int] | IntArray


@dataclass(frozen=True, eq=False)
class Recordings:
    """The steps of all participants, one after the other.

    Attributes:
        names: ``P`` names of the participants.
        first_trial: ``[P + 1]`` where the trials of each begin; the last entry is their number
            ``T``.
        first_step: ``[T + 1]`` where the steps of each trial begin; the last entry is their number
            ``S``.
        state, human_input, action: ``[S]`` as in `RecordedTrial`.
    """

    names: tuple[str, ...]
    first_trial: IntArray
    first_step: IntArray
    state: IntArray
    human_input: IntArray
    action: IntArray

    def __len__(self) -> int:
        """Number of participants ``P``."""
        return len(self.names)

    @property
    def steps(self) -> IntArray:
        """``[P]`` number of steps of each participant."""
        return np.diff(self.first_step[self.first_trial])

    @property
    def trials(self) -> IntArray:
        """``[P]`` number of trials of each participant."""
        return np.diff(self.first_trial)

    @classmethod
    def of(cls, participants: Mapping[str, Sequence[RecordedTrial]]) -> Self:
        """The recordings of participants with their trials in order.

        Raises:
            ValueError: if the parts of a trial do not have the same length.
        """
        trials = [trial for theirs in participants.values() for trial in theirs]
        for trial in trials:
            if not len(trial.state) == len(trial.human_input) == len(trial.action):
                raise ValueError("a trial needs as many states as inputs and actions")
        return cls(
            names=tuple(participants),
            first_trial=starts_of(len(theirs) for theirs in participants.values()),
            first_step=starts_of(len(trial.state) for trial in trials),
            state=_joined(trial.state for trial in trials),
            human_input=_joined(trial.human_input for trial in trials),
            action=_joined(trial.action for trial in trials),
        )

    @classmethod
    def from_episodes(cls, participants: Mapping[str, Sequence[Episode]]) -> Self:
        """The recordings of simulated participants, each with one episode a trial."""
        return cls.of(
            {name: [_recorded(e) for e in episodes] for name, episodes in participants.items()}
        )


def _recorded(episode: Episode) -> RecordedTrial:
    inputs = [-1 if i is None else i for i in episode.inputs]
    return RecordedTrial(episode.states[:-1], inputs, episode.actions)


def starts_of(lengths: Iterable[int]) -> IntArray:
    """Where each part begins if parts of ``lengths`` follow each other, and where the last ends."""
    return np.concatenate(([0], np.cumsum(np.fromiter(lengths, dtype=np.int64))))


def _joined(parts: Iterable[Sequence[int] | IntArray]) -> IntArray:
    arrays = [np.asarray(part, dtype=np.int64) for part in parts]
    return np.concatenate(arrays) if arrays else np.empty(0, dtype=np.int64)
