"""Runs the two solvers that `solve.py` compares, and reads what they print.

Imports little: the most memory of a child process counts from that of its parent.
"""

from __future__ import annotations

import csv
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from comparison import Point, Run

PRECISION = 1e-3
"""The gap at which both solvers finish."""

PATIENCE = 5
"""The reference checks its time limit now and then only; it may take so many times as long."""

LOADING = 300
"""Seconds granted for reading a problem."""

COADAPT = [sys.executable, "-c", "import sys; from coadapt.cli import main; sys.exit(main())"]

ROW = re.compile(r"^\s*" + r"\s+".join([r"([-+.\deE]+|-?inf|-?nan)"] * 8) + r"\s*$")
"""A line of the reference's table: time, trials, backups, lower, upper, precision, vectors,
beliefs."""


class Failed(Exception):
    """A solver gave no result; the message is its last line."""


@dataclass(frozen=True)
class Ended:
    """A process that has ended: its exit code, outputs and use of the machine."""

    code: int
    out: str
    err: str
    cpu_seconds: float
    wall_seconds: float
    memory_mb: float


def run_process(
    command: Sequence[str], scratch: Path, limit: float, environment: dict[str, str] | None = None
) -> Ended:
    """Run ``command``; it is killed after ``limit`` seconds, what it printed is kept."""
    out, err = scratch / "out.txt", scratch / "err.txt"
    with out.open("w") as out_file, err.open("w") as err_file:
        begin = time.monotonic()
        process = subprocess.Popen(command, stdout=out_file, stderr=err_file, env=environment)
        deadline = begin + limit
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() > deadline:
                process.send_signal(signal.SIGKILL)
                deadline = float("inf")
            time.sleep(0.005)
        seconds = time.monotonic() - begin
        process.returncode = os.waitstatus_to_exitcode(status)
    per_mb = 1 << 20 if sys.platform == "darwin" else 1 << 10
    return Ended(
        process.returncode,
        out.read_text(errors="replace"),
        err.read_text(errors="replace"),
        usage.ru_utime + usage.ru_stime,
        seconds,
        usage.ru_maxrss / per_mb,
    )


def run_reference(program: Path, problem: Path, seconds: float, scratch: Path) -> Run:
    """Let the reference solve ``problem`` for ``seconds``.

    Raises:
        Failed: if it prints no bounds.
    """
    limits = ["--precision", f"{PRECISION}", "--timeout", f"{seconds}"]
    command = [str(program), *limits, "--output", str(scratch / "reference.policy"), str(problem)]
    ended = run_process(command, scratch, PATIENCE * seconds + LOADING)
    return parse_reference(ended)


def parse_reference(ended: Ended) -> Run:
    """The run that the reference printed.

    Raises:
        Failed: if there are no bounds in it.
    """
    rows = [m.groups() for m in map(ROW.match, ended.out.splitlines()) if m is not None]
    if not rows:
        lines = [line for line in (ended.err + ended.out).splitlines() if line.strip()]
        raise Failed(lines[-1].strip() if lines else f"exit code {ended.code}")
    trace = tuple(Point(float(row[0]), float(row[3]), float(row[4])) for row in rows)
    loading = re.search(r"loading time\s*:\s*([\d.eE+-]+)", ended.out)
    finished = "target precision reached" in ended.out
    return Run(
        trace=trace,
        finished=finished,
        seconds=trace[-1].seconds,
        load_seconds=float(loading[1]) if loading else 0.0,
        vectors=int(rows[-1][6]),
        backups=int(rows[-1][2]),
        memory_mb=ended.memory_mb,
        status="gap" if finished else "time" if ended.code == 0 else f"exit code {ended.code}",
        cpu_seconds=ended.cpu_seconds,
        wall_seconds=ended.wall_seconds,
    )


def run_ours(problem: Path, seconds: float, scratch: Path) -> tuple[Run, Path]:
    """Let ``coadapt solve`` work on ``problem`` for ``seconds``: the run and the policy.

    Raises:
        Failed: if it ends with an error.
    """
    policy, trace = scratch / "ours.coadapt", scratch / "trace.csv"
    files = ["--out", str(policy), "--trace", str(trace)]
    limits = ["--time-limit", f"{seconds}", "--gap", f"{PRECISION}"]
    found, ended = coadapt("solve", str(problem), *limits, *files, scratch=scratch)
    with trace.open(newline="") as file:
        points = tuple(
            Point(float(row["seconds"]), float(row["lower"]), float(row["upper"]))
            for row in csv.DictReader(file)
        )
    run = Run(
        trace=points,
        finished=found["status"] == "gap",
        seconds=found["seconds"],
        load_seconds=found["load_seconds"],
        vectors=found["vectors"],
        backups=found["backups"],
        memory_mb=found["peak_memory_mb"],
        status=found["status"],
        cpu_seconds=ended.cpu_seconds,
        wall_seconds=ended.wall_seconds,
    )
    return run, policy


def coadapt(
    *arguments: str, scratch: Path, environment: dict[str, str] | None = None
) -> tuple[dict[str, Any], Ended]:
    """Run a command of coadapt with ``--json``: the object it prints.

    Raises:
        Failed: if it ends with an error.
    """
    everything = {**os.environ, **(environment or {})}
    ended = run_process([*COADAPT, *arguments, "--json", "--quiet"], scratch, 86_400, everything)
    if ended.code != 0:
        raise Failed((ended.err.strip() or f"exit code {ended.code}").splitlines()[-1])
    return json.loads(ended.out), ended
