"""How many participants one server process carries.

    python benchmarks/study_load.py              500 sessions, 10 inputs a second each, SQLite
    python benchmarks/study_load.py --postgres   the same on PostgreSQL
    python benchmarks/study_load.py --sessions 100 200 400 --seconds 30

Every session steers trials with a decision every 0.5 s, as in the protocol that `coadapt study new`
writes, and presses or lets go ten times a second. The server has one core to itself; participants
and PostgreSQL have the others. Everything is stored as in a real study, safe from a loss of power
unless `--durability process` is given.

Printed are, in milliseconds: from an input to `Stored`, from the first input of a trial to the
first `Step`, and how late the later steps are; and how much of its core the server used.
"""

from __future__ import annotations

import argparse
import asyncio
import base64
import contextlib
import os
import resource
import signal
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import msgspec
import numpy as np
from study_kill import Server
from study_postgres import postgres

from coadapt.study.protocol import Study, read_study
from coadapt.study.protocol.reader import FILE, template
from coadapt.study.robots import load_robots
from coadapt.study.server.service import Service
from coadapt.study.session.events import Checked, Chose, Consented, Event, Read
from coadapt.study.session.machine import stage_of
from coadapt.study.store import Store

INPUTS = 10.0
"""A second, of each session."""

SETTLE = 5.0
"""Seconds before anything is counted."""

INPUT = '{{"type":"input","input":{},"device":"gamepad","sequence":{},"page_time":{:.4f}}}'


@dataclass
class Measured:
    """What the participants saw, in seconds.

    Attributes:
        stored: from an input to its `Stored`.
        first: from the first input of a trial to the first `Step`.
        late: of later steps, behind the first one and the clock.
        steps: number of steps.
        trials: number of trials that came to their end.
        refused: reasons of the server to end a connection.
    """

    stored: list[float] = field(default_factory=list[float])
    first: list[float] = field(default_factory=list[float])
    late: list[float] = field(default_factory=list[float])
    steps: int = 0
    trials: int = 0
    refused: list[str] = field(default_factory=list[str])


class Participant(asyncio.Protocol):
    """One connection, with as little work for the client as possible.

    The frames of RFC 6455 are masked with a mask of zeros, which leaves them as they are.
    """

    def __init__(self, key: str, port: int, step: float, measured: Measured, offset: float) -> None:
        self._key, self._port, self._step, self._measured = key, port, step, measured
        self._offset = offset
        self._loop = asyncio.get_running_loop()
        self._buffer = b""
        self._open = False
        self._playing = False
        self._sequence = 0
        self._sent: dict[int, float] = {}
        self._first_input: float | None = None
        self._first_step: tuple[int, float] | None = None
        self.counting = False
        self._transport: asyncio.Transport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Ask for a websocket."""
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        nonce = base64.b64encode(os.urandom(16)).decode()
        lines = [
            f"GET /s/{self._key}/steer HTTP/1.1",
            f"Host: 127.0.0.1:{self._port}",
            "Upgrade: websocket",
            "Connection: Upgrade",
            f"Sec-WebSocket-Key: {nonce}",
            "Sec-WebSocket-Version: 13",
        ]
        transport.write("\r\n".join([*lines, "", ""]).encode())

    def data_received(self, data: bytes) -> None:
        """Take what has come apart into messages."""
        self._buffer += data
        if not self._open:
            head, found, rest = self._buffer.partition(b"\r\n\r\n")
            if not found:
                return
            assert b" 101 " in head.split(b"\r\n", 1)[0], head
            self._open, self._buffer = True, rest
            self._say('{"type":"ready"}')
            self._press_at(self._loop.time() + self._offset)
        while len(self._buffer) >= 2:
            code, length, start = self._buffer[0] & 15, self._buffer[1] & 127, 2
            if length == 126:
                length, start = int.from_bytes(self._buffer[2:4], "big"), 4
            elif length == 127:
                length, start = int.from_bytes(self._buffer[2:10], "big"), 10
            if len(self._buffer) < start + length:
                return
            body = self._buffer[start : start + length]
            self._buffer = self._buffer[start + length :]
            if code == 1:
                self._hear(body)
            elif code == 9:
                self._frame(10, body)

    def close(self) -> None:
        """Leave."""
        self._open = False
        if self._transport is not None:
            self._transport.abort()

    def _hear(self, body: bytes) -> None:
        now = time.perf_counter()
        message = msgspec.json.decode(body)
        match message["type"]:
            case "stored":
                took = now - self._sent.pop(message["sequence"])
                if self.counting:
                    self._measured.stored.append(took)
            case "begun":
                self._playing, self._first_input, self._first_step = True, None, None
            case "step":
                self._measured.steps += self.counting
                self._see(message["step"], now)
            case "over":
                self._playing = False
                self._measured.trials += self.counting
                self._say('{"type":"ready"}')
            case "refused":
                self._measured.refused.append(message["reason"])
            case _:
                pass

    def _see(self, step: int, now: float) -> None:
        if self._first_step is None:
            self._first_step = (step, now)
            if self.counting and self._first_input is not None:
                self._measured.first.append(now - self._first_input)
        elif self.counting:
            first, then = self._first_step
            self._measured.late.append(now - then - (step - first) * self._step)

    def _press_at(self, due: float) -> None:
        """Press then, and again and again: by a clock of one's own.

        Were the next time counted from when this program came to it, everybody who was held up by
        one delay of it would press at the same moment ever after, which people do not.
        """
        self._loop.call_at(due, self._press, due)

    def _press(self, due: float) -> None:
        if not self._open:
            return
        self._press_at(due + 1 / INPUTS)
        if self._playing:
            self._sequence += 1
            given = "null" if self._sequence % 2 == 0 else f"{self._sequence // 2 % 3}"
            now = time.perf_counter()
            self._sent[self._sequence] = now
            if self._first_input is None and given != "null":
                self._first_input = now
            self._say(INPUT.format(given, self._sequence, now))

    def _say(self, text: str) -> None:
        self._frame(1, text.encode())

    def _frame(self, code: int, body: bytes) -> None:
        length = len(body)
        head = bytes([128 | code])
        if length < 126:
            head += bytes([128 | length])
        else:
            head += bytes([128 | 126]) + length.to_bytes(2, "big")
        assert self._transport is not None
        self._transport.write(head + b"\0\0\0\0" + body)


def write_study(directory: Path) -> None:
    """The template's study with as many trials as there can be, and nothing before them."""
    text = template().decode()
    for old, new in (
        ("trials = 3", "trials = 100"),
        ("practice = 2", "practice = 0"),
        ("quota = 17\n", ""),
    ):
        assert old in text
        text = text.replace(old, new)
    directory.joinpath(FILE).write_text(text, encoding="utf-8")


