"""Compares our solver with the C++ reference, side by side: seconds to the same bounds.

    python benchmarks/solve.py --reference PATH/TO/pomdpsol [--problems NAME...] [--seconds 60]

For each problem the reference runs, then ours, one after the other on the same file. Writes
`solve.csv`, `solve.md`, `gap.svg` and `gap.png` to ``--out``. What the columns mean stands in
`README.md` beside this file.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from comparison import compare
from solve_report import Result, line, markdown, write_csv
from solvers import PRECISION, Failed, coadapt, run_ours, run_reference

ROOT = Path(__file__).resolve().parent.parent
PROBLEMS = ROOT.parent / "shared" / "problems"

FILES = (
    "Tiger.pomdp", "Hallway.pomdp", "TagAvoid.pomdpx", "TagAvoid.pomdp", "RockSample_4_4.pomdpx",
    "RockSample_7_8.pomdpx", "RockSample_11_11.pomdpx", "tiger-grid.pomdp", "query.s3.pomdp",
    "network.pomdp", "boettiger_example.pomdpx", "learning.c2.pomdp",
)  # fmt: skip
"""Published problems that are compared unless others are named."""

MODELS = {
    "table_clearing": "ca.SharedAutonomy(ca.worlds.table_clearing())",
    **{
        f"memory_{k}": f"ca.SharedAutonomy(ca.worlds.table_clearing(), memory={k})"
        for k in (3, 4, 5)
    },
}
"""Models of our own, which are written to a file that both solvers read."""

COSTS = re.compile(rb"^\s*values\s*:\s*cost", re.MULTILINE)
"""In files that the reference misreads: it takes costs for rewards."""


def main() -> int:
    """Run the comparison; 1 if bounds contradict each other or are not confirmed."""
    options = parse_options()
    out: Path = options.out
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as directory:
        scratch = Path(directory)
        cold = [] if options.no_cold_start else cold_start(scratch)
        if options.no_cold_start:
            coadapt("solve", "table_clearing", "--out", str(scratch / "w.coadapt"), scratch=scratch)
        results: list[Result] = []
        for name in chosen(options):
            results.append(run_problem(name, options, scratch))
            print(line(results[-1]), flush=True)
            # After each problem: a comparison takes hours.
            limits = (options.seconds, options.ours_seconds)
            write_csv(results, out / "solve.csv")
            (out / "solve.md").write_text(markdown(results, cold, limits), encoding="utf-8")
    from gap_plot import draw_gaps

    panels = [
        (r.name, r.ours.trace if r.ours else (), r.reference.trace if r.reference else ())
        for r in results
        if r.ours or r.reference
    ]
    draw_gaps(panels, PRECISION, out)
    print(f"Written to {out}: solve.csv, solve.md, gap.svg, gap.png")
    wrong = any((r.comparison and not r.comparison.agree) or r.confirmed == "NO" for r in results)
    return 1 if wrong else 0


def parse_options() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("--reference", type=Path, metavar="POMDPSOL", help="without it only ours runs")
    add("--problems", nargs="+", metavar="NAME", help="names as in the table, or files")
    add("--all", action="store_true", help="every file of --directory, and our models")
    add("--directory", type=Path, default=PROBLEMS, help="of the published problems")
    add("--seconds", type=float, default=60.0, help="for the reference [60]")
    add("--ours-seconds", type=float, help="for ours [as --seconds]")
    add("--confirm", type=int, nargs="?", const=10_000, metavar="RUNS", help="simulate [10000]")
    add("--no-cold-start", action="store_true", help="use the kernels that are compiled already")
    add("--out", type=Path, default=ROOT / "benchmarks" / "results", metavar="DIR")
    options = parser.parse_args()
    if options.ours_seconds is None:
        options.ours_seconds = options.seconds
    if options.reference is not None and not os.access(options.reference, os.X_OK):
        parser.error(f"--reference {options.reference}: found no program that can be run")
    return options


def chosen(options: argparse.Namespace) -> list[str]:
    """The names of the problems to run."""
    if options.problems:
        return options.problems
    if options.all:
        found = sorted(p.name for p in options.directory.iterdir() if p.suffix.startswith(".pomdp"))
        return [*found, *MODELS]
    return [*FILES, *MODELS]


def run_problem(name: str, options: argparse.Namespace, scratch: Path) -> Result:
    """Let both solvers work on the problem ``name``."""
    result = Result(name)
    try:
        path = problem_file(name, options.directory, scratch)
    except Failed as error:
        result.notes.append(f"not there: {error}")
        return result
    if options.reference is not None:
        try:
            result.reference = run_reference(options.reference, path, options.seconds, scratch)
        except Failed as error:
            result.notes.append(f"reference: {error}")
    try:
        result.ours, policy = run_ours(path, options.ours_seconds, scratch)
    except Failed as error:
        result.notes.append(f"ours: {error}")
        return result
    if result.reference is not None:
        result.comparison = compare(
            result.reference, result.ours, options.seconds, options.ours_seconds
        )
        if not result.comparison.agree:
            result.notes.append("the bounds contradict each other")
    if options.confirm:
        runs = ["--episodes", str(options.confirm), "--no-exact"]
        result.confirmation, _ = coadapt("evaluate", str(path), str(policy), *runs, scratch=scratch)
    return result


def problem_file(name: str, directory: Path, scratch: Path) -> Path:
    """The file of the problem ``name``; where need be it is written now.

    Raises:
        Failed: if there is none.
    """
    if name in MODELS:
        return export(f"{MODELS[name]}.to_momdp()", scratch / f"{name}.pomdpx")
    for path in (directory / name, Path(name)):
        if path.is_file():
            if path.suffix == ".pomdp" and COSTS.search(path.read_bytes()):
                return export(f"ca.read_pomdp({str(path)!r})", scratch / f"{path.stem}.pomdpx")
            return path
    raise Failed(f"{directory / name}")


def export(problem: str, path: Path) -> Path:
    """Write the value of the expression ``problem`` to ``path``, in a process that needs memory.

    Raises:
        Failed: if that cannot be done.
    """
    code = f"import coadapt as ca; ca.write_pomdpx({problem}, {str(path)!r})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Failed((done.stderr.strip() or "no reason given").splitlines()[-1])
    return path


def cold_start(scratch: Path) -> list[dict[str, Any]]:
    """The first process after installing, and a second one, with a cache of compiled kernels of
    their own. All later processes use it too."""
    cache = scratch / "kernels"
    os.environ["NUMBA_CACHE_DIR"] = str(cache)
    target = ["--out", str(scratch / "cold.coadapt")]
    rows: list[dict[str, Any]] = []
    for when in ("first process, nothing compiled", "second process"):
        found, ended = coadapt("solve", "table_clearing", *target, scratch=scratch)
        rows.append({"when": when, **found, "wall_seconds": ended.wall_seconds})
    return rows


if __name__ == "__main__":
    sys.exit(main())
