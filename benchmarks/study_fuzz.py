"""Nonsense for a study's server: forms and websocket messages that no page sends.

    python benchmarks/study_fuzz.py                   50,000 of them
    python benchmarks/study_fuzz.py --messages 2000

A hostile client opens sessions, goes on for some pages, then sends forms and messages that are
wrong in all ways that hypothesis finds. Meanwhile witnesses steer sessions of their own. Checked
are: no answer is a server error; no witness loses a connection, an acknowledged event or a page,
or finds something in its session that it did not do; the server's memory stays within bounds; every
stored session can be read.
"""

from __future__ import annotations

import argparse
import asyncio
import logging
import os
import signal
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import count
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

import httpx2
import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from study_kill import write_study
from study_nonsense import CONVERSATIONS, FORMS, RAW
from study_visitor import Visitor, filled, missing
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from coadapt.study.pilot.page import read_page
from coadapt.study.protocol import Study, read_study
from coadapt.study.session import plan_of, replayed
from coadapt.study.session.events import Noted
from coadapt.study.store import Store

WITNESSES = 3

MOST_GROWTH = 100.0
"""MB that the server may grow by while it is fuzzed, beyond what it needs at first: it keeps 5,000
sessions in memory."""

WARM = 0.2
"""Part of the messages after which its memory is looked at first."""

ROUND = 20
"""Sessions that hypothesis draws at a time."""

PATIENCE = 20.0
"""Seconds to wait for an answer."""

SERVER_ERROR = 500

LOG = "server.log"
"""What the server says; a traceback in it is an error."""


@dataclass
class Counts:
    """What was sent and what came back.

    Attributes:
        forms, messages: how many were sent.
        answers: how many answers had each status.
        closed: how many connections were closed with each code; -1 for one that stayed open.
        errors: what must not happen.
    """

    forms: int = 0
    messages: int = 0
    answers: Counter[int] = field(default_factory=Counter[int])
    closed: Counter[int] = field(default_factory=Counter[int])
    errors: list[str] = field(default_factory=list[str])

    @property
    def sent(self) -> int:
        """Forms and messages."""
        return self.forms + self.messages


@dataclass(frozen=True)
class Report:
    """What became of it.

    Attributes:
        counts: of the hostile client.
        witnesses: what went wrong for the witnesses.
        acknowledged: how much was acknowledged to them meanwhile.
        memory: of the server in MB, warm and at the end.
        sessions: that are stored, all of them readable.
    """

    counts: Counts
    witnesses: Sequence[str]
    acknowledged: int
    memory: tuple[float, float]
    sessions: int

    @property
    def is_good(self) -> bool:
        """Whether the server held."""
        growth = self.memory[1] - self.memory[0]
        held = not self.counts.errors and not self.witnesses and self.acknowledged > 0
        return held and growth <= MOST_GROWTH


# Who sends it