async def open_sessions(directory: Path, study: Study, url: str, count: int) -> list[str]:
    """The keys of ``count`` new sessions, at the first trial."""
    store = Store(url, "process")
    service = Service(study, load_robots(study, directory), store, directory)

    async def one() -> str:
        key = await service.open({})
        session = await service.session(key)
        while (stage := stage_of(study, session)) is not None and stage.kind != "trial":
            event: Event = Read(stage=stage)
            if stage.kind == "preflight":
                event = Checked(device="gamepad", width=800, height=600, latency=0.01, browser="")
            elif stage.kind == "consent":
                event = Consented()
            elif stage.kind == "choice":
                await service.record(key, Chose(goal=0))
                session = await service.allocate(key)
                continue
            session = await service.record(key, event)
        return key

    keys = list(await asyncio.gather(*(one() for _ in range(count))))
    await service.close()
    store.close()
    return keys


async def measure(server: Server, keys: list[str], step: float, seconds: float) -> Measured:
    """Let the sessions steer for so many seconds, and look."""
    measured = Measured()
    loop = asyncio.get_running_loop()
    participants: list[Participant] = []
    rng = np.random.default_rng(1)
    for key in keys:
        offset = float(rng.uniform(0, 1 / INPUTS))
        _, participant = await loop.create_connection(
            lambda key=key, offset=offset: Participant(key, server.port, step, measured, offset),
            "127.0.0.1",
            server.port,
        )
        participants.append(participant)
    await asyncio.sleep(SETTLE)
    for participant in participants:
        participant.counting = True
    before = server.cpu_seconds()
    own, began = resource.getrusage(resource.RUSAGE_SELF), time.perf_counter()
    await asyncio.sleep(seconds)
    took = time.perf_counter() - began
    used = server.cpu_seconds() - before
    after = resource.getrusage(resource.RUSAGE_SELF)
    client = after.ru_utime + after.ru_stime - own.ru_utime - own.ru_stime
    for participant in participants:
        participant.counting = False
    print(
        f"{len(keys)} sessions: {len(measured.stored) / took:,.0f} inputs and "
        f"{measured.steps / took:,.0f} steps a second, {measured.trials} trials ended; "
        f"the server used {used / took:.0%} of its core, {server.memory_mb():,.0f} MB; "
        f"this client {client / took:.0%}"
    )
    for name, times in (
        ("input to Stored", measured.stored),
        ("first input to first Step", measured.first),
        ("later steps behind the clock", measured.late),
    ):
        if times:
            cuts = np.percentile(np.array(times) * 1e3, [50, 90, 99, 99.9, 100])
            shown = "  ".join(f"{cut:7.1f}" for cut in cuts)
            print(f"  {name:30s} p50 p90 p99 p99.9 max [ms]: {shown}")
    for reason in sorted(set(measured.refused)):
        print(f"  REFUSED {measured.refused.count(reason)} times: {reason}")
    for participant in participants:
        participant.close()
    await asyncio.sleep(1)
    return measured


async def run(url: str, directory: Path, given: argparse.Namespace) -> None:
    """All sizes, one after the other."""
    study = read_study(directory)
    cores = sorted(os.sched_getaffinity(0))
    for count in given.sessions:
        keys = await open_sessions(directory, study, url, count)
        server = Server(directory, url, durability=given.durability)
        if len(cores) > 1:
            os.sched_setaffinity(0, cores[:1])  # what is started now inherits it
        await server.start()
        if len(cores) > 1:
            os.sched_setaffinity(0, cores[1:])
        try:
            await measure(server, keys, study.clock.step, given.seconds)
        finally:
            server.end(signal.SIGTERM)


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n", maxsplit=1)[0])
    parser.add_argument("--sessions", type=int, nargs="+", default=[500])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--durability", choices=["power", "process"], default="power")
    parser.add_argument("--postgres", action="store_true")
    parser.add_argument("--directory", type=Path, help="for the database, on the disk to measure")
    given = parser.parse_args()
    with contextlib.ExitStack() as stack:
        parent = given.directory
        directory = Path(stack.enter_context(tempfile.TemporaryDirectory(dir=parent)))
        url = stack.enter_context(postgres()) if given.postgres else Store.url_in(directory)
        write_study(directory)
        load_robots(read_study(directory), directory, lambda what: print(what, file=sys.stderr))
        asyncio.run(run(url, directory, given))
    return 0


if __name__ == "__main__":
    sys.exit(main())
