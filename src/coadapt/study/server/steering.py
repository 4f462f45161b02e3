"""A participant steers: letters of the page and turns of the clock in, stored events out."""

from __future__ import annotations

import asyncio
import math
from collections import deque
from collections.abc import Callable, Coroutine, Sequence
from typing import NamedTuple

from coadapt.study.robots import model_of
from coadapt.study.seeds import attempt_rng
from coadapt.study.server.messages import (
    Begun,
    FromServer,
    Input,
    Note,
    Over,
    Ready,
    Step,
    Stored,
)
from coadapt.study.server.service import Service
from coadapt.study.session import Event, NotNow, Session, Stage, plan_of
from coadapt.study.session.events import Noted, Pressed
from coadapt.study.session.plan import STEERED
from coadapt.study.trial import Attempt, Practice

Send = Callable[[FromServer], None]

LARGEST_COUNT = 2**53
"""Of messages: what a page counts exactly."""

LONGEST_TIME = 1e12
"""Seconds of a page's clock."""

TRIES = 10
"""Another process may begin an attempt at the same moment."""


class Turn(NamedTuple):
    """The clock strikes, at this time in seconds of the event loop."""

    time: float


class End(NamedTuple):
    """Nothing is to be dealt with any more; ``reason`` is for the page if it is there."""

    reason: str | None = None


Letter = Ready | Input | Note | Turn | End


