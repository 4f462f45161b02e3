"""How building and solving grow with the size of a shared-autonomy problem.

    python benchmarks/scale.py
    python benchmarks/scale.py --largest 100000 --series cells hidden

A robot moves in a room of ``2 R x R`` cells; ``G`` goals stand in a fan, all ``--distance`` moves
away (or ``R - 1`` if that is less), and worth 10 to 11; the other parameters are the package's own.
Problems are solved to a relative gap of 1 %. Three series vary one size
each; the last problem has 20,000 cells, 8 goals and 11 values of alpha, 1.76 million states.
Every problem is solved in a process of its own, so that its peak of memory is its own.

Writes ``scale.csv`` and ``scale.svg`` to ``--out``. The plot's thin dashed lines are what is
predicted from the first problem of each series: memory and initial bounds in proportion to the
numbers of the reward, ``|X| |A| |Y|``. How long the search takes after that is the problem's own.
Where it did not close the gap the point is hollow.
"""

from __future__ import annotations

import argparse
import csv
import json
import subprocess
import sys
import time
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

Row = dict[str, Any]

TIME_LIMIT = 600.0
"""Seconds of search; a process that takes `PATIENCE` times as long is ended."""

PATIENCE = 3

FIRST_REWARD, LAST_REWARD = 10.0, 11.0

DISTANCE = 20
"""Moves from the start to a goal."""


@dataclass(frozen=True)
class Case:
    """One problem.

    Attributes:
        series: which size it varies.
        rows: ``R``; the room has ``2 R x R`` cells.
        goals: ``G``, at least 2.
        alphas: number of values of alpha, evenly from 0 to 1.
        memory: ``k``.
        distance: moves from the start to a goal.
    """

    series: str
    rows: int
    goals: int
    alphas: int
    memory: int = 1
    distance: int = DISTANCE


CASES = (
    *(Case("cells", rows, 4, 5) for rows in (22, 32, 45, 64, 100)),
    *(Case("hidden", 32, *size) for size in ((2, 5), (4, 5), (8, 5), (8, 11))),
    *(Case("memory", 22, 2, 5, k) for k in (1, 2, 3)),
    Case("large", 100, 8, 11),
)


def model_of(case: Case) -> Any:
    """The model of ``case``."""
    import numpy as np

    import coadapt as ca

    distance = min(case.distance, case.rows - 1)
    goals: list[tuple[str, tuple[int, int], float]] = []
    for i in range(case.goals):
        share = i / (case.goals - 1)
        aside = round((2 * share - 1) * 0.75 * distance)
        cell = (case.rows + aside, distance - abs(aside))
        goals.append((f"goal {i}", cell, FIRST_REWARD + (LAST_REWARD - FIRST_REWARD) * share))
    world = ca.worlds.grid(
        2 * case.rows, case.rows, (case.rows, 0), goals, actions=ca.worlds.FIVE_WAYS, name="room"
    )
    return ca.SharedAutonomy(
        world,
        memory=case.memory,
        adaptability=np.linspace(0, 1, case.alphas).tolist(),
    )


def states_of(case: Case) -> int:
    """About how many states the problem has: each step of memory multiplies them by 5 actions."""
    return 2 * case.rows**2 * case.goals * case.alphas * 5 ** (case.memory - 1)


def run(case: Case, time_limit: float) -> Row:
    """Build and solve ``case`` in this process."""
    import coadapt as ca
    from coadapt.cli.process import peak_memory_mb

    # Compile, or read from the cache, outside of the measurement.
    ca.SARSOP(gap=1e-2).solve(ca.SharedAutonomy(ca.worlds.table_clearing(5, 2)).to_momdp())
    at_rest = peak_memory_mb()
    start = time.perf_counter()
    problem = model_of(case).to_momdp()
    built, memory_built = time.perf_counter(), peak_memory_mb()
    solution = ca.SARSOP(relative_gap=0.01, time_limit=time_limit).solve(problem)
    observed, hidden, actions, observations = problem.shape
    return {
        **asdict(case),
        "observed": observed,
        "hidden": hidden,
        "actions": actions,
        "observations": observations,
        "states": problem.states,
        "build_seconds": built - start,
        "bounds_seconds": solution.trace[0].seconds,
        "solve_seconds": solution.seconds,
        "first_lower": solution.trace[0].lower,
        "first_upper": solution.trace[0].upper,
        "status": solution.status.value,
        "lower": solution.lower,
        "upper": solution.upper,
        "gap": solution.gap,
        "backups": solution.backups,
        "vectors": solution.vectors,
        "rest_megabytes": at_rest,
        "build_megabytes": memory_built,
        "peak_megabytes": peak_memory_mb(),
    }


