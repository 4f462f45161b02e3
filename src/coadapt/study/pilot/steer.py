"""A participant steers: over the same websocket as the page, message by message."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncGenerator
from contextlib import asynccontextmanager

import msgspec
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from coadapt.formalism import SharedAutonomy
from coadapt.simulation import Partner, SimulatedPartner
from coadapt.simulation import Person as Mind
from coadapt.simulation.partners import acting
from coadapt.study.pilot.person import Person
from coadapt.study.server.messages import (
    Begun,
    FromPage,
    FromServer,
    Input,
    Over,
    Ping,
    Pong,
    Ready,
    Refused,
    Scene,
    Step,
)

PATIENCE = 60.0
"""Seconds to wait for a message of the server."""

BURST, PACE = 60, 1 / 40
"""After so many messages on a connection the next ones come in this rhythm, in seconds: the server
takes no more of a page."""

PINGS = 5
"""Round trips of which the median is the latency."""

_ENCODER = msgspec.json.Encoder()
_DECODER: msgspec.json.Decoder[FromServer] = msgspec.json.Decoder(FromServer)


class Lost(Exception):
    """The connection ended before the attempt did."""


class Line:
    """A connection to the server."""

    def __init__(self, connection: ClientConnection) -> None:
        self._connection = connection
        self._sent = 0

    async def send(self, message: FromPage) -> None:
        """Send a message; no faster than the server takes them."""
        self._sent += 1
        if self._sent > BURST:
            await asyncio.sleep(PACE)
        await self._connection.send(_ENCODER.encode(message).decode())

    async def receive(self) -> FromServer:
        """The next message.

        Raises:
            Lost: if none comes.
        """
        try:
            async with asyncio.timeout(PATIENCE):
                return _DECODER.decode(await self._connection.recv())
        except (ConnectionClosed, TimeoutError) as error:
            raise Lost("the server ended the connection") from error

    def drop(self) -> None:
        """Lose the connection, as when a cable is pulled."""
        self._connection.transport.abort()


@asynccontextmanager
async def line_to(url: str) -> AsyncGenerator[Line]:
    """A connection to the websocket at ``url``."""
    async with connect(url, open_timeout=PATIENCE, compression=None) as connection:
        yield Line(connection)


async def latency(url: str) -> float:
    """The median round trip to the server at ``url``, in seconds."""
    took: list[float] = []
    async with line_to(url) as line:
        while len(took) < PINGS:
            begun = time.perf_counter()
            await line.send(Ping(page_time=begun))
            while not isinstance(await line.receive(), Pong):
                pass
            took.append(time.perf_counter() - begun)
    return sorted(took)[PINGS // 2]


class Hand:
    """What a participant does on the page of a training session or trial.

    Args:
        person: who it is.
        model: the world, the inputs, and how people perceive the robot.
    """

    def __init__(self, person: Person, model: SharedAutonomy) -> None:
        self._person, self._model = person, model
        self._sequence = 0

    async def attempt(self, url: str, goal: int, breaks_after: int | None, *, lost: bool) -> bool:
        """Steer from the start; whether the attempt came to its end.

        Args:
            url: of the websocket.
            goal: what the person wants at first.
            breaks_after: number of steps after which they leave the page, or None.
            lost: whether leaving is a loss of the connection.

        Raises:
            Lost: if the server ended the connection, or refused something.
        """
        model, rng = self._model, self._person.rng
        partner = acting(SimulatedPartner(self._person.adaptability, goal), model)
        mind: Mind | None = None
        held, steps, waits = None, 0, False
        async with line_to(url) as line:
            await line.send(Ready())
            while True:
                match await line.receive():
                    case Scene() as scene:
                        waits = scene.turns == "wait"
                    case Begun() as begun:
                        mind = partner.begin(model, begun.state, None, rng)
                        held = await self._press(line, partner, begun.state, mind, None, waits)
                    case Step() as step if mind is not None:
                        steps += 1
                        if steps == breaks_after:
                            if lost:
                                line.drop()
                            return False
                        mind = self._see(partner, mind, step)
                        held = await self._press(line, partner, step.reached, mind, held, waits)
                    case Over():
                        return True
                    case Refused() as refused:
                        raise Lost(refused.reason)
                    case _:
                        pass

    async def _press(
        self,
        line: Line,
        partner: Partner,
        state: int,
        mind: Mind,
        held: int | None,
        waits: bool,
    ) -> int | None:
        """The input for ``state``; sent where it is another than is held, or has to be."""
        person, model = self._person, self._model
        if model.world.ends[state]:
            return held
        given = None
        while True:
            given = partner.act(model, state, mind, person.rng)
            if person.chance(person.population.noise):
                given = int(person.rng.integers(len(model.input_names)))
            if given is not None or not waits:  # nothing happens without one
                break
        if waits or given != held:
            self._sequence += 1
            now = time.monotonic()
            times = {"page_time": now, "device_time": now if person.device == "gamepad" else None}
            await line.send(
                Input(input=given, device=person.device, sequence=self._sequence, **times)  # pyright: ignore
            )
        return given

    def _see(self, partner: Partner, mind: Mind, step: Step) -> Mind:
        """What they think after the robot was seen to move."""
        model, possible = self._model, self._model.world.outcome_chances[step.state] > 0
        leads = (model.world.outcomes[step.state] == step.reached) & possible  # [A, N]
        if not leads.any():
            return mind  # in training the robot may stay
        action = int(leads.any(axis=1).argmax())
        outcome = int(leads[action].argmax())
        return partner.react(model, mind.window, mind, action, outcome, self._person.rng)