class Steering:
    """The attempts that are made over one connection.

    Letters of the page and turns of the clock are dealt with one after the other, each stored
    before the next: what is stored is what happened, in this order. No task is needed for that
    while somebody steers.

    Args:
        service: the study.
        key: of the session.
        send: sends a message to the page.

    Attributes:
        ended: done after an `End`, with its reason, or after an error: NotNow if something does not
            fit; KeyError and StoreError as of `Service.record`.
    """

    def __init__(self, service: Service, key: str, send: Send) -> None:
        self._service = service
        self._key = key
        self._send = send
        self._loop = asyncio.get_running_loop()
        self.ended: asyncio.Future[str | None] = self._loop.create_future()
        self._letters: deque[Letter] = deque()
        self._task: asyncio.Task[None] | None = None
        self._busy = False  # until something is stored, or the task is done
        self._scene: Stage | None = None
        self._attempt: Attempt | Practice | None = None
        self._where = (0, 0)
        self._held: int | None = None
        self._clock: asyncio.TimerHandle | None = None
        self._next: Turn | None = None
        self._inputs = len(model_of(service.robots).input_names)
        self._spend(self._look())

    @property
    def unread(self) -> int:
        """How many letters wait."""
        return len(self._letters)

    def put(self, letter: Letter) -> None:
        """Deal with ``letter`` once all before it is done."""
        self._letters.append(letter)
        if not self._busy:
            self._go()

    def close(self) -> None:
        """Deal with nothing any more."""
        self._stop_clock()
        if self._task is not None:
            self._task.cancel()
        if not self.ended.done():
            self.ended.set_result(None)

    # One after the other

    def _go(self) -> None:
        """Deal with letters until there is something to wait for."""
        try:
            while self._letters and not self._busy and not self.ended.done():
                self._deal(self._letters.popleft())
        except Exception as error:
            self._fail(error)

    def _deal(self, letter: Letter) -> None:
        match letter:
            case Input():
                self._press(letter)
            case Turn():
                self._turn(letter)
            case Ready():
                self._spend(self._begin())
            case Note():
                self._spend(self._note(letter))
            case End():
                self.ended.set_result(letter.reason)

    def _store(self, events: Sequence[Event], then: Callable[[], None]) -> None:
        """Store ``events`` of the attempt under way, and ``then`` go on."""

        def told(error: Exception | None) -> None:
            if self.ended.done():
                return
            if error is not None:
                self._fail(error)
                return
            self._busy = False
            try:
                then()
            except Exception as wrong:
                self._fail(wrong)
            else:
                self._go()

        self._busy = True
        self._service.post(self._key, events, self._where, told)

    def _spend(self, work: Coroutine[None, None, None]) -> None:
        """Do ``work``, which takes a task, and then go on."""

        def done(task: asyncio.Task[None]) -> None:
            self._task = None
            if task.cancelled():
                return
            error = task.exception()
            if error is not None:
                self._fail(error)
                return
            self._busy = False
            self._go()

        self._busy = True
        self._task = self._loop.create_task(work)
        self._task.add_done_callback(done)

    def _fail(self, error: BaseException) -> None:
        if not self.ended.done():
            self.ended.set_exception(error)

    # What is done

    async def _look(self) -> None:
        """Send the scene of the stage, if there is something to steer."""
        session = await self._service.session(self._key)
        if session.end is None:
            self._show(plan_of(self._service.study)[session.position])

    async def _note(self, note: Note) -> None:
        noted = Noted(what=note.what, value=note.value, text=note.text)
        await self._service.record(self._key, noted)

    async def _begin(self) -> None:
        """A new attempt, from its start, whatever was under way."""
        self._stop()
        if await self._service.status() == "paused":
            raise NotNow("the study is paused")
        study = self._service.study
        session = await self._service.known_session(self._key)
        for i in range(TRIES):
            if i > 0:
                session = await self._service.session(self._key)
            stage = plan_of(study)[session.position]
            if session.end is not None or stage.kind not in STEERED:
                if i == 0:
                    continue
                raise NotNow(f"there is nothing to steer in stage {stage}")
            attempt = new_attempt(self._service, self._key, session, stage)
            before = (session.position, session.attempt)
            try:
                session = await self._service.record(self._key, attempt.began, attempt=before)
                break
            except NotNow:
                continue
        else:
            raise NotNow("the session is steered from somewhere else")
        self._attempt, self._where = attempt, (session.position, session.attempt)
        self._show(stage)
        self._send(Begun(attempt=session.attempt, state=attempt.state))

    def _press(self, message: Input) -> None:
        """The input changed."""
        require_input(message, self._inputs)
        if self._attempt is None:
            return  # It was on its way when the attempt ended, and is no part of anything.
        pressed = Pressed(
            input=message.input,
            device=message.device,
            sequence=message.sequence,
            page_time=message.page_time,
            device_time=message.device_time,
        )

        def then() -> None:
            self._held = message.input
            self._send(Stored(sequence=message.sequence))
            if message.input is None:
                return
            if self._service.study.clock.turns == "wait":
                self._step()
            elif self._next is None:
                self._wind(self._loop.time())

        self._store((pressed,), then)

    def _turn(self, turn: Turn) -> None:
        """The clock struck: a step with the input that is held."""
        if turn is not self._next:  # of an attempt that has ended meanwhile
            return
        step = self._service.study.clock.step
        behind = self._loop.time() - turn.time
        # Turns that were missed are left out, not made up for.
        self._wind(turn.time + step * (1 + max(0, math.floor(behind / step))))
        self._step()

    def _step(self) -> None:
        attempt = self._attempt
        assert attempt is not None
        step = attempt.step(self._held)
        finished = attempt.finished() if attempt.done else None

        def then() -> None:
            self._send(
                Step(step=step.step, state=step.state, reached=step.reached, input=step.input)
            )
            if finished is not None:
                self._stop()
                self._send(Over(goal=finished.goal))

        self._store((step,) if finished is None else (step, finished), then)

    def _show(self, stage: Stage) -> None:
        if stage.kind in STEERED and stage != self._scene:
            self._scene = stage
            self._send(self._service.scene(stage))

    def _wind(self, time: float) -> None:
        """Let the clock strike then."""
        self._next = Turn(time)
        self._clock = self._loop.call_at(time, self.put, self._next)

    def _stop_clock(self) -> None:
        if self._clock is not None:
            self._clock.cancel()
        self._clock = self._next = None

    def _stop(self) -> None:
        """Nothing is under way any more."""
        self._stop_clock()
        self._attempt = self._held = None


def new_attempt(service: Service, key: str, session: Session, stage: Stage) -> Attempt | Practice:
    """The next attempt of ``session`` at ``stage``."""
    study, number = service.study, session.attempt + 1
    rng = attempt_rng(key, stage, number)
    if stage.kind == "practice":
        model = model_of(service.robots)
        return Practice(model, stage, number, rng, study.clock.most_steps)
    assert session.condition is not None and session.choice is not None
    robot = service.robots[session.condition, session.choice]
    carried = session.forecast if study.belief == "carried" else None
    return Attempt(robot, stage, number, carried, rng, study.clock.most_steps)


def require_input(message: Input, inputs: int) -> None:
    """Raise NotNow unless the numbers of ``message`` are in range."""
    times = [t for t in (message.page_time, message.device_time) if t is not None]
    if message.input is not None and not 0 <= message.input < inputs:
        raise NotNow(f"input {message.input} is not one of 0 to {inputs - 1}")
    if not 0 <= message.sequence < LARGEST_COUNT or any(abs(t) > LONGEST_TIME for t in times):
        raise NotNow("a number of the message is out of range")
