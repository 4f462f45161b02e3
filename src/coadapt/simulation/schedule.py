"""Which trials a person does, and what lasts from one to the next."""

from __future__ import annotations

from dataclasses import dataclass

MAX_STEPS = 1000
"""An episode that reaches no goal ends here."""


@dataclass(frozen=True)
class Schedule:
    """The trials of one person.

    Attributes:
        trials: how many they do in a row, at least 1.
        carry_belief: whether the robot's belief at the end of a trial is what it begins the next
            one with; otherwise it begins each with its prior.
        keep_mode: whether the person begins a trial in the mode in which the last one ended, as
            somebody does who has learned which goal to head for; otherwise they choose anew, and
            of a belief that is carried over only the part about adaptability is.
        max_steps: number of robot actions after which a trial is given up, at least 1.

    Raises:
        ValueError: if a number is out of its range.
    """

    trials: int = 1
    carry_belief: bool = True
    keep_mode: bool = True
    max_steps: int = MAX_STEPS

    def __post_init__(self) -> None:
        for name, number in (("trials", self.trials), ("max_steps", self.max_steps)):
            if number < 1:
                raise ValueError(f"{name} must be at least 1, not {number}")