class Hostile:
    """A client that does what it likes with sessions of its own.

    Args:
        address: of the server.
        study: its protocol.
        counts: is added to.
    """

    def __init__(self, address: str, study: Study, counts: Counts) -> None:
        self._client = httpx2.Client(base_url=address, timeout=PATIENCE)
        self._sockets = address.replace("http", "ws", 1)
        self._stages = [f"{stage}" for stage in plan_of(study)]
        self._counts = counts

    def close(self) -> None:
        """Close the connections."""
        self._client.close()

    def go_on(self, pages: int) -> str:
        """A new session, some pages on; its path."""
        self._client.cookies.clear()
        path = self._client.get("/").headers["location"]
        for _ in range(pages):
            form = read_page(self._client.get(path).text).form
            if form is None:  # there is something to steer
                break
            self._post(form.action, data=filled(form))
        return path

    def send_forms(
        self, path: str, forms: Sequence[tuple[dict[str, str], str]], raw: bytes, *, to: str
    ) -> None:
        """Post forms that are wrong somehow, to the page or to another part of the site."""
        for fields, hidden in forms:
            own = read_page(self._get(path)).form
            data = dict(fields)
            if own is not None and hidden == "own":
                data = {**data, **own.hidden}
            elif hidden == "wrong" and own is not None:
                other = self._stages[len(fields) % len(self._stages)]
                data = {**data, **own.hidden, "stage": other}
            with suppress(UnicodeEncodeError):  # what no client can send
                self._post(path + to, data=data)
        kind = {"content-type": "application/x-www-form-urlencoded"}
        self._post(path + to, content=raw, headers=kind)

    def converse(self, path: str, messages: Sequence[str | bytes]) -> None:
        """Send messages over a websocket until the server ends it."""
        counts = self._counts
        with (
            suppress(OSError, WebSocketException, TimeoutError),
            connect(f"{self._sockets}{path}/steer", compression=None, close_timeout=1) as socket,
        ):
            code = -1
            try:
                for message in messages:
                    counts.messages += 1
                    try:
                        socket.send(message)
                    except UnicodeEncodeError:
                        continue
                with suppress(TimeoutError):
                    while True:
                        heard = socket.recv(timeout=0.02)
                        if b"Something went wrong" in _bytes(heard):
                            counts.errors.append(f"failed after {messages!r}")
            except WebSocketException:
                code = socket.close_code or -1
            counts.closed[code] += 1
            if code == 1011:
                counts.errors.append(f"closed as a server error after {messages!r}")

    def _get(self, path: str) -> str:
        answer = self._client.get(path)
        self._look(answer, f"GET {path}")
        return answer.text

    def _post(self, path: str, **sent: object) -> None:
        self._counts.forms += 1
        answer = self._client.post(path, **sent)  # type: ignore[arg-type]
        self._look(answer, f"{sent!r:.500}")

    def _look(self, answer: httpx2.Response, what: str) -> None:
        self._counts.answers[answer.status_code] += 1
        if answer.status_code >= SERVER_ERROR:
            self._counts.errors.append(f"{answer.status_code} after {what}")


def _bytes(heard: str | bytes) -> bytes:
    return heard.encode() if isinstance(heard, str) else heard


# The server, in a process of its own, without limits of what one network may do


@contextmanager
def unlimited_server(directory: Path, url: str) -> Generator[tuple[str, int]]:
    """The address and the process id of a server whose rate limits do not stop a fuzzer."""
    context = get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=_serve, args=(directory, url, there), daemon=True)
    process.start()
    assert process.pid is not None
    try:
        yield here.recv(), process.pid
    finally:
        process.terminate()
        process.join(PATIENCE)


def _serve(directory: Path, url: str, there: Connection) -> None:
    from coadapt.study.server import app, run

    for name in ("OPENING_RATE", "OPENING_BURST", "POSTING_RATE", "POSTING_BURST"):
        setattr(app, name, 1e9)
    log = os.open(directory / LOG, os.O_WRONLY | os.O_CREAT)
    os.dup2(log, sys.stderr.fileno())
    address = run.Address(port=0)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with run.bind(address) as listening:
        service = run.load_service(directory, url)
        link = address.link(listening.getsockname()[1])
        site = run.make_app(service, secure=False)
        run.run(site, address, listening, lambda: there.send(link))
        service.store.close()


def memory_mb(process: int) -> float:
    """The memory that a process holds, in MB of 2**20 bytes."""
    pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    return pages * 4096 / (1 << 20)


class Witnesses:
    """Participants who go on all the time, in a thread of their own."""

    def __init__(self, study: Study, address: str) -> None:
        self._stop = threading.Event()
        self.problems: list[str] = []
        self.visitors = [
            Visitor(study, [address], f"witness-{i}", np.random.default_rng(i), pause=0.05)
            for i in range(WITNESSES)
        ]
        self._thread = threading.Thread(target=lambda: asyncio.run(self._go()))
        self._thread.start()

    async def _go(self) -> None:
        await asyncio.gather(*(self._one(visitor) for visitor in self.visitors))

    async def _one(self, visitor: Visitor) -> None:
        try:
            await visitor.go(self._stop.is_set)
        except Exception as error:
            self.problems.append(f"{visitor.participant}: {type(error).__name__}: {error}")

    def end(self) -> None:
        """Let them stop."""
        self._stop.set()
        self._thread.join()


