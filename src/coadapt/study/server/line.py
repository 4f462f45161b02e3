"""The line to a page: what it says is heard at once, what is said to it goes out at once."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
from typing import cast

from starlette.websockets import WebSocket, WebSocketDisconnect
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.http11 import Request

EXTENSION = "coadapt.direct"
"""Of ASGI: under this name a scope holds its `DirectWebSocket`."""

GONE = (WebSocketDisconnect, RuntimeError)
"""What is raised where the page has gone, or the server has ended it at too long a message."""

Hear = Callable[[str | None], None]
"""Takes a message of the page: a text, or None for bytes."""


class DirectWebSocket(WebSocketsSansIOProtocol):
    """uvicorn's websocket with two short ways, for an application that asks for them.

    By ASGI a message waits in a queue for the application's task, which is woken through every
    layer of the framework, and reading pauses meanwhile. With ten messages a second from each of
    hundreds of pages that is most of the work.
    """

    _hear: Hear | None = None

    def listen(self, hear: Hear) -> None:
        """Let ``hear`` have the messages from now on. The end of the connection is received."""
        self._hear = hear

    def say(self, data: bytes) -> None:
        """Send a text. A page that has gone gets none, and one that reads nothing is cut off."""
        if self.close_sent or self.disconnected or self.transport.is_closing():
            return
        if not self.writable.is_set():  # more is waiting than the transport should hold
            self.transport.abort()
            return
        self.conn.send_text(data)
        self.transport.write(b"".join(self.conn.data_to_send()))

    # What uvicorn calls

    def handle_connect(self, event: Request) -> None:
        """The page has asked for a websocket."""
        super().handle_connect(event)
        if not self.close_sent:
            self.scope["extensions"][EXTENSION] = self  # pyright: ignore

    def send_receive_event_to_app(self) -> None:
        """A message has come; its parts are in ``frames``."""
        if self._hear is None:
            super().send_receive_event_to_app()
            return
        text = None
        if self.curr_msg_data_type == "text":
            try:
                text = str(b"".join(self.frames), "utf-8")
            except UnicodeDecodeError:
                super().send_receive_event_to_app()  # closes the connection
                return
        self.frames = []
        if not self.close_sent:
            self._hear(text)


class Line:
    """A websocket that is open.

    It takes the short ways where the server is one of `coadapt.study.server.run`, and keeps to ASGI
    on any other.
    """

    def __init__(self, websocket: WebSocket) -> None:
        self._websocket = websocket
        found = websocket.scope.get("extensions", {}).get(EXTENSION)
        self._direct = cast("DirectWebSocket | None", found)
        self._outgoing: asyncio.Queue[bytes] = asyncio.Queue()

    def say(self, data: bytes) -> None:
        """Send a text; nothing if the page has gone."""
        if self._direct is None:
            self._outgoing.put_nowait(data)
        else:
            self._direct.say(data)

    async def run(self, hear: Hear) -> None:
        """Let ``hear`` have what the page says, until it has gone."""
        websocket = self._websocket
        writing = None
        if self._direct is None:
            writing = asyncio.create_task(self._write())
        else:
            self._direct.listen(hear)
        try:
            while (message := await websocket.receive())["type"] == "websocket.receive":
                hear(message.get("text"))
        finally:
            if writing is not None:
                writing.cancel()

    async def close(self, code: int) -> None:
        """Hang up, once all is said."""
        await self._outgoing.join()
        with suppress(*GONE):
            await self._websocket.close(code)

    async def _write(self) -> None:
        while True:
            text = (await self._outgoing.get()).decode()
            with suppress(*GONE):
                await self._websocket.send_text(text)
            self._outgoing.task_done()
