"""Where a session stands."""

from __future__ import annotations

from typing import Literal

import msgspec

from coadapt.study.session.events import Answer, Belief, Device

End = Literal["finished", "declined", "withdrawn", "excluded"]
"""How a session can end; ``finished``: all questions are answered."""


class Result(msgspec.Struct, frozen=True):
    """What a trial came to.

    Attributes:
        goal: index of the goal reached, or None.
        wanted: index of the goal that the last telling input was for, or None.
        steps: number of the robot's decisions.
        attempts: how often it was begun.
    """

    goal: int | None
    wanted: int | None
    steps: int
    attempts: int


class Session(msgspec.Struct, frozen=True):
    """A session after some events.

    Attributes:
        opened: whether it has begun at all.
        position: of its stage in the plan.
        device: what the participant steers with, once it is known.
        choice: index of the goal chosen.
        condition: name of the condition allocated to.
        attempt: how often the training session or trial of this stage has begun.
        steps: steps of the attempt under way.
        running: whether one is under way.
        results: of the trials done.
        forecast: the robot's belief at the end of the last one.
        answers: by the names of items and questions.
        end: how it ended, or None.
        before: of an excluded session, how it had ended before.
    """

    opened: bool = False
    position: int = 0
    device: Device | None = None
    choice: int | None = None
    condition: str | None = None
    attempt: int = 0
    steps: int = 0
    running: bool = False
    results: tuple[Result, ...] = ()
    forecast: Belief | None = None
    answers: dict[str, Answer] = {}
    end: End | None = None
    before: End | None = None

    @property
    def changed(self) -> bool:
        """Whether the participant went for another goal than the chosen one in some trial."""
        return any(result.wanted not in (None, self.choice) for result in self.results)


BEGINNING = Session()
"""Before anything happened."""
