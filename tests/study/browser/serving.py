"""A study that is really served, in this process, and can be stopped and started again."""

from __future__ import annotations

import asyncio
import threading
from pathlib import Path
from urllib.parse import urlencode
from urllib.request import urlopen

import uvicorn

from coadapt.study.protocol import Study
from coadapt.study.protocol.reader import FILE, template
from coadapt.study.server.run import Address, bind, load_service, make_app
from coadapt.study.server.security import csrf_of, new_admin_token
from coadapt.study.session import Event, Session, replayed
from coadapt.study.store import Store

PATIENCE = 120.0
"""Seconds in which a server has to start, with all that is compiled then, or to stop."""


BEFORE_PRACTICE = (
    ("welcome", {}),
    ("preflight", {"device": "keyboard", "width": "1280", "height": "800", "latency": "0.01"}),
    ("consent", {"consent": "yes"}),
    ("instructions", {}),
)
"""The forms that lead to the first training session."""

CONDITION = """[[conditions]]
name = "alone"
robot = "no_adaptation"
briefing = "The robot has a mind of its own."

"""


def write_study(directory: Path, *changes: tuple[str, str], questions: bool = True) -> Path:
    """The template with the small table, a robot that needs no planning and a fast clock.

    Args:
        directory: made here.
        changes: what stands in the template, and what is to stand there instead.
        questions: whether anything is asked after the trials.
    """
    text = template().decode()
    start, end = text.index("[[conditions]]"), text.index("[texts]")
    text = text[:start] + CONDITION + text[end:]
    text = text[: text.index("[[hypotheses]]" if questions else "[[scales]]")]
    for old, new in (
        ('"table_clearing"', '"table_clearing_small"'),
        ("step = 0.5", "step = 0.08"),
        ('return_link = ""', 'return_link = "https://recruitment.example/done"'),
        *changes,
    ):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    directory.mkdir(parents=True)
    (directory / FILE).write_text(text, encoding="utf-8")
    return directory


class Serving:
    """The study in ``directory``, served at an address of this machine."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self._port = 0
        self.start()

    @property
    def address(self) -> str:
        """What participants open."""
        return f"http://127.0.0.1:{self._port}"

    def start(self) -> None:
        """Serve, at the same address as before."""
        ready = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(ready,), daemon=True)
        self._thread.start()
        assert ready.wait(PATIENCE), "the server did not start"

    def stop(self) -> None:
        """End the server and all connections."""
        self._server.should_exit = True
        self._thread.join(PATIENCE)
        assert not self._thread.is_alive(), "the server did not stop"

    @property
    def study(self) -> Study:
        """The protocol."""
        from coadapt.study.protocol import read_study

        return read_study(self.directory)

    def events(self, key: str) -> list[Event]:
        """What is stored of a session."""
        store = Store(Store.url_in(self.directory))
        try:
            row = store.find(key=key)
            assert row is not None
            return [kept.event for kept in store.events(row.id)]
        finally:
            store.close()

    def to_practice(self) -> str:
        """The page of somebody with a keyboard who stands before the first training session."""
        with urlopen(f"{self.address}/") as answer:
            page: str = answer.url
        for stage, fields in BEFORE_PRACTICE:
            form = {"stage": f"{stage} 1", "csrf": csrf_of(page.rpartition("/")[2]), **fields}
            with urlopen(page, urlencode(form).encode()) as answer:
                assert answer.status == 200
        return page

    def number(self, key: str) -> int:
        """The number of a session, which the researcher sees."""
        store = Store(Store.url_in(self.directory))
        try:
            row = store.find(key=key)
            assert row is not None
            return row.id
        finally:
            store.close()

    def admin_link(self) -> str:
        """What the researcher opens."""
        store = Store(Store.url_in(self.directory))
        try:
            return f"{self.address}/admin?token={new_admin_token(store)}"
        finally:
            store.close()

    def session(self, key: str) -> Session:
        """Where a session stands, from what is stored."""
        return replayed(self.study, self.events(key))

    def _run(self, ready: threading.Event) -> None:
        asyncio.run(self._serve(ready))

    async def _serve(self, ready: threading.Event) -> None:
        service = load_service(self.directory)
        listening = bind(Address(port=self._port))
        self._port = listening.getsockname()[1]
        config = uvicorn.Config(
            make_app(service, secure=False),
            lifespan="on",
            log_level="warning",
            timeout_graceful_shutdown=1,
        )
        self._server = uvicorn.Server(config)
        # Signals belong to the tests.
        serving = asyncio.create_task(self._server._serve([listening]))
        while not self._server.started and not serving.done():
            await asyncio.sleep(0.02)
        ready.set()
        await serving
