"""The parts that decide how many participants a study can have, each by itself.

    python benchmarks/study_parts.py               all parts
    python benchmarks/study_parts.py --no-postgres

Measured are: the database, by the size of the groups that are committed together; allocation, by
the number of sessions; the decisions of a robot; what a participant takes on the disk. How many
sessions one process carries is measured by `study_load.py`.
"""

from __future__ import annotations

import argparse
import contextlib
import multiprocessing
import secrets
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from sqlalchemy import insert, text
from study_kill import write_study
from study_postgres import postgres

from coadapt.study.protocol import Study, read_study
from coadapt.study.robots import Robots, load_robots
from coadapt.study.seeds import attempt_rng
from coadapt.study.server.standings import allocate_session
from coadapt.study.session import Event, Session, Stage, encode_event
from coadapt.study.session.events import Opened, Pressed
from coadapt.study.store import Addition, Durability, Store
from coadapt.study.store.schema import SESSIONS
from coadapt.study.trial import Attempt

SECONDS = 3.0
"""For each measurement."""

INPUTS_PER_STEP = 5
"""Ten inputs and two steps a second."""

GROUPS = (1, 10, 100, 500)

PLACES = (100, 1_000, 10_000, 100_000)

PROCESSES = (1, 2, 4)
"""That write to one PostgreSQL."""


def usual_events(robots: Robots) -> list[Event]:
    """Inputs and a step, in the usual proportion."""
    robot = robots["mutual_adaptation", 0]
    attempt = Attempt(robot, Stage("trial"), 1, None, np.random.default_rng(0), 100)
    events: list[Event] = [
        Pressed(
            input=i % 3, device="gamepad", sequence=1000 + i, page_time=123.4567, device_time=123.45
        )
        for i in range(INPUTS_PER_STEP)
    ]
    return [*events, attempt.step(0)]


def add_sessions(store: Store, count: int) -> list[int]:
    """The numbers of new sessions."""
    prefix = secrets.token_hex(8)
    with store.database.writing() as connection:
        for i in range(count):
            store.add_session(connection, f"{prefix}{i}", None, Opened(parameters={}))
        query = text("SELECT id FROM sessions WHERE key LIKE :wanted")
        return [number for (number,) in connection.execute(query, {"wanted": f"{prefix}%"})]


def write_rows(url: str, durability: Durability, group: int, events: Sequence[Event]) -> float:
    """Rows a second, in groups of ``group`` sessions with one event each."""
    store = Store(url, durability)
    numbers = add_sessions(store, group)
    rows, began = 0, time.perf_counter()
    while (took := time.perf_counter() - began) < SECONDS:
        sequence = rows // group + 2
        event = events[sequence % len(events)]
        with store.database.writing() as connection:
            store.append(connection, [Addition(n, sequence, 1.5e9, [event]) for n in numbers])
        rows += group
    store.close()
    return rows / took


def write_side_by_side(url: str, processes: int, group: int, events: Sequence[Event]) -> float:
    """Rows a second of several processes together, on PostgreSQL."""
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        tasks = [(url, "power", group, events)] * processes
        return sum(pool.starmap(write_rows, tasks))


def allocation_times(study: Study, url: str) -> None:
    """Milliseconds of one allocation among so many."""
    store = Store(url, "process")
    names = [condition.name for condition in study.conditions]
    done = 0
    for places in PLACES:
        with store.database.writing() as connection:
            rows = [
                {
                    "key": f"allocated-{i}",
                    "created": 1.0,
                    "place": i + 1,
                    "condition": names[i % len(names)],
                    "choice": i % 2,
                    "device": "keyboard",
                    "end": "finished" if i % 2 else None,
                }
                for i in range(done, places)
            ]
            connection.execute(insert(SESSIONS), rows)
            connection.execute(
                text(
                    "INSERT INTO events (session, sequence, time, kind, data) "
                    "SELECT id, 1, :now, 'opened', :data FROM sessions WHERE place > :done"
                ),
                {
                    "now": time.time(),
                    "data": encode_event(Opened(parameters={})).decode(),
                    "done": done,
                },
            )
        done = places
        took = []
        for _ in range(5):
            began = time.perf_counter()
            with store.database.reading() as connection:
                allocate_session(study, store, connection, Session(choice=0))
            took.append(time.perf_counter() - began)
        print(f"  {places:8,} allocated: {min(took) * 1e3:9.1f} ms")
    store.close()


def decision_time(robots: Robots) -> float:
    """Seconds of one decision of the robot with mutual adaptation, with its event."""
    robot, steps = robots["mutual_adaptation", 0], 0
    began = time.process_time()
    number = 0
    while (took := time.process_time() - began) < SECONDS:
        number += 1
        stage = Stage("trial")
        attempt = Attempt(robot, stage, 1, None, attempt_rng("a", stage, number), 100)
        while not attempt.done:
            encode_event(attempt.step(steps % 3))
            steps += 1
    return took / steps


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n", maxsplit=1)[0])
    parser.add_argument("--no-postgres", action="store_true")
    parser.add_argument("--directory", type=Path, help="for the database, on the disk to measure")
    given = parser.parse_args()
    with contextlib.ExitStack() as stack:
        name = stack.enter_context(tempfile.TemporaryDirectory(dir=given.directory))
        directory = Path(name)
        write_study(directory)
        study = read_study(directory)
        robots = load_robots(study, directory)
        events = usual_events(robots)
        sizes = [len(encode_event(event)) for event in events]
        print(f"an input: {sizes[0]} bytes of JSON; a step: {sizes[-1]}")
        print(f"a decision with its event: {decision_time(robots) * 1e6:.0f} us of processor")
        durabilities: tuple[Durability, ...] = ("power", "process")
        for durability in durabilities:
            print(f"SQLite, safe from the end of a {durability}, rows a second:")
            for group in GROUPS:
                url = f"sqlite:///{directory / f'{durability}-{group}.db'}"
                print(f"  {group:4} together: {write_rows(url, durability, group, events):10,.0f}")
        file = directory / "power-500.db"
        store = Store(f"sqlite:///{file}")
        with store.database.reading() as connection:
            rows = connection.execute(text("SELECT count(*) FROM events")).scalar_one()
        store.close()
        print(f"on the disk: {file.stat().st_size / rows:.0f} bytes an event")
        print("SQLite, one allocation:")
        allocation_times(study, f"sqlite:///{directory / 'allocation.db'}")
        if not given.no_postgres:
            url = stack.enter_context(postgres())
            print("PostgreSQL, one process, rows a second:")
            for group in GROUPS:
                print(f"  {group:4} together: {write_rows(url, 'power', group, events):10,.0f}")
            print("PostgreSQL, several processes, 100 rows together, rows a second:")
            for processes in PROCESSES:
                rate = write_side_by_side(url, processes, 100, events)
                print(f"  {processes:4} processes: {rate:10,.0f}")
            print("PostgreSQL, one allocation:")
            store = Store(url)
            with store.database.writing() as connection:
                connection.execute(text("DELETE FROM events"))
                connection.execute(text("DELETE FROM sessions"))
            store.close()
            allocation_times(study, url)
    return 0


if __name__ == "__main__":
    sys.exit(main())
