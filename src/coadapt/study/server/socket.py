"""The websocket of a participant who steers."""

from __future__ import annotations

import asyncio
import logging
from urllib.parse import urlsplit

from starlette.websockets import WebSocket

from coadapt.study.server.limits import Bucket
from coadapt.study.server.line import Line
from coadapt.study.server.messages import (
    FromServer,
    Note,
    Ping,
    Pong,
    Refused,
    decode_message,
    encode_message,
)
from coadapt.study.server.service import Service
from coadapt.study.server.steering import End, Send, Steering
from coadapt.study.session import NotNow
from coadapt.study.store import StoreError

log = logging.getLogger("coadapt.study")

RATE, BURST = 50.0, 100.0
"""Messages a second, and at once after a rest."""

MOST_UNREAD = 250
"""Messages that wait while the database is slow."""

ALIVE = 60.0
"""Seconds after which an idle connection is noted as a sign of life."""

TOO_MANY = "Too many messages came from this page."

ELSEWHERE = "This session has been opened in another window."

NOT_STORED = (
    "Something could not be stored. What was shown as done is safe. Please load this page again."
)

FAILED = "Something went wrong on the server. Please load this page again."


class Connections:
    """Who is connected: at most one page a session, the newest."""

    def __init__(self) -> None:
        self._open: dict[str, Steering] = {}

    def enter(self, key: str, steering: Steering) -> None:
        """A new connection; an older one of the same session is told to end."""
        self.end(key, ELSEWHERE)
        self._open[key] = steering

    def leave(self, key: str, steering: Steering) -> None:
        """This connection has ended."""
        if self._open.get(key) is steering:
            del self._open[key]

    def end(self, key: str, reason: str) -> None:
        """Tell the connection of a session to end, if there is one."""
        if key in self._open:
            self._open[key].put(End(reason))

    def __contains__(self, key: str) -> bool:
        return key in self._open

    def __len__(self) -> int:
        return len(self._open)


class Ear:
    """Hands the page's messages on; answers pings at once, and ends it if there are too many."""

    def __init__(self, steering: Steering, send: Send) -> None:
        self._steering = steering
        self._send = send
        self._bucket = Bucket(RATE, BURST)
        self._deaf = False

    def hear(self, text: str | None) -> None:
        """The page has sent this; None if it is no text."""
        if self._deaf:
            return
        if not self._bucket.take() or self._steering.unread >= MOST_UNREAD:
            self.end(TOO_MANY)
            return
        try:
            if text is None:
                raise ValueError
            message = decode_message(text)
        except ValueError:
            self.end("The page sent something that is no message.")
            return
        if isinstance(message, Ping):
            self._send(Pong(page_time=message.page_time))
        else:
            self._steering.put(message)

    def end(self, reason: str | None = None) -> None:
        """Nothing more is heard."""
        self._deaf = True
        self._steering.put(End(reason))


async def steer(websocket: WebSocket, service: Service, connections: Connections, key: str) -> None:
    """Serve one connection to its end."""
    if not is_same_origin(websocket):
        await websocket.close(4403)
        return
    try:
        await service.session(key)
    except KeyError:
        await websocket.close(4404)
        return
    except StoreError as error:
        log.error("a session cannot be read: %s", error)
        await websocket.close(1011)
        return
    await websocket.accept()
    line = Line(websocket)

    def send(message: FromServer) -> None:
        line.say(encode_message(message))

    steering = Steering(service, key, send)
    connections.enter(key, steering)
    ear = Ear(steering, send)
    reading = asyncio.create_task(line.run(ear.hear))
    reading.add_done_callback(lambda _: ear.end())
    living = asyncio.create_task(_live(steering))
    try:
        reason = await _reason(steering)
        if reason is not None:
            send(Refused(reason=reason))
            await line.close(1008)
    finally:
        steering.close()
        living.cancel()
        reading.cancel()
        connections.leave(key, steering)


async def _reason(steering: Steering) -> str | None:
    """Why it ended, for the page; None if that has gone."""
    try:
        return await steering.ended
    except NotNow as error:
        return f"{error}"
    except KeyError:
        return "This session has been deleted."
    except StoreError as error:
        log.error("not stored: %s", error)
        return NOT_STORED
    except Exception:
        log.exception("a connection failed")
        return FAILED


async def _live(steering: Steering) -> None:
    """Note now and then that the connection is there."""
    while True:
        await asyncio.sleep(ALIVE)
        steering.put(Note(what="alive"))


def is_same_origin(websocket: WebSocket) -> bool:
    """Whether the connection comes from one of our pages, or from no page at all."""
    origin = websocket.headers.get("origin")
    return origin is None or urlsplit(origin).netloc == websocket.headers.get("host")
