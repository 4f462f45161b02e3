"""Sweeps that are killed: is the table the same to the byte as that of one left alone?

    python benchmarks/sweep_kill.py [--out DIR]

Runs a sweep of 1,000 cells

* without interruption, in one process and in two;
* killed with SIGKILL after a third and after two thirds of the cells, and resumed;
* on a Dask cluster of a scheduler and three workers, all processes of their own, of which one
  is killed halfway.

Prints one JSON object: seconds, cells that were run more than once, worker processes that outlived
the killed program, and the SHA-256 of each table. The exit code is 1 unless all tables are alike.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

import psutil

SWEEP = """
format = 1
name = "kill test"
seed = 3
episodes = 1000
exact = true
tolerance = 0.01

[[grid]]
columns = 7
rows = 3
disagreement_cost = { from = -0.6, to = -0.02, count = 25 }
reward_gap = { from = 0.1, to = 2.0, count = 20 }
partner = { adaptability = [0, 1], mode = "other" }
"""

CELLS = 1000

PROGRAM = "import sys; from coadapt.cli import main; sys.exit(main())"

QUIET = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


@dataclass(frozen=True)
class Case:
    """A sweep to run in several ways.

    Attributes:
        path: its file.
        cells: the number of its cells.
    """

    path: Path
    cells: int

    @contextmanager
    def running(self, out: Path, *options: str) -> Generator[subprocess.Popen[bytes]]:
        """`coadapt sweep` in a process of its own, which ends with the block."""
        command = [sys.executable, "-c", PROGRAM, "sweep", str(self.path), "--out", str(out)]
        with subprocess.Popen(
            [*command, "--quiet", *options], stdout=subprocess.DEVNULL
        ) as process:
            try:
                yield process
            finally:
                process.kill()

    def alone(self, out: Path, *options: str) -> dict[str, object]:
        """Without interruption."""
        begin = time.perf_counter()
        with self.running(out, *options) as process:
            assert process.wait() == 0
        return result(out, begin)

    def killed_twice(self, out: Path, *options: str) -> dict[str, object]:
        """Killed after a third and after two thirds, and resumed."""
        begin, survivors, left = time.perf_counter(), 0, list[int]()
        for part in (1 / 3, 2 / 3):
            with self.running(out, *options) as process:
                self.wait_for(out, part)
                children = psutil.Process(process.pid).children(recursive=True)
                process.kill()
                process.wait()
                _, alive = psutil.wait_procs(children, timeout=20)
                survivors += len(alive)
                left.append(self.cells - finished(out))
        with self.running(out, *options) as process:
            assert process.wait() == 0
        return result(out, begin) | {"left at each kill": left, "survivors": survivors}

    def on_dask(self, place: Path, out: Path, workers: int) -> dict[str, object]:
        """On a cluster of which a worker is killed halfway."""
        with cluster(place, workers) as (address, processes):
            begin = time.perf_counter()
            with self.running(out, "--dask", address) as process:
                self.wait_for(out, 1 / 2)
                for victim in family(processes[0]):
                    victim.kill()
                left = self.cells - finished(out)
                assert process.wait() == 0
            return result(out, begin) | {"left at the kill": left}

    def wait_for(self, out: Path, part: float) -> None:
        """Until that part of the cells is finished."""
        while finished(out) < part * self.cells:
            time.sleep(0.01)


def main() -> int:
    """Run everything and print what was measured."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, help="keep the results here")
    out: Path | None = parser.parse_args().out
    with TemporaryDirectory() as temporary:
        place = out or Path(temporary)
        place.mkdir(parents=True, exist_ok=True)
        path = place / "sweep.toml"
        path.write_text(SWEEP)
        case = Case(path, CELLS)
        found = {
            "one process": case.alone(place / "one", "--jobs", "1"),
            "two processes": case.alone(place / "two", "--jobs", "2"),
            "killed twice": case.killed_twice(place / "killed", "--jobs", "2"),
            "dask, a worker killed": case.on_dask(place, place / "dask", 3),
        }
    print(json.dumps(found, indent=2))
    return 0 if len({entry["sha256"] for entry in found.values()}) == 1 else 1


def finished(out: Path) -> int:
    """The number of finished cells in a directory."""
    cells = out / "cells"
    names = os.listdir(cells) if cells.is_dir() else []
    return sum(not name.startswith(".") for name in names)


def result(out: Path, begin: float) -> dict[str, object]:
    """Seconds since ``begin``, and what the directory says."""
    seconds = time.perf_counter() - begin
    events = [json.loads(line) for line in (out / "log.jsonl").read_text().splitlines()]
    runs = Counter(event["cell"] for event in events if event["event"] == "cell")
    tables = b"".join((out / name).read_bytes() for name in ("results.parquet", "results.csv"))
    return {
        "seconds": round(seconds, 1),
        "cells": finished(out),
        "run more than once": sum(count > 1 for count in runs.values()),
        "plans": sum(event["event"] == "plan" for event in events),
        "sha256": sha256(tables).hexdigest(),
    }


@contextmanager
def cluster(place: Path, count: int) -> Generator[tuple[str, Sequence[subprocess.Popen[bytes]]]]:
    """A Dask scheduler and workers as processes of their own: its address, and the workers."""
    file = place / "scheduler.json"
    local = ["--scheduler-file", str(file), "--host", "127.0.0.1", "--no-dashboard"]
    dask = [sys.executable, "-m", "dask"]
    processes = [subprocess.Popen([*dask, "scheduler", *local, "--port", "0"], **QUIET)]
    try:
        while not file.exists():
            assert processes[0].poll() is None
            time.sleep(0.1)
        for i in range(count):
            options = ["--nthreads", "1", "--local-directory", str(place / f"worker{i}")]
            processes.append(subprocess.Popen([*dask, "worker", *local, *options], **QUIET))
        yield json.loads(file.read_text())["address"], processes[1:]
    finally:
        members = [member for process in processes for member in family(process)]
        for member in members:
            member.terminate()
        _, alive = psutil.wait_procs(members, timeout=10)
        for member in alive:
            member.kill()
        for process in processes:
            process.wait()


def family(process: subprocess.Popen[bytes]) -> list[psutil.Process]:
    """A process and all that it started: a Dask worker has a nanny, which would revive it."""
    try:
        first = psutil.Process(process.pid)
        return [first, *first.children(recursive=True)]
    except psutil.NoSuchProcess:
        return []


if __name__ == "__main__":
    sys.exit(main())
