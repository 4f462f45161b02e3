"""Services of a small study, and sessions that get to a stage without a server."""

from __future__ import annotations

from collections.abc import AsyncGenerator
from contextlib import asynccontextmanager

import msgspec

from coadapt.study.protocol import Study
from coadapt.study.server.service import Service
from coadapt.study.server.steering import new_attempt
from coadapt.study.session import Session, Stage
from coadapt.study.session.events import Checked, Chose, Consented, Finished, Read
from coadapt.study.session.machine import stage_of
from coadapt.study.store import Store
from tests.study.sessions import small_study


def study_with(**changes: object) -> Study:
    """The small study with other values; the robot moves at every input."""
    study = small_study()[1]
    clock = msgspec.structs.replace(study.clock, turns="wait", step=0.05)
    # What is tested of the data is named after conditions, which may change.
    return msgspec.structs.replace(study, **{"clock": clock, "hypotheses": (), **changes})


@asynccontextmanager
async def serving(url: str, study: Study | None = None) -> AsyncGenerator[Service]:
    """A service of the small study, as one process of several."""
    directory, _, robots = small_study()
    store = Store(url)
    service = Service(study or study_with(), robots, store, directory)
    try:
        yield service
    finally:
        await service.close()
        store.close()


async def bring(service: Service, key: str, until: Stage, goal: int = 0) -> Session:
    """Bring a session to the stage ``until`` by plain answers; trials end without a step."""
    session = await service.session(key)
    while (stage := stage_of(service.study, session)) != until:
        assert stage is not None, f"the session has ended before {until}"
        match stage.kind:
            case "preflight":
                event = Checked(device="gamepad", width=800, height=600, latency=0.02, browser="B")
            case "consent":
                event = Consented()
            case "choice":
                await service.record(key, Chose(goal=goal))
                session = await service.allocate(key)
                assert session.condition is not None, "the study is full"
                continue
            case "practice" | "trial":
                began = new_attempt(service, key, session, stage).began
                session = await service.record(key, began, Finished(stage=stage, goal=0))
                continue
            case _:
                event = Read(stage=stage)
        session = await service.record(key, event)
    return session
