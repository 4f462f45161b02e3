"""What is stored of each attempt at a training session or trial."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from coadapt.study.record import Moment
from coadapt.study.session.events import Began, Finished, Pressed, Stepped
from coadapt.study.session.plan import Stage
from coadapt.study.session.state import Session
from coadapt.study.store import Kept


@dataclass
class StoredStep:
    """A step: when it was decided, what came of it, and the input's arrival, if it had one."""

    time: float
    stepped: Stepped
    pressed: Kept | None


@dataclass
class StoredAttempt:
    """What happened from its beginning to its end, or to where it was broken off.

    Attributes:
        session: as it was when the attempt began.
        began_at: when, in seconds since 1970.
        began: the event.
        presses: the changes of input.
        steps: the steps.
        finished: the event, or None where it was broken off.
        finished_at: when.
    """

    session: Session
    began_at: float
    began: Began
    presses: list[Kept] = field(default_factory=list[Kept])
    steps: list[StoredStep] = field(default_factory=list[StoredStep])
    finished: Finished | None = None
    finished_at: float | None = None

    @property
    def stage(self) -> Stage:
        """Which training session or trial it is an attempt at."""
        return self.began.stage

    @property
    def last_state(self) -> int:
        """The robot state in the end."""
        return self.steps[-1].stepped.reached if self.steps else self.began.start

    def pressed(self, human_input: int | None) -> Kept | None:
        """The last change of input so far that was to ``human_input``; None if that is None."""
        if human_input is None:
            return None
        for kept in reversed(self.presses):
            if isinstance(kept.event, Pressed) and kept.event.input == human_input:
                return kept
        return None


def attempts_of(moments: Sequence[Moment]) -> list[StoredAttempt]:
    """All attempts of a session, in their order."""
    attempts: list[StoredAttempt] = []
    for kept, before, _ in moments:
        event, time = kept.event, kept.time
        match event:
            case Began():
                attempts.append(StoredAttempt(before, time, event))
            case Pressed() if attempts:
                attempts[-1].presses.append(kept)
            case Stepped():
                last = attempts[-1]
                last.steps.append(StoredStep(time, event, last.pressed(event.input)))
            case Finished():
                attempts[-1].finished = event
                attempts[-1].finished_at = time
            case _:
                pass
    return attempts
