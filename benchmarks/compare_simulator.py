"""Follows our policies in the simulator of the C++ reference solver, and in one of our own.

    python benchmarks/compare_simulator.py --simulator PATH/TO/pomdpsim FILE...

Each problem (`.pomdp`, `.pomdpx`; `table-clearing` stands for the paper's task, written with
`write_pomdpx`) is solved, the policy written with `write_policy`, and both simulators follow it for
as many steps as discounting leaves above ``--rest``. One line per problem, in Markdown: the bounds,
and the mean discounted reward with its 95 % confidence interval

*ours*
    taking the action of the best alpha vector, at the beliefs that `MOMDP` defines;
*theirs*
    the same (``--lookahead no``);
*theirs, looking ahead*
    taking the action that is best with the policy's values one step later, their default.

The value of the policy is at least the lower bound, and *ours* and *theirs* estimate the same
number; the last column is their difference in standard deviations. Looking ahead gives at least
the lower bound too.
"""

from __future__ import annotations

import argparse
import math
import re
import subprocess
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import coadapt as ca
from coadapt.momdp import MOMDP, AlphaVectorPolicy
from coadapt.momdp.files import read_pomdp, write_policy, write_pomdpx
from coadapt.momdp.sarsop import SARSOP

TABLE_CLEARING = "table-clearing"

NORMAL = 1.96
"""Half of a 95 % confidence interval in standard deviations."""

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def picked(chance: Floats, rng: np.random.Generator) -> Ints:
    """An index for each row of ``chance`` ``[N, K]``, with the probabilities of the row."""
    total = np.cumsum(chance, axis=1)
    draw = rng.random(len(chance)) * total[:, -1]
    return (total <= draw[:, None]).sum(axis=1)


def simulate(
    problem: MOMDP, policy: AlphaVectorPolicy, steps: int, runs: int, rng: np.random.Generator
) -> Floats:
    """``[runs]`` discounted rewards of following ``policy`` for ``steps`` steps."""
    roots = problem.roots
    start = rng.choice(len(roots), size=runs, p=[root.probability for root in roots])
    x = np.array([root.x for root in roots])[start]
    belief = np.array([root.belief for root in roots])[start]  # [N, Y]
    y = picked(belief, rng)
    found, weight = np.zeros(runs), 1.0
    matrix = cache(problem.transition.matrix)
    for _ in range(steps):
        action = np.empty(runs, dtype=np.int64)
        for state in np.unique(x):
            own = np.flatnonzero(x == state)
            part = slice(int(policy.start[state]), int(policy.start[state + 1]))
            best = np.argmax(belief[own] @ policy.vectors[part].T, axis=1)
            action[own] = policy.actions[part][best]
        found += weight * problem.reward[x, action, y]
        weight *= problem.discount
        before, actions = x.copy(), problem.shape[2]
        for pair in np.unique(before * actions + action):
            state, a = divmod(int(pair), actions)
            own = np.flatnonzero((before == state) & (action == a))
            edges = list(problem.edges(state, a))
            maps = [matrix(int(problem.edge_map[e])) for e in edges]
            edge = picked(np.stack([m[y[own]].sum(axis=1) for m in maps], axis=1), rng)
            for i, e in enumerate(edges):
                here = own[edge == i]
                if len(here) == 0:
                    continue
                x[here] = to = int(problem.edge_next[e])
                y[here] = picked(maps[i][y[here]], rng)
                sight = problem.observation[problem.observation_index[a, to]]  # [Y, O]
                seen = picked(sight[y[here]], rng)
                after = (belief[here] @ maps[i]) * sight[:, seen].T
                belief[here] = after / after.sum(axis=1, keepdims=True)
    return found


def reference(
    simulator: Path, problem: Path, policy: Path, steps: int, runs: int, *options: str
) -> tuple[float, float]:
    """Mean and half of the confidence interval that the reference simulator prints."""
    command = [
        str(simulator), "--simLen", str(steps), "--simNum", str(runs), "--srand", "1",
        "--policy-file", str(policy), *options, str(problem),
    ]  # fmt: skip
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    last = re.findall(rf"^ {runs} +(\S+) +\((\S+), (\S+)\)", done.stdout, re.MULTILINE)
    if not last:
        raise RuntimeError(f"no result from {' '.join(command)}:\n{done.stdout[-500:]}")
    mean, low, high = map(float, last[-1])
    return mean, (high - low) / 2


def compare(path: Path, options: argparse.Namespace, directory: Path) -> str:
    """The line of one problem."""
    name, limit = path.name, options.time_limit
    if name == TABLE_CLEARING:
        path = directory / f"{TABLE_CLEARING}.pomdpx"
        write_pomdpx(ca.SharedAutonomy(ca.worlds.table_clearing()).to_momdp(), path)
    problem = read_pomdp(path)
    solution = SARSOP(gap=options.gap, time_limit=limit).solve(problem)
    policy = directory / "a.policy"
    write_policy(solution.policy, policy)
    steps = math.ceil(math.log(options.rest) / math.log(problem.discount))
    rewards = simulate(
        problem, solution.policy, steps, options.runs, np.random.default_rng(options.seed)
    )
    mean, spread = float(rewards.mean()), NORMAL * float(rewards.std()) / math.sqrt(options.runs)
    args = (options.simulator, path.resolve(), policy, steps)
    theirs, width = reference(*args, options.reference_runs, "--lookahead", "no")
    cells = [
        name, f"{solution.vectors}", f"{solution.lower:.4f}", f"{solution.upper:.4f}", f"{steps}",
        f"{mean:.4f} ± {spread:.4f}", f"{theirs:.4f} ± {width:.4f}",
    ]  # fmt: skip
    if options.lookahead_runs:
        ahead, ahead_width = reference(*args, options.lookahead_runs)
        cells.append(f"{ahead:.4f} ± {ahead_width:.4f}")
    deviation = math.hypot(spread, width) / NORMAL
    # Their output has six digits.
    cells.append("exact" if deviation < 1e-5 else f"{(theirs - mean) / deviation:+.2f}")
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("problems", nargs="+", type=Path)
    parser.add_argument("--simulator", type=Path, required=True)
    parser.add_argument("--gap", type=float, default=1e-2)
    parser.add_argument("--time-limit", type=float, default=5.0)
    parser.add_argument("--rest", type=float, default=1e-5)
    parser.add_argument("--runs", type=int, default=10_000)
    parser.add_argument("--reference-runs", type=int, default=10_000)
    parser.add_argument("--lookahead-runs", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    heads = ["problem", "vectors", "lower", "upper", "steps", "ours", "theirs"]
    heads += ["theirs, looking ahead"] * bool(options.lookahead_runs) + ["difference / sd"]
    print(f"| {' | '.join(heads)} |\n|{' --- |' * len(heads)}")
    with tempfile.TemporaryDirectory() as directory:
        for path in options.problems:
            print(compare(path, options, Path(directory)), flush=True)


if __name__ == "__main__":
    main()
