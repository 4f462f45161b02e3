"""The randomness of an attempt: the same wherever and whenever it is asked for."""

from __future__ import annotations

from hashlib import sha256

import numpy as np

from coadapt.study.session.plan import Stage


def attempt_rng(key: str, stage: Stage, attempt: int) -> np.random.Generator:
    """The generator of attempt ``attempt`` at ``stage`` in the session ``key``."""
    digest = sha256(f"{key}/{stage}/{attempt}".encode()).digest()
    return np.random.default_rng(int.from_bytes(digest, "big"))