def fuzz(
    directory: Path, url: str, messages: int, progress: Callable[[str], None] = lambda _: None
) -> Report:
    """Send at least so many forms and messages to a server of the study in ``directory``."""
    study = read_study(directory)
    counts = Counts()
    memory = [0.0, 0.0]
    with unlimited_server(directory, url) as (address, process):
        witnesses = Witnesses(study, address)
        hostile = Hostile(address, study, counts)

        @settings(
            max_examples=ROUND,
            deadline=None,
            database=None,
            phases=[Phase.generate],
            suppress_health_check=list(HealthCheck),
        )
        @given(
            pages=st.integers(0, 20),
            talk=CONVERSATIONS,
            forms=st.lists(FORMS, max_size=6),
            raw=RAW,
            to=st.sampled_from(["", "", "", "", "/withdraw", "/steer", "/x"]),
        )
        def attack(
            pages: int,
            talk: list[str | bytes],
            forms: list[tuple[dict[str, str], str]],
            raw: bytes,
            to: str,
        ) -> None:
            path = hostile.go_on(pages)
            hostile.converse(path, talk)
            hostile.send_forms(path, forms, raw, to=to)
            hostile.converse(path, talk)
            if not memory[0] and counts.sent >= WARM * messages:
                memory[0] = memory_mb(process)
            progress(f"{counts.sent:,} of {messages:,}")

        for number in count():
            if counts.sent >= messages:
                break
            seed(number)(attack)()
        hostile.close()
        witnesses.end()
        memory[1] = memory_mb(process)
    said = (directory / LOG).read_text()
    if "Traceback" in said:
        counts.errors.append(f"the server said {said[-2000:]}")
    store = Store(url)
    problems = list(witnesses.problems)
    rows = store.rows()
    for row in rows:
        replayed(study, [kept.event for kept in store.events(row.id)])
    for visitor in witnesses.visitors:
        problems += look_at_witness(store, visitor)
    store.close()
    acknowledged = sum(len(visitor.acknowledged) for visitor in witnesses.visitors)
    return Report(counts, problems, acknowledged, (memory[0], memory[1]), len(rows))


def look_at_witness(store: Store, visitor: Visitor) -> list[str]:
    """What is wrong with the session of a witness."""
    row = store.find(key=visitor.key)
    if row is None:
        return [f"{visitor.participant} has no session"]
    events = store.events(row.id)
    problems = [
        f"{visitor.participant}: missing {what}" for what in missing(visitor.acknowledged, events)
    ]
    if visitor.losses:
        problems.append(f"{visitor.participant} lost the connection {visitor.losses} times")
    if any(isinstance(kept.event, Noted) for kept in events):
        problems.append(f"{visitor.participant} has a note that it did not send")
    return problems


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n", maxsplit=1)[0])
    parser.add_argument("--messages", type=int, default=50_000)
    given_options = parser.parse_args()
    # The client is not meant for connections that are cut in the middle of a message.
    logging.getLogger("websockets").setLevel(logging.CRITICAL)
    began = time.monotonic()
    last = [0.0]

    def tell(what: str) -> None:
        if time.monotonic() - last[0] > 10:
            last[0] = time.monotonic()
            print(what, file=sys.stderr)

    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        write_study(directory, trials=100)
        report = fuzz(directory, Store.url_in(directory), given_options.messages, tell)
    counts = report.counts
    print(f"sent: {counts.forms:,} forms and {counts.messages:,} messages")
    print(f"answers: {dict(sorted(counts.answers.items()))}")
    print(f"closed: {dict(sorted(counts.closed.items()))}")
    print(f"sessions: {report.sessions:,}, all readable")
    print(f"memory of the server: {report.memory[0]:.0f} MB, then {report.memory[1]:.0f} MB")
    print(f"witnesses: {report.acknowledged:,} events acknowledged")
    for problem in [*counts.errors, *report.witnesses][:20]:
        print(f"PROBLEM {problem}")
    print(f"{time.monotonic() - began:.0f} s; {'good' if report.is_good else 'NOT GOOD'}")
    return 0 if report.is_good else 1


if __name__ == "__main__":
    sys.exit(main())
