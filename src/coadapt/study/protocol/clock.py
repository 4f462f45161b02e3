"""When the robot decides."""

from __future__ import annotations

from typing import Literal

from coadapt.requirements import require
from coadapt.study.protocol.part import Part

SHORTEST_STEP, LONGEST_STEP = 0.05, 10.0
"""Seconds."""

MOST_STEPS = 10_000


class Clock(Part, frozen=True, kw_only=True):
    """The turn clock of trials and training sessions.

    Attributes:
        turns: ``"fixed"``: a decision every ``step`` seconds, from the first input on, with the
            input that is held then, or none; ``"wait"``: a decision at every input.
        step: seconds between decisions, and of one movement on the page.
        most_steps: a trial that reaches no goal ends after so many decisions.
    """

    turns: Literal["fixed", "wait"] = "fixed"
    step: float = 0.5
    most_steps: int = 200

    def __post_init__(self) -> None:
        wanted = f"from {SHORTEST_STEP:g} to {LONGEST_STEP:g} seconds"
        require(("step",), SHORTEST_STEP <= self.step <= LONGEST_STEP, wanted, self.step)
        wanted = f"from 1 to {MOST_STEPS:,}"
        require(("most_steps",), 1 <= self.most_steps <= MOST_STEPS, wanted, self.most_steps)