def run_apart(case: Case, time_limit: float) -> Row:
    """`run` in a process of its own; of one that fails only the status is known."""
    command = [sys.executable, __file__, "--case", json.dumps(asdict(case))]
    command += ["--time-limit", str(time_limit)]
    try:
        done = subprocess.run(
            command, stdout=subprocess.PIPE, timeout=PATIENCE * time_limit, check=False
        )
    except subprocess.TimeoutExpired:
        return {**asdict(case), "status": "ended: took too long"}
    if done.returncode != 0:
        return {**asdict(case), "status": f"ended with code {done.returncode}"}
    return json.loads(done.stdout)


def write_csv(rows: Sequence[Row], path: Path) -> None:
    """All rows; what is not known is empty."""
    columns = list(max(rows, key=len))
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def predicted(row: Row) -> float:
    """Number to which seconds of the initial bounds and megabytes should be in proportion."""
    return row["observed"] * row["actions"] * row["hidden"]


def _fill(row: Row, color: str) -> str:
    """Hollow where the gap was not closed."""
    return color if row["status"] == "gap" else "white"


def plot(rows: Iterable[Row], path: Path) -> None:
    """Seconds and memory over the number of states, with what is predicted."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 4), layout="constrained")
    seconds, memory = figure.subplots(1, 2)
    by_series: dict[str, list[Row]] = {}
    for row in rows:
        if "states" in row:
            by_series.setdefault(row["series"], []).append(row)
    for i, (series, members) in enumerate(by_series.items()):
        states = [row["states"] for row in members]
        size = [predicted(row) for row in members]
        used = [row["peak_megabytes"] - row["rest_megabytes"] for row in members]
        color = f"C{i}"
        for key, line in (("solve", "-"), ("bounds", "-."), ("build", ":")):
            taken = [row[f"{key}_seconds"] for row in members]
            seconds.plot(states, taken, line, color=color, label=f"{series}: {key}")
            if key == "bounds":
                seconds.plot(states, [taken[0] * n / size[0] for n in size], "--", c=color, lw=0.7)
            if key == "solve":
                seconds.scatter(
                    states, taken, color=[_fill(row, color) for row in members], ec=color
                )
        memory.plot(states, used, color=color, label=series)
        memory.scatter(states, used, color=[_fill(row, color) for row in members], ec=color)
        memory.plot(states, [used[0] * n / size[0] for n in size], "--", color=color, lw=0.7)
    for axes, label in ((seconds, "seconds"), (memory, "peak memory beyond rest, MB")):
        axes.set(xscale="log", yscale="log", xlabel="states |X| |Y|", ylabel=label)
        axes.legend(fontsize=7)
    figure.savefig(path)


def main() -> int:
    """Run the benchmark, or the one problem that ``--case`` describes."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "results")
    parser.add_argument("--largest", type=int, help="leave out problems of more states")
    parser.add_argument("--series", nargs="+", choices=sorted({case.series for case in CASES}))
    parser.add_argument("--distance", type=int, default=DISTANCE, help="moves to a goal")
    parser.add_argument("--time-limit", type=float, default=TIME_LIMIT)
    parser.add_argument("--case", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.case is not None:
        print(json.dumps(run(Case(**json.loads(given.case)), given.time_limit)))
        return 0
    given.out.mkdir(parents=True, exist_ok=True)
    run_apart(Case("first", 5, 2, 2), given.time_limit)  # the kernels are compiled here
    rows: list[Row] = []
    for case in (replace(case, distance=given.distance) for case in CASES):
        too_large = given.largest is not None and states_of(case) > given.largest
        if too_large or (given.series and case.series not in given.series):
            continue
        rows.append(run_apart(case, given.time_limit))
        print(" ".join(f"{key}={value}" for key, value in rows[-1].items()), flush=True)
        write_csv(rows, given.out / "scale.csv")
        plot(rows, given.out / "scale.svg")
    return 0 if all("states" in row for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
