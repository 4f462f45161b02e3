"""The websocket of a participant who steers."""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from contextlib import suppress
from urllib.parse import urlsplit

from starlette.websockets import WebSocket, WebSocketDisconnect

from coadapt.study.server.limits import Bucket
from coadapt.study.server.messages import (
    FromServer,
    Input,
    Note,
    Ping,
    Pong,
    Ready,
    Refused,
    decode_message,
    encode_message,
)
from coadapt.study.server.service import Service
from coadapt.study.server.steering import Send, Steering
from coadapt.study.session import NotNow
from coadapt.study.session.events import Noted
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
        self._boxes: dict[str, Mailbox] = {}

    def enter(self, key: str) -> Mailbox:
        """A mailbox for a new connection; an older one of the same session is told to end."""
        self.end(key, ELSEWHERE)
        box = self._boxes[key] = Mailbox()
        return box

    def leave(self, key: str, box: Mailbox) -> None:
        """The connection with this mailbox has ended."""
        if self._boxes.get(key) is box:
            del self._boxes[key]

    def end(self, key: str, reason: str) -> None:
        """Tell the connection of a session to end, if there is one."""
        if key in self._boxes:
            self._boxes[key].put(End(reason))

    def __contains__(self, key: str) -> bool:
        return key in self._boxes

    def __len__(self) -> int:
        return len(self._boxes)


class End:
    """Stands in a mailbox behind the last message; ``reason`` is for the page if it is there."""

    def __init__(self, reason: str | None = None) -> None:
        self.reason = reason


class Mailbox:
    """What has come for a connection and is not yet dealt with; one task takes it out."""

    def __init__(self) -> None:
        self._messages: deque[Ready | Input | Note | End] = deque()
        self._waiting: asyncio.Future[None] | None = None

    def put(self, message: Ready | Input | Note | End) -> bool:
        """Put it behind the others; False if there are too many."""
        if len(self._messages) >= MOST_UNREAD and not isinstance(message, End):
            return False
        self._messages.append(message)
        self._wake()
        return True

    async def get(self, until: float) -> Ready | Input | Note | End | None:
        """The first; None if there is none by ``until``, in seconds of the event loop."""
        if not self._messages:
            loop = asyncio.get_running_loop()
            self._waiting = loop.create_future()
            alarm = loop.call_at(until, self._wake)
            try:
                await self._waiting
            finally:
                alarm.cancel()
                self._waiting = None
        return self._messages.popleft() if self._messages else None

    def _wake(self) -> None:
        if self._waiting is not None and not self._waiting.done():
            self._waiting.set_result(None)


async def steer(websocket: WebSocket, service: Service, connections: Connections, key: str) -> None:
    """Serve one connection to its end.

    Messages and turns of the clock are dealt with one after the other, each stored before the next:
    what is stored is what happened, in this order.
    """
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

    async def send(message: FromServer) -> None:
        try:
            await websocket.send_text(encode_message(message))
        except RuntimeError as error:  # the server has closed it, for example at too long a message
            raise WebSocketDisconnect(1006) from error

    box = connections.enter(key)
    reader = asyncio.create_task(_read(websocket, box, send))
    try:
        reason = await _serve(Steering(service, key, send), service, key, box)
        if reason is not None:
            await send(Refused(reason=reason))
            with suppress(RuntimeError):
                await websocket.close(1008)
    except WebSocketDisconnect:
        pass  # the page has gone
    finally:
        reader.cancel()
        connections.leave(key, box)


async def _serve(steering: Steering, service: Service, key: str, box: Mailbox) -> str | None:
    """Deal with messages and turns until the end; the reason for the page, if it is there."""
    loop = asyncio.get_running_loop()
    try:
        await steering.show()
        alive = loop.time() + ALIVE
        while True:
            turn = steering.next_turn
            message = await box.get(alive if turn is None else min(turn, alive))
            if isinstance(message, End):
                return message.reason
            if message is not None:
                await steering.take(message)
            elif turn is not None and turn <= alive:
                await steering.turn()
            else:
                await service.record(key, Noted(what="alive"))
                alive = loop.time() + ALIVE
    except NotNow as error:
        return f"{error}"
    except KeyError:
        return "This session has been deleted."
    except StoreError as error:
        log.error("not stored: %s", error)
        return NOT_STORED
    except WebSocketDisconnect:
        raise
    except Exception:
        log.exception("a connection failed")
        return FAILED


async def _read(websocket: WebSocket, box: Mailbox, send: Send) -> None:
    """Put the page's messages into the mailbox; answer pings at once."""
    bucket = Bucket(RATE, BURST)
    while True:
        try:
            text = await websocket.receive_text()
            if not bucket.take():
                box.put(End(TOO_MANY))
                return
            message = decode_message(text)
            if isinstance(message, Ping):
                await send(Pong(page_time=message.page_time))
            elif not box.put(message):
                box.put(End(TOO_MANY))
                return
        except (WebSocketDisconnect, RuntimeError):
            box.put(End())
            return
        except (ValueError, KeyError):  # KeyError: bytes instead of text
            box.put(End("The page sent something that is no message."))
            return


def is_same_origin(websocket: WebSocket) -> bool:
    """Whether the connection comes from one of our pages, or from no page at all."""
    origin = websocket.headers.get("origin")
    return origin is None or urlsplit(origin).netloc == websocket.headers.get("host")
