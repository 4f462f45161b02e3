"""Sessions made without a server: a simulated participant who walks `advance` to the end."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import msgspec
import numpy as np

from coadapt.robots import Robot
from coadapt.simulation import SimulatedPartner
from coadapt.simulation.partners import acting
from coadapt.study.allocation import Allotted, allocate
from coadapt.study.protocol import Study, read_study
from coadapt.study.protocol.reader import FILE, template
from coadapt.study.record import SIMULATED, Record
from coadapt.study.robots import Robots, load_robots
from coadapt.study.seeds import attempt_rng
from coadapt.study.session import BEGINNING, Session, Stage, advance
from coadapt.study.session.events import (
    Allocated,
    Answer,
    Answered,
    Checked,
    Chose,
    Consented,
    Event,
    Noted,
    Opened,
    Pressed,
    Read,
)
from coadapt.study.session.machine import asked_questions, stage_of
from coadapt.study.store import Digest, Kept, Row
from coadapt.study.trial import Attempt, Practice
from tests.directories import shared_directory

NOON = 1_790_000_000.0
"""Seconds since 1970: when the first session begins."""


@cache
def small_study() -> tuple[Path, Study, Robots]:
    """The template with the small table, its robots planned once for all tests."""
    directory = shared_directory("coadapt-study-")
    text = template().decode().replace('"table_clearing"', '"table_clearing_small"')
    (directory / FILE).write_text(text, encoding="utf-8")
    study = read_study(directory)
    return directory, study, load_robots(study, directory)


class Driver:
    """Someone who goes through a session, event by event.

    Args:
        study, robots: what they take part in.
        key: of the session.
        seed: of everything they do.
        began: when they come, in seconds since 1970.
        allotted: the condition; by the rules for an only participant if None.
        alpha: how readily they change to what the robot seems to want.
        number: of the session.
    """

    def __init__(
        self,
        study: Study,
        robots: Robots,
        key: str,
        seed: int,
        *,
        began: float = NOON,
        allotted: str | None = None,
        alpha: float = 0.5,
        number: int = 1,
    ) -> None:
        self._study, self._robots, self._key = study, robots, key
        self._rng = np.random.default_rng(seed)
        self._time = began
        self._allotted = allotted
        self._alpha = alpha
        self._sequence, self._number = 0, number
        self.session: Session = BEGINNING
        self.events: list[Kept] = []

    @property
    def record(self) -> Record:
        """What is stored so far."""
        session = self.session
        digest = Digest(session.condition, session.choice, session.device, session.end)
        place = None if session.condition is None else self._number
        first, last = self.events[0].time, self.events[-1].time
        row = Row(self._number, self._key, first, None, place, digest, last)
        return Record(row, tuple(self.events))

    def record_event(self, *events: Event, after: float = 0.25) -> None:
        """Store events as the server does, ``after`` so many seconds."""
        self._time += after
        for event in events:
            self.session = advance(self._study, self.session, event)
            self.events.append(Kept(len(self.events) + 1, self._time, event))

    def open(self, parameters: dict[str, str] | None = None, *, simulated: bool = False) -> None:
        """Come by a link."""
        self.record_event(Opened(parameters=parameters or {}))
        if simulated:
            self.record_event(Noted(what=SIMULATED))

    def go(self, until: Stage | None = None) -> Record:
        """Go on until a stage begins, or to the end."""
        while (stage := stage_of(self._study, self.session)) not in (None, until):
            assert stage is not None
            self.pass_through(stage)
        return self.record

    def pass_through(self, stage: Stage) -> None:
        """Do what ``stage`` asks for."""
        match stage.kind:
            case "preflight":
                checked = Checked(
                    device="keyboard", width=1280, height=800, latency=0.03, browser="Test 1.0"
                )
                self.record_event(checked, after=3)
            case "consent":
                self.record_event(Consented(), after=5)
            case "choice":
                self.record_event(Chose(goal=int(self._rng.integers(2))), after=2)
                name = self._allotted or allocate(self._study, list[Allotted]())
                assert name is not None
                self.record_event(Allocated(condition=name))
            case "practice" | "trial":
                self.steer(stage)
            case "scale" | "questions":
                self.record_event(Answered(stage=stage, answers=self._answers(stage)), after=20)
            case _:
                self.record_event(Read(stage=stage), after=4)

    def steer(self, stage: Stage, stop_after: int | None = None) -> None:
        """Make an attempt, to its end or broken off after some steps."""
        number = self.session.attempt + 1
        attempt = self._attempt(stage, number)
        self.record_event(attempt.began)
        goal = self.session.choice
        mode = int(self._rng.integers(2)) if goal is None else goal
        model = self._robot.model
        partner = acting(SimulatedPartner(self._alpha, mode), model)
        person = partner.begin(model, attempt.state, None, self._rng)
        steps = 0
        while not attempt.done and steps != stop_after:
            given = partner.act(model, attempt.state, person, self._rng)
            self._sequence += 1
            pressed = Pressed(
                input=given, device="keyboard", sequence=self._sequence, page_time=self._time - NOON
            )
            self.record_event(pressed, after=0.1)
            stepped = attempt.step(given)
            self.record_event(stepped, after=0.15)
            if stepped.window is not None and stepped.action is not None:
                window, action = stepped.window, stepped.action
                person = partner.react(model, window, person, action, 0, self._rng)
            steps += 1
        if attempt.done:
            self.record_event(attempt.finished())

    @property
    def _robot(self) -> Robot:
        name = self.session.condition or self._study.conditions[0].name
        return self._robots[name, self.session.choice or 0]

    def _attempt(self, stage: Stage, number: int) -> Attempt | Practice:
        rng, most = attempt_rng(self._key, stage, number), self._study.clock.most_steps
        if stage.kind == "practice":
            return Practice(self._robot.model, stage, number, rng, most)
        carried = self._study.belief == "carried"
        belief = self.session.forecast if carried else None
        return Attempt(self._robot, stage, number, belief, rng, most)

    def _answers(self, stage: Stage) -> dict[str, Answer]:
        if stage.kind == "scale":
            scale = self._study.scales[stage.number - 1]
            return {i.name: int(self._rng.integers(1, 6)) for i in scale.items}
        answers: dict[str, Answer] = {}
        for question in asked_questions(self._study, self.session):
            answers[question.name] = 1 if question.choices else f'because of {question.name}, "so"'
        return answers


def session(key: str, seed: int, *, study: Study | None = None, **given: object) -> Record:
    """A whole session of the small study."""
    _, small, robots = small_study()
    driver = Driver(study or small, robots, key, seed, **given)  # type: ignore[arg-type]
    driver.open({"PROLIFIC_PID": f"person-{seed}"})
    return driver.go()


def changed_study(**changes: object) -> Study:
    """The small study with other values."""
    return msgspec.structs.replace(small_study()[1], **changes)


def sessions(n: int) -> Sequence[Record]:
    """``n`` whole sessions, one after the other, in turn in all conditions."""
    _, study, _ = small_study()
    names = [c.name for c in study.conditions]
    return [
        session(f"key-{i}", i, began=NOON + 600 * i, allotted=names[i % len(names)], number=i + 1)
        for i in range(n)
    ]


@cache
def allocated_sessions(n: int) -> Sequence[Record]:
    """``n`` whole sessions, one after the other, allocated by the rules."""
    study = small_study()[1]
    before: list[Allotted] = []
    records: list[Record] = []
    for i in range(n):
        condition = allocate(study, before)
        assert condition is not None
        began = NOON + 600 * i
        records.append(session(f"key-{i}", i, began=began, allotted=condition, number=i + 1))
        before.append(Allotted(condition, "completed"))
    return records
