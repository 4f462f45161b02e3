"""The line to a page over a real connection: what is heard, and how it ends."""

from __future__ import annotations

import asyncio
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
import uvicorn
from starlette.applications import Starlette
from starlette.routing import WebSocketRoute
from starlette.websockets import WebSocket
from websockets.exceptions import ConnectionClosed
from websockets.frames import CloseCode
from websockets.sync.client import ClientConnection, connect

from coadapt.study.server.line import EXTENSION, DirectWebSocket, Line

MUCH = b"x" * 1_000_000

CLOSED = threading.Event()
"""A line was closed without an error."""


async def echo(websocket: WebSocket) -> None:
    """Says what it hears, "bytes" for bytes; hangs up at "end"; says much at "much"."""
    await websocket.accept()
    line, over = Line(websocket), asyncio.Event()

    def hear(text: str | None) -> None:
        if text == "end":
            over.set()
        elif text == "much":
            for _ in range(100):
                line.say(MUCH)
        else:
            line.say((text or "bytes").encode())

    running = asyncio.create_task(line.run(hear))
    running.add_done_callback(lambda _: over.set())
    await over.wait()
    await line.close(4000)
    running.cancel()
    CLOSED.set()


@contextmanager
def served(protocol: type[asyncio.Protocol] | str) -> Iterator[str]:
    """The address of `echo` on a server with this protocol."""
    app = Starlette(routes=[WebSocketRoute("/", echo)])
    config = uvicorn.Config(app, ws=protocol, log_level="critical", ws_max_size=4096)  # type: ignore[arg-type]
    server = uvicorn.Server(config)
    with socket.create_server(("127.0.0.1", 0)) as listening:
        thread = threading.Thread(target=server.run, args=([listening],))
        thread.start()
        try:
            yield f"ws://127.0.0.1:{listening.getsockname()[1]}/"
        finally:
            server.should_exit = True
            thread.join()


@pytest.fixture(params=[DirectWebSocket, "websockets-sansio"], ids=["direct", "plain"])
def page(request: pytest.FixtureRequest) -> Iterator[ClientConnection]:
    """A connection with the short ways, and one without."""
    with served(request.param) as address, connect(address, compression=None) as connection:
        yield connection


def test_what_is_said_is_heard_in_order(page: ClientConnection) -> None:
    for i in range(200):
        page.send(f"{i}")
    assert [page.recv(timeout=10) for _ in range(200)] == [f"{i}" for i in range(200)]
    page.send(b"123")
    assert page.recv(timeout=10) == "bytes"
    page.send(["pa", "r", "ts"])  # one message in three frames
    assert page.recv(timeout=10) == "parts"
    page.send("ü\0")
    assert page.recv(timeout=10) == "ü\0"


def closed(page: ClientConnection) -> int | None:
    """The code with which the server hangs up."""
    with pytest.raises(ConnectionClosed) as error:
        page.recv(timeout=10)
    return None if error.value.rcvd is None else error.value.rcvd.code


def test_all_is_said_before_the_line_is_closed(page: ClientConnection) -> None:
    page.send("a")
    page.send("end")
    assert page.recv(timeout=10) == "a"
    assert closed(page) == 4000


def test_a_line_is_closed_though_the_page_has_gone(page: ClientConnection) -> None:
    CLOSED.clear()
    page.socket.shutdown(socket.SHUT_RDWR)
    assert CLOSED.wait(10)


def test_what_is_no_text_closes_the_line(page: ClientConnection) -> None:
    page.send(b"\xff", text=True)
    assert closed(page) == CloseCode.INVALID_DATA  # RFC 6455, sec. 8.1


def test_what_is_too_long_closes_the_line(page: ClientConnection) -> None:
    page.send("x" * 5000)
    assert closed(page) == CloseCode.MESSAGE_TOO_BIG


def test_a_page_that_reads_nothing_is_cut_off() -> None:
    # 100 MB are more than all buffers on the way can hold.
    with (
        served(DirectWebSocket) as address,
        connect(address, compression=None, max_size=None, max_queue=1) as page,
    ):
        page.send("much")
        heard = 0
        with pytest.raises(ConnectionClosed):
            while True:
                heard += len(page.recv(timeout=10))
        assert heard < 100 * len(MUCH)


def test_the_short_ways_are_there_on_our_server_alone() -> None:
    found: list[bool] = []

    async def look(websocket: WebSocket) -> None:
        found.append(EXTENSION in websocket.scope["extensions"])
        await websocket.accept()
        await websocket.close()

    app = Starlette(routes=[WebSocketRoute("/", look)])
    for protocol in (DirectWebSocket, "websockets-sansio"):
        config = uvicorn.Config(app, ws=protocol, log_level="critical")  # type: ignore[arg-type]
        server = uvicorn.Server(config)
        with socket.create_server(("127.0.0.1", 0)) as listening:
            thread = threading.Thread(target=server.run, args=([listening],))
            thread.start()
            with connect(f"ws://127.0.0.1:{listening.getsockname()[1]}/"):
                pass
            server.should_exit = True
            thread.join()
    assert found == [True, False]
