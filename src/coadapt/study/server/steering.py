"""A participant steers: messages of the page and turns of the clock in, stored events out."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Callable

from coadapt.formalism import SharedAutonomy
from coadapt.study.robots import Robots
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
from coadapt.study.server.scene import scene_of
from coadapt.study.server.service import Service
from coadapt.study.session import NotNow, Session, Stage, plan_of
from coadapt.study.session.events import Noted, Pressed, Stepped
from coadapt.study.session.plan import STEERED
from coadapt.study.trial import Attempt, Practice

Send = Callable[[FromServer], Awaitable[None]]

LARGEST_COUNT = 2**53
"""Of messages: what a page counts exactly."""

LONGEST_TIME = 1e12
"""Seconds of a page's clock."""

TRIES = 10
"""Another process may begin an attempt at the same moment."""


class Steering:
    """The attempts that are made over one connection.

    Args:
        service: the study.
        key: of the session.
        send: sends a message to the page.
    """

    def __init__(self, service: Service, key: str, send: Send) -> None:
        self._service = service
        self._key = key
        self._send = send
        self._scene: Stage | None = None
        self._attempt: Attempt | Practice | None = None
        self._where = (0, 0)
        self._held: int | None = None
        self._strikes: float | None = None
        self._inputs = len(model_of(service.robots).input_names)

    @property
    def next_turn(self) -> float | None:
        """When the clock strikes, in seconds of the event loop; None if it does not run."""
        return self._strikes

    async def show(self) -> None:
        """Send the scene of the stage, if there is something to steer."""
        session = await self._service.session(self._key)
        if session.end is None:
            await self._show(plan_of(self._service.study)[session.position])

    async def take(self, message: Ready | Input | Note) -> None:
        """Do what a message of the page asks for.

        Raises:
            NotNow: if it does not fit; nothing is stored.
            KeyError, StoreError: as `Service.record`.
        """
        match message:
            case Ready():
                await self._begin()
            case Input():
                await self._press(message)
            case Note():
                noted = Noted(what=message.what, value=message.value, text=message.text)
                await self._service.record(self._key, noted)

    async def turn(self) -> None:
        """The clock strikes: a step with the input that is held; raises as `take`."""
        if self._strikes is None:
            return
        step = self._service.study.clock.step
        behind = asyncio.get_running_loop().time() - self._strikes
        # Turns that were missed are left out, not made up for.
        self._strikes += step * (1 + max(0, math.floor(behind / step)))
        await self._step()

    async def _begin(self) -> None:
        """A new attempt, from its start, whatever was under way."""
        self._end()
        if await self._service.status() == "paused":
            raise NotNow("the study is paused")
        study = self._service.study
        for _ in range(TRIES):
            session = await self._service.session(self._key)
            stage = plan_of(study)[session.position]
            if session.end is not None or stage.kind not in STEERED:
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
        await self._show(stage)
        await self._send(Begun(attempt=session.attempt, state=attempt.state))

    async def _press(self, message: Input) -> None:
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
        await self._service.record(self._key, pressed, attempt=self._where)
        self._held = message.input
        await self._send(Stored(sequence=message.sequence))
        if message.input is None:
            return
        if self._service.study.clock.turns == "wait":
            await self._step()
        elif self._strikes is None:
            self._strikes = asyncio.get_running_loop().time()

    async def _step(self) -> None:
        attempt = self._attempt
        assert attempt is not None
        step: Stepped = attempt.step(self._held)
        if attempt.done:
            finished = attempt.finished()
            await self._service.record(self._key, step, finished, attempt=self._where)
            self._end()
        else:
            finished = None
            await self._service.record(self._key, step, attempt=self._where)
        await self._send(
            Step(step=step.step, state=step.state, reached=step.reached, input=step.input)
        )
        if finished is not None:
            await self._send(Over(goal=finished.goal))

    async def _show(self, stage: Stage) -> None:
        if stage.kind in STEERED and stage != self._scene:
            self._scene = stage
            service = self._service
            await self._send(scene_of(service.study, model_of(service.robots), stage))

    def _end(self) -> None:
        self._attempt = self._held = self._strikes = None


def model_of(robots: Robots) -> SharedAutonomy:
    """World and inputs, which all robots of a study have in common."""
    return next(iter(robots.values())).model


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
