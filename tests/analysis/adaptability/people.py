"""Recordings of people in a world small enough to enumerate, and evidence with known answers."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from scipy.special import xlog1py, xlogy

from coadapt.analysis.adaptability import Evidence, RecordedTrial, Recordings
from coadapt.analysis.adaptability.beta import GRID_POINTS, alpha_grid
from coadapt.robots import NO_INPUT
from tests.robots.worlds import DOWN, UP, B, C

steps = st.tuples(
    st.sampled_from((B, C)), st.sampled_from((DOWN, UP, NO_INPUT)), st.sampled_from((DOWN, UP))
)
trials = st.lists(steps, min_size=1, max_size=4)
participants = st.lists(st.lists(trials, min_size=1, max_size=2), min_size=1, max_size=2)


def recorded(trial: list[tuple[int, int, int]]) -> RecordedTrial:
    """A trial of (state, input, action)."""
    state, human_input, action = zip(*trial, strict=True)
    return RecordedTrial(state, human_input, action)


def recordings_of(people: list[list[list[tuple[int, int, int]]]]) -> Recordings:
    """Participants "0", "1", ... with their trials."""
    return Recordings.of({str(p): [recorded(t) for t in them] for p, them in enumerate(people)})


def binomial_evidence(yes: list[int], asked: int, points: int = GRID_POINTS) -> Evidence:
    """People who each adapted on some of ``asked`` occasions: ``alpha^k (1 - alpha)^(d - k)``."""
    alpha = alpha_grid(points)
    k = np.array(yes)[:, None]
    return Evidence(xlogy(k, alpha) + xlog1py(asked - k, -alpha))
