"""How a planning problem grows: measured against what the paper predicts (Sec. 7).

    python benchmarks/growth.py

The paper says that the number of states is linear in ``1 / dt`` and in the number of modes, and
that of observed states polynomial in the number of robot actions, ``O(|A_r|^k)``. Each is varied
alone:

* ``1 / dt``: a hand on a path of 1 m that forks into two of 1 m each, at 1 m/s. (On a table, of two
  dimensions, cells grow with the square.)
* modes: 2 to 16 goals in the same room of cells, four values of alpha.
* actions and memory: 2 to 5 directions in the same room, ``k`` of 1 to 4.

Printed and drawn are sizes, and the seconds of processor time to build the problem. Predicted for
memory is ``sum_{l < k-1} |A|^l + |X| |A|^(k-1)``, which also counts what lies beyond a goal and is
a little too large. Predicted seconds are in proportion to the size, through the last point.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import coadapt as ca

ROOM = 21, 11
"""Columns and rows of the room."""


@dataclass(frozen=True)
class Row:
    """One problem.

    Attributes:
        series: what is varied.
        line: the line of the plot it belongs to.
        value: of what is varied.
        size: observed states, or all states for dt and modes.
        predicted: size that the paper predicts.
        seconds: to build the planning problem, the least of three.
    """

    series: str
    line: str
    value: float
    size: int
    predicted: float
    seconds: float


def fork(steps: int) -> ca.worlds.World:
    """A path of ``steps`` states that parts into two of as many; the last states are goals."""
    count = 3 * steps
    stay = np.arange(count)
    moves = np.repeat(stay[:, None], 3, axis=1)  # left, forward, right
    forward = stay + 1
    forward[[steps - 1, 2 * steps - 1, count - 1]] = [steps - 1, 2 * steps - 1, count - 1]
    moves[:, 1] = forward
    moves[steps - 1, 0], moves[steps - 1, 2] = steps, 2 * steps
    return ca.worlds.World(
        name="fork",
        moves=moves,
        goals=(
            ca.worlds.Goal("left", 2 * steps - 1, 10.0),
            ca.worlds.Goal("right", count - 1, 11.0),
        ),
        start=0,
        state_names=tuple(f"state {x}" for x in range(count)),
        action_names=("left", "forward", "right"),
        positions=np.zeros((count, 2)),
        directions=np.zeros((3, 2)),
    )


def room(goals: int, actions: int) -> ca.worlds.World:
    """The room with goals along its walls."""
    columns, rows = ROOM
    along = [(c, rows - 1) for c in range(0, columns, 2)] + [(0, 1), (columns - 1, 1)]
    along += [(0, r) for r in range(3, rows - 2, 2)]
    ways = dict(list(ca.worlds.FIVE_WAYS.items())[:actions])
    return ca.worlds.grid(
        columns,
        rows,
        (columns // 2, 0),
        [(f"goal {g}", cell, 10.0 + g / goals) for g, cell in enumerate(along[:goals])],
        actions=ways,
    )


def measure(series: str, line: str, value: float, model: ca.SharedAutonomy, want: float) -> Row:
    """Build the problem of ``model`` three times."""
    taken: list[float] = []
    for _ in range(3):
        fresh = ca.SharedAutonomy(
            model.world,
            memory=model.memory,
            adaptability=model.adaptability,
            policies=model.modal_policies,
        )
        start = time.process_time()
        problem = fresh.to_momdp()
        taken.append(time.process_time() - start)
    size = problem.shape[0] if series == "memory" else problem.states
    return Row(series, line, value, size, want, min(taken))


def rows() -> list[Row]:
    """All problems."""
    found: list[Row] = []
    for steps in (10, 30, 100, 300, 1000):
        model = ca.SharedAutonomy(fork(steps))
        found.append(measure("dt", "path", steps, model, 3 * steps * 10))
    for goals in (2, 4, 8, 16):
        model = ca.SharedAutonomy(room(goals, 4), adaptability=(0, 0.4, 0.7, 1))
        found.append(measure("modes", "room", goals, model, ROOM[0] * ROOM[1] * 4 * goals))
    for actions in (2, 3, 4, 5):
        for memory in (1, 2, 3, 4):
            model = ca.SharedAutonomy(room(2, actions), memory=memory)
            reached = np.isin(model.windows.state, np.arange(model.world.states))
            states = len(np.unique(model.windows.state[reached]))
            want = sum(actions**n for n in range(memory - 1)) + states * actions ** (memory - 1)
            found.append(measure("memory", f"{actions} actions", memory, model, want))
    return found


def plot(found: list[Row], path: Path) -> None:
    """Sizes above, seconds below, a column for each series; predictions dashed."""
    figure = Figure(figsize=(9, 5.4), layout="constrained")
    axes = figure.subplots(2, 3)
    labels = {"dt": "steps a metre, 1/dt", "modes": "modes", "memory": "memory k"}
    for column, (series, label) in enumerate(labels.items()):
        lines = dict.fromkeys(row.line for row in found if row.series == series)
        for i, line in enumerate(lines):
            here = [row for row in found if (row.series, row.line) == (series, line)]
            values = [row.value for row in here]
            scale = here[-1].seconds / here[-1].predicted
            size, taken = axes[0, column], axes[1, column]
            size.plot(values, [row.size for row in here], "o-", color=f"C{i}", label=line, ms=3)
            size.plot(values, [row.predicted for row in here], "--", color=f"C{i}", lw=1)
            taken.plot(values, [row.seconds for row in here], "o-", color=f"C{i}", ms=3)
            taken.plot(values, [scale * row.predicted for row in here], "--", color=f"C{i}", lw=1)
        axes[0, column].legend(fontsize=7)
        axes[1, column].set_xlabel(label)
        for panel in axes[:, column]:
            panel.set_yscale("log")
            panel.set_xscale("linear" if series == "memory" else "log")
            if series != "dt":
                ticks = sorted({row.value for row in found if row.series == series})
                panel.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
                panel.minorticks_off()
    axes[0, 0].set_ylabel("states (k: observed states)")
    axes[1, 0].set_ylabel("seconds to build")
    figure.suptitle("Measured (points) and predicted (dashed)", fontsize=10)
    figure.savefig(path)


def main() -> int:
    """Measure, print, draw."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "results")
    out: Path = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    found = rows()
    with (out / "growth.csv").open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, list(asdict(found[0])), lineterminator="\n")
        writer.writeheader()
        writer.writerows(asdict(row) for row in found)
    print(f"{'series':<8}{'line':<12}{'value':>7}{'size':>9}{'predicted':>11}{'seconds':>10}")
    for row in found:
        print(
            f"{row.series:<8}{row.line:<12}{row.value:>7g}{row.size:>9}{row.predicted:>11.0f}"
            f"{row.seconds:>10.4f}"
        )
    for kind in ("svg", "png"):
        plot(found, out / f"growth.{kind}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
