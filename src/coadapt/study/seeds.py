"""The random numbers of an attempt: the same whenever it is computed again."""

from __future__ import annotations

from hashlib import sha256

import numpy as np

from coadapt.study.session.plan import Stage


def attempt_rng(key: str, stage: Stage, attempt: int) -> np.random.Generator:
    """The generator of one attempt: it draws the start, then the outcomes of moves.

    Args:
        key: of the session.
        stage: which training session or trial.
        attempt: how often it has begun, from 1.
    """
    named = f"coadapt attempt\n{key}\n{stage.kind}\n{stage.number}\n{attempt}"
    return np.random.default_rng(int.from_bytes(sha256(named.encode()).digest()))
