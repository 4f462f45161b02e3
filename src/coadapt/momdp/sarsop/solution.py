"""What the solver returns: a policy, bounds that hold, and how they were come by."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from coadapt.arrays import FloatArray
from coadapt.momdp.policy import AlphaVectorPolicy


class Status(Enum):
    """Why the solver stopped: the gap is closed, or else what ended the search before that.

    ``PRECISION`` means that the bounds no longer move in floating-point numbers.
    """

    GAP = "gap"
    PRECISION = "precision"
    BACKUPS = "backups"
    MEMORY = "memory"
    TIME = "time"
    INTERRUPTED = "interrupted"


@dataclass(frozen=True)
class Record:
    """Where the solver stood after some work.

    Attributes:
        seconds: since the start of solving.
        backups: number of backups.
        lower, upper: bounds of the value, weighted by the probability of the roots.
        gap: largest difference of the bounds at any root.
        vectors: number of alpha vectors.
        memory: bytes of the arrays of the search.
    """

    seconds: float
    backups: int
    lower: float
    upper: float
    gap: float
    vectors: int
    memory: int


@dataclass(frozen=True)
class Solution:
    """A policy with certified bounds.

    Attributes:
        policy: its value at each root is at least ``root_lower``.
        root_lower, root_upper: ``[R]`` bounds of the optimal value at each root of the problem.
        lower, upper: the same weighted by the probability of the roots.
        status: why the solver stopped.
        trace: bounds over work; the last record is the end.
        backups: number of backups.
        vectors: number of alpha vectors of the policy.
        seconds: wall-clock time of solving.
    """

    policy: AlphaVectorPolicy
    root_lower: FloatArray
    root_upper: FloatArray
    lower: float
    upper: float
    status: Status
    trace: tuple[Record, ...]
    backups: int
    vectors: int
    seconds: float

    @property
    def gap(self) -> float:
        """Largest difference of the bounds at any root."""
        return float(np.max(self.root_upper - self.root_lower))
