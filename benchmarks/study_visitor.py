"""A participant who keeps a list of what the server acknowledged, and comes back after every loss.

For benchmarks and tests that end servers: the list is compared with what is stored in the end.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import httpx2
import msgspec
import numpy as np
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import WebSocketException

from coadapt.study.pilot.page import Form, Page, read_page
from coadapt.study.protocol import Study
from coadapt.study.server.messages import (
    Begun,
    FromPage,
    FromServer,
    Input,
    Over,
    Ready,
    Refused,
    Scene,
    Step,
    Stored,
)
from coadapt.study.session import Stage
from coadapt.study.session.events import (
    Answered,
    Began,
    Checked,
    Chose,
    Consented,
    Finished,
    Opened,
    Pressed,
    Read,
    Stepped,
)
from coadapt.study.store import Kept

PAUSE = 0.1
"""Seconds before somebody tries again whose server has gone."""

PATIENCE = 30.0
"""Seconds to wait for an answer."""

LOST = (httpx2.HTTPError, WebSocketException, OSError, TimeoutError, msgspec.MsgspecError)
"""What happens to the clients of a server that ends."""

_ENCODER = msgspec.json.Encoder()
_DECODER: msgspec.json.Decoder[FromServer] = msgspec.json.Decoder(FromServer)


class Problem(Exception):
    """The server did what it must not do."""


@dataclass
class Acknowledged:
    """What the server said is safe.

    Attributes:
        forms: the stages whose form was taken.
        begun: ``(stage, attempt)``.
        inputs: ``(stage, attempt, sequence, input)``.
        steps: ``(stage, attempt, step, state, reached)``.
        over: the stages that came to an end.
    """

    forms: list[str] = field(default_factory=list[str])
    begun: list[tuple[str, int]] = field(default_factory=list[tuple[str, int]])
    inputs: list[tuple[str, int, int, int | None]] = field(
        default_factory=list[tuple[str, int, int, int | None]]
    )
    steps: list[tuple[str, int, int, int, int]] = field(
        default_factory=list[tuple[str, int, int, int, int]]
    )
    over: list[str] = field(default_factory=list[str])

    def __len__(self) -> int:
        parts = (self.forms, self.begun, self.inputs, self.steps, self.over)
        return sum(len(part) for part in parts)


@dataclass
class Visitor:
    """One participant.

    Args:
        study: the protocol.
        servers: the addresses of all processes that serve it; each time one is chosen by chance.
        participant: what the recruitment service calls them.
        rng: of all they do.
        pause: seconds between inputs.

    Attributes:
        path: of the session's page, once it is known.
        acknowledged: what the server said is safe.
        losses: how often a server was lost.
        done: whether the debrief was reached.
    """

    study: Study
    servers: Sequence[str]
    participant: str
    rng: np.random.Generator
    pause: float = 0.1
    path: str = ""
    acknowledged: Acknowledged = field(default_factory=Acknowledged)
    losses: int = 0
    done: bool = False
    _sequence: int = 0

    @property
    def key(self) -> str:
        """Of the session."""
        return self.path.rpartition("/")[2]

    async def go(self, until: Callable[[], bool] = lambda: False) -> None:
        """Go on to the debrief, or until told to stop.

        Raises:
            Problem: if a server did what it must not do.
        """
        while not self.done and not until():
            server = self.servers[int(self.rng.integers(len(self.servers)))]
            try:
                async with httpx2.AsyncClient(base_url=server, timeout=PATIENCE) as client:
                    await self._visit(client, server, until)
            except LOST:
                self.losses += 1
                await asyncio.sleep(PAUSE)

    async def _visit(
        self, client: httpx2.AsyncClient, server: str, until: Callable[[], bool]
    ) -> None:
        """Go on at one server, for a few pages."""
        for _ in range(3):
            if until():
                return
            address = self.path or f"/?PROLIFIC_PID={self.participant}"
            answer = await client.get(address, follow_redirects=True)
            if answer.status_code == 503:
                raise OSError("the server cannot store anything")
            if answer.status_code != 200:
                raise Problem(f"the server answered {answer.status_code} to a page")
            path = answer.url.path
            if self.path and path != self.path:
                raise Problem("another session was given")
            self.path = path
            page = read_page(answer.text)
            if page.steers:
                assert page.socket is not None
                await self._steer(server.replace("http", "ws", 1) + page.socket)
            elif page.form is not None and page.form.stage != "debrief 1":
                await self._fill(client, page.form, page)
            elif page.form is not None or "Thank you" in page.heading:
                self.done = True
                return
            else:
                raise Problem(f"found nothing to do on the page {page.heading!r}")

    async def _fill(self, client: httpx2.AsyncClient, form: Form, page: Page) -> None:
        answer = await client.post(form.action, data=filled(form))
        if answer.status_code == 503:
            raise OSError("the server cannot store anything")
        if answer.status_code != 303:
            raise Problem(f"the server answered {answer.status_code} to the form of {form.stage}")
        self.acknowledged.forms.append(form.stage or page.heading)

    async def _steer(self, address: str) -> None:
        async with connect(address, open_timeout=PATIENCE, compression=None) as connection:
            stage, attempt = "", 0
            await _say(connection, Ready())
            pressing: asyncio.Task[None] | None = None
            try:
                while True:
                    message = await _hear(connection)
                    match message:
                        case Scene():
                            stage = f"{Stage(message.kind, message.number)}"
                        case Begun():
                            attempt = message.attempt
                            self.acknowledged.begun.append((stage, attempt))
                            pressing = asyncio.create_task(self._press(connection))
                        case Stored(sequence=sequence):
                            given = None if sequence % 2 == 0 else sequence // 2 % 3
                            self.acknowledged.inputs.append((stage, attempt, sequence, given))
                        case Step():
                            self.acknowledged.steps.append(
                                (stage, attempt, message.step, message.state, message.reached)
                            )
                        case Over():
                            self.acknowledged.over.append(stage)
                            return
                        case Refused(reason=reason):
                            raise OSError(reason)
                        case _:
                            pass
            finally:
                if pressing is not None:
                    pressing.cancel()

    async def _press(self, connection: ClientConnection) -> None:
        """Odd messages press an input that follows from their number, even ones let it go."""
        while True:
            await asyncio.sleep(self.pause * float(self.rng.uniform(0.5, 1.5)))
            self._sequence += 1
            given = None if self._sequence % 2 == 0 else self._sequence // 2 % 3
            now = asyncio.get_running_loop().time()
            sent = Input(input=given, device="keyboard", sequence=self._sequence, page_time=now)
            try:
                await _say(connection, sent)
            except LOST:
                return


def filled(form: Form) -> dict[str, str]:
    """A form as a page would send it."""
    data = dict(form.hidden)
    if "latency" in data:
        data |= {"width": "800", "height": "600", "latency": "0.01", "device": "keyboard"}
    data |= {name: values[-1] for name, values in form.choices.items()}
    if "consent" in form.buttons:
        data["consent"] = "yes"
    return data | dict.fromkeys(form.texts, "words")


def missing(acknowledged: Acknowledged, events: Sequence[Kept]) -> list[str]:
    """What was acknowledged and is not among ``events``."""
    stored: set[object] = set()
    stage, attempt = "", 0
    for kept in events:
        match kept.event:
            case Opened():
                pass
            case Read() | Answered():
                stored.add(("form", f"{kept.event.stage}"))
            case Checked():
                stored.add(("form", "preflight 1"))
            case Consented():
                stored.add(("form", "consent 1"))
            case Chose():
                stored.add(("form", "choice 1"))
            case Began():
                stage, attempt = f"{kept.event.stage}", kept.event.attempt
                stored.add(("begun", stage, attempt))
            case Pressed(sequence=sequence, input=given):
                stored.add(("input", stage, attempt, sequence, given))
            case Stepped(step=step, state=state, reached=reached):
                stored.add(("step", stage, attempt, step, state, reached))
            case Finished():
                stored.add(("over", f"{kept.event.stage}"))
            case _:
                pass
    said: list[tuple[object, ...]] = [("form", stage) for stage in acknowledged.forms]
    said += [("begun", *begun) for begun in acknowledged.begun]
    said += [("input", *given) for given in acknowledged.inputs]
    said += [("step", *step) for step in acknowledged.steps]
    said += [("over", stage) for stage in acknowledged.over]
    return [f"{thing}" for thing in said if thing not in stored]


async def _say(connection: ClientConnection, message: FromPage) -> None:
    await connection.send(_ENCODER.encode(message).decode())


async def _hear(connection: ClientConnection) -> FromServer:
    async with asyncio.timeout(PATIENCE):
        return _DECODER.decode(await connection.recv())
