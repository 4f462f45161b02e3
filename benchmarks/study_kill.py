"""A study whose servers are killed again and again, and what is left of it.

    python benchmarks/study_kill.py                          50 kills, 20 live sessions, SQLite
    python benchmarks/study_kill.py --postgres --servers 2   on PostgreSQL, with two processes

SIGKILL comes at random moments. At the end every session is brought to its debrief. Checked are:
everything that a server acknowledged is stored; every session went on; the numbers of sessions in
the conditions differ by one at most, after every kill; every stored belief and decision is what is
computed again.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from study_postgres import free_port, postgres
from study_visitor import Problem, Visitor, missing

from coadapt.study.protocol import Study, read_study
from coadapt.study.protocol.reader import FILE, template
from coadapt.study.record import Stored
from coadapt.study.replay import replay
from coadapt.study.robots import load_robots
from coadapt.study.session import replayed
from coadapt.study.store import Row, Store

START = 120.0
"""Seconds for a server to start."""

FINISH = 600.0
"""Seconds for all sessions to come to their end."""


@dataclass(frozen=True)
class Report:
    """What became of the study.

    Attributes:
        kills: number of servers killed.
        sessions: number of sessions.
        finished: of them, at the debrief.
        acknowledged: number of events that servers acknowledged.
        missing: those that are not stored.
        imbalance: largest difference of the numbers of sessions in two conditions, ever.
        differences: of a computation of all beliefs and decisions from what is stored.
        attempts: number of attempts at training sessions and trials that were begun.
        lost: how often a participant lost a server.
        problems: what servers did that they must not do.
        seconds: how long it took.
    """

    kills: int
    sessions: int
    finished: int
    acknowledged: int
    missing: Sequence[str]
    imbalance: int
    differences: int
    attempts: int
    lost: int
    problems: Sequence[str]
    seconds: float

    @property
    def is_good(self) -> bool:
        """Whether nothing was lost."""
        return (
            not self.missing
            and not self.problems
            and self.imbalance <= 1
            and self.differences == 0
            and self.finished == self.sessions > 0
            and self.acknowledged > 0
        )


class Server:
    """A server in a process of its own, at one address through all its lives."""

    def __init__(self, directory: Path, url: str, durability: str = "power") -> None:
        self._directory, self._url, self._durability = directory, url, durability
        self.port = free_port()
        self.address = f"http://127.0.0.1:{self.port}"
        self._process: subprocess.Popen[str] | None = None

    async def start(self) -> None:
        """Start, and wait until requests are taken."""
        program = "import sys; from coadapt.cli import main; sys.exit(main())"
        command = [sys.executable, "-c", program, "study", "serve", f"{self._directory}"]
        command += ["--port", f"{self.port}", "--database", self._url]
        command += ["--durability", self._durability]
        self._process = subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            text=True,
            # The first line tells that requests are taken.
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )
        assert self._process.stdout is not None
        line = await asyncio.wait_for(
            asyncio.to_thread(self._process.stdout.readline), timeout=START
        )
        if not line.startswith("Participants:"):
            raise RuntimeError("the server did not start")

    def cpu_seconds(self) -> float:
        """What it has used of processors so far."""
        assert self._process is not None
        fields = Path(f"/proc/{self._process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def memory_mb(self) -> float:
        """The memory it holds, in MB of 2**20 bytes."""
        assert self._process is not None
        pages = int(Path(f"/proc/{self._process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / (1 << 20)

    def end(self, how: signal.Signals) -> None:
        """End it, and wait until it is gone."""
        if self._process is not None:
            self._process.send_signal(how)
            self._process.wait()
            assert self._process.stdout is not None
            self._process.stdout.close()
            self._process = None


async def kill_and_look(
    directory: Path, url: str, *, kills: int, live: int, servers: int, seed: int
) -> Report:
    """Run the study in ``directory`` while its servers are killed.

    Args:
        directory: of the study, with its protocol.
        url: of its database.
        kills: how often a server is killed.
        live: how many participants there are at any time.
        servers: number of processes that serve the study.
        seed: of the participants and of the moments.
    """
    began = time.monotonic()
    study = read_study(directory)
    load_robots(study, directory)
    store = Store(url)
    processes = [Server(directory, url) for _ in range(servers)]
    for server in processes:
        await server.start()
    rng = np.random.default_rng(seed)
    visitors: list[Visitor] = []
    problems: list[str] = []
    stopping = False
    imbalance = 0

    async def participants(rng: np.random.Generator) -> None:
        """One after the other."""
        while not stopping:
            addresses = [server.address for server in processes]
            visitor = Visitor(study, addresses, f"person-{len(visitors)}", rng)
            visitors.append(visitor)
            try:
                await visitor.go()
            except Problem as problem:
                problems.append(f"{problem}")

    tasks = [asyncio.create_task(participants(child)) for child in rng.spawn(live)]
    for i in range(kills):
        await asyncio.sleep(float(rng.uniform(0.2, 2.0)))
        server = processes[int(rng.integers(servers))]
        server.end(signal.SIGKILL)
        imbalance = max(imbalance, imbalance_of(study, store.rows()))
        await server.start()
        print(f"kill {i + 1} of {kills}: {len(visitors)} sessions", file=sys.stderr)
    stopping = True
    async with asyncio.timeout(FINISH):
        await asyncio.gather(*tasks)
    for server in processes:
        server.end(signal.SIGTERM)
    rows = {row.key: row for row in store.rows()}
    imbalance = max(imbalance, imbalance_of(study, list(rows.values())))
    lacking: list[str] = []
    attempts = 0
    for visitor in visitors:
        events = store.events(rows[visitor.key].id) if visitor.key in rows else []
        lacking += [
            f"{visitor.participant}: {what}" for what in missing(visitor.acknowledged, events)
        ]
        replayed(study, [kept.event for kept in events])
        if [kept.sequence for kept in events] != list(range(1, len(events) + 1)):
            problems.append(f"{visitor.participant}: the events are not numbered one by one")
        attempts += sum(type(kept.event).__name__ == "Began" for kept in events)
    store.close()
    return Report(
        kills=kills,
        sessions=len(visitors),
        finished=sum(
            visitor.key in rows and rows[visitor.key].digest.end == "finished"
            for visitor in visitors
        ),
        acknowledged=sum(len(visitor.acknowledged) for visitor in visitors),
        missing=lacking,
        imbalance=imbalance,
        differences=differences(directory, url),
        attempts=attempts,
        lost=sum(visitor.losses for visitor in visitors),
        problems=problems,
        seconds=time.monotonic() - began,
    )


def imbalance_of(study: Study, rows: Sequence[Row]) -> int:
    """Largest difference of the numbers of sessions in two conditions."""
    counts = Counter(row.digest.condition for row in rows)
    of_each = [counts[condition.name] for condition in study.conditions]
    return max(of_each) - min(of_each)


def differences(directory: Path, url: str) -> int:
    """How many stored beliefs and decisions are not computed again."""
    study, store = read_study(directory), Store(url)
    try:
        robots = load_robots(study, directory)
        return len(replay(Stored.of(directory, study, store), robots).differences)
    finally:
        store.close()


def write_study(directory: Path, trials: int = 3, most_steps: int = 60) -> None:
    """A quick study on the small table, without quotas."""
    text = template().decode()
    for old, new in (
        ('task = "table_clearing" ', 'task = "table_clearing_small" '),
        ("step = 0.5 ", "step = 0.1 "),
        ("trials = 3", f"trials = {trials}"),
        ("most_steps = 200", f"most_steps = {most_steps}"),
        ("quota = 17\n", ""),
    ):
        assert old in text
        text = text.replace(old, new)
    directory.joinpath(FILE).write_text(text, encoding="utf-8")


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n", maxsplit=1)[0])
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--live", type=int, default=20)
    parser.add_argument("--servers", type=int, default=1)
    parser.add_argument("--postgres", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    with contextlib.ExitStack() as stack:
        directory = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        url = stack.enter_context(postgres()) if given.postgres else Store.url_in(directory)
        write_study(directory)
        report = asyncio.run(
            kill_and_look(
                directory,
                url,
                kills=given.kills,
                live=given.live,
                servers=given.servers,
                seed=given.seed,
            )
        )
    for name, value in vars(report).items():
        print(f"{name}: {value if not isinstance(value, float) else round(value, 1)}")
    print("good" if report.is_good else "NOT GOOD")
    return 0 if report.is_good else 1


if __name__ == "__main__":
    sys.exit(main())
