"""Follows our policies in the simulator of the C++ reference solver, and in our own.

    python benchmarks/compare_simulator.py --simulator PATH/TO/pomdpsim FILE...

Each problem (`.pomdp`, `.pomdpx`; `table-clearing` stands for the paper's task, written with
`write_pomdpx`) is solved, the policy written with `write_policy`, and both simulators follow it for
as many steps as discounting leaves above ``--rest``. One line per problem, in Markdown: the bounds,
and the mean discounted reward with its 95 % confidence interval

*ours*
    by `simulate_policy`: taking the action of the best alpha vector at the exact belief;
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
from pathlib import Path

import numpy as np

import coadapt as ca
from coadapt.momdp.evaluate import NORMAL_95, simulate_policy
from coadapt.momdp.files import read_pomdp, write_policy, write_pomdpx
from coadapt.momdp.sarsop import SARSOP

TABLE_CLEARING = "table-clearing"


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
    rng = np.random.default_rng(options.seed)
    ours = simulate_policy(problem, solution.policy, options.runs, rng=rng, horizon=steps)
    spread = NORMAL_95 * ours.standard_error
    args = (options.simulator, path.resolve(), policy, steps)
    theirs, width = reference(*args, options.reference_runs, "--lookahead", "no")
    cells = [
        name, f"{solution.vectors}", f"{solution.lower:.4f}", f"{solution.upper:.4f}", f"{steps}",
        f"{ours.mean:.4f} ± {spread:.4f}", f"{theirs:.4f} ± {width:.4f}",
    ]  # fmt: skip
    if options.lookahead_runs:
        ahead, ahead_width = reference(*args, options.lookahead_runs)
        cells.append(f"{ahead:.4f} ± {ahead_width:.4f}")
    deviation = math.hypot(spread, width) / NORMAL_95
    # Their output has six digits.
    cells.append("exact" if deviation < 1e-5 else f"{(theirs - ours.mean) / deviation:+.2f}")
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
