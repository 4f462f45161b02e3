"""A study's web application without a network."""

from __future__ import annotations

import re
from collections.abc import Generator
from contextlib import contextmanager

import msgspec
from starlette.testclient import TestClient, WebSocketTestSession

from coadapt.study.protocol import Study
from coadapt.study.server.messages import FromServer
from coadapt.study.server.run import make_app
from coadapt.study.server.service import Service
from coadapt.study.store import Store
from tests.study.server.services import study_with
from tests.study.sessions import small_study

HIDDEN = re.compile(r'name="(stage|csrf)" value="([^"]*)"')

_DECODER: msgspec.json.Decoder[FromServer] = msgspec.json.Decoder(FromServer)


@contextmanager
def client_of(
    url: str, study: Study | None = None, *, secure: bool = False
) -> Generator[tuple[TestClient, Service]]:
    """A browser without scripts, and the service behind the site that it looks at."""
    directory, _, robots = small_study()
    store = Store(url)
    service = Service(study or study_with(), robots, store, directory)
    app = make_app(service, secure=secure)
    with TestClient(app, follow_redirects=False) as client:
        yield client, service
    store.close()


def enter(client: TestClient, link: str = "/") -> str:
    """Come by a link; the path of the session's page."""
    answer = client.get(link)
    assert answer.status_code == 303
    return answer.headers["location"]


def hidden(client: TestClient, path: str) -> dict[str, str]:
    """The hidden fields of the page's form."""
    page = client.get(path)
    assert page.status_code == 200
    return dict(HIDDEN.findall(page.text))


def post(client: TestClient, path: str, **fields: str) -> int:
    """Send the page's form; the status of the answer."""
    return client.post(path, data={**hidden(client, path), **fields}).status_code


def bring_to_practice(client: TestClient, path: str) -> None:
    """Answer the pages before the first training session."""
    assert post(client, path) == 303
    checked = {"device": "keyboard", "width": "800", "height": "600", "latency": "0.01"}
    assert post(client, path, **checked, browser="B", pad="") == 303
    assert post(client, path, consent="yes") == 303
    assert post(client, path) == 303


def hear(socket: WebSocketTestSession) -> FromServer:
    """The server's next message."""
    return _DECODER.decode(socket.receive_text())


def say(socket: WebSocketTestSession, **message: object) -> None:
    """Send a message of the page."""
    socket.send_text(msgspec.json.encode(message).decode())


def press(socket: WebSocketTestSession, human_input: int | None, sequence: int) -> None:
    """Send an input."""
    say(
        socket,
        type="input",
        input=human_input,
        device="keyboard",
        sequence=sequence,
        page_time=0.25 * sequence,
    )
