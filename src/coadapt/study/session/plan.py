"""The stages that a session goes through, in their order."""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

import msgspec

from coadapt.study.protocol import Study

Kind = Literal[
    "welcome",
    "preflight",
    "consent",
    "instructions",
    "practice",
    "choice",
    "briefing",
    "trial",
    "scale",
    "questions",
    "debrief",
]

READ: frozenset[Kind] = frozenset({"welcome", "instructions", "briefing", "debrief"})
"""Pages that are only read."""

STEERED: frozenset[Kind] = frozenset({"practice", "trial"})
"""Stages in which the participant steers."""


class Stage(msgspec.Struct, frozen=True):
    """A stage of a session.

    Attributes:
        kind: what happens in it.
        number: which of several of its kind, from 1.
    """

    kind: Kind
    number: int = 1

    def __str__(self) -> str:
        return f"{self.kind} {self.number}"


def plan_of(study: Study) -> tuple[Stage, ...]:
    """All stages of ``study``. Some sessions pass over one, see `advance`."""
    return _plan(study.practice, study.trials, len(study.scales), bool(study.questions))


@lru_cache(maxsize=16)  # asked for at every event
def _plan(practice: int, trials: int, scales: int, questions: bool) -> tuple[Stage, ...]:
    stages = [Stage("welcome"), Stage("preflight"), Stage("consent"), Stage("instructions")]
    stages += [Stage("practice", i + 1) for i in range(practice)]
    stages += [Stage("choice"), Stage("briefing")]
    stages += [Stage("trial", i + 1) for i in range(trials)]
    stages += [Stage("scale", i + 1) for i in range(scales)]
    if questions:
        stages.append(Stage("questions"))
    stages.append(Stage("debrief"))
    return tuple(stages)
