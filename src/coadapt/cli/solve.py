"""``coadapt solve``: a policy for a planning problem, with certified bounds."""

from __future__ import annotations

import csv
import io
import json
import sys
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

import click

from coadapt.cli.outputs import require_writable
from coadapt.cli.problems import load_problem
from coadapt.cli.process import peak_memory_mb, seconds_since_launch
from coadapt.cli.progress import progress_line
from coadapt.errors import FileError, InputError, printable

if TYPE_CHECKING:
    from coadapt.momdp import MOMDP
    from coadapt.momdp.sarsop import Record, Solution

INTERRUPTED = 128 + 2
"""Exit code after Ctrl-C, which ends the search but not the program."""

TRACE = ("seconds", "backups", "lower", "upper", "gap", "vectors")
"""Columns of the trace: fields of a `Record`."""

ENDS = {
    "gap": "gap reached",
    "precision": "the bounds no longer move in floating-point numbers",
    "backups": "backup limit reached",
    "time": "time limit reached",
    "memory": "memory limit reached",
    "interrupted": "interrupted",
}
"""Each status in words."""


@click.command(name="solve")
@click.argument("problem")
@click.option("--time-limit", type=float, metavar="S", help="Stop after about S seconds of search.")
@click.option(
    "--gap",
    type=float,
    default=1e-3,
    metavar="G",
    help="Stop once the bounds are this close, in units of reward.  [0.001]",
)
@click.option(
    "--relative-gap",
    type=float,
    default=0.0,
    metavar="R",
    help="Or this close as a part of the smaller bound's size.  [0]",
)
@click.option("--max-backups", type=int, metavar="N", help="Stop after about N backups.")
@click.option(
    "--memory-limit",
    type=click.IntRange(min=1),
    metavar="MB",
    help="Stop before the arrays of the search exceed MB megabytes.",
)
@click.option(
    "--start-policy",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Start from the policy in FILE.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    metavar="POLICY",
    help="Where to write the policy: .policyx (XML) or .coadapt (compact).  [NAME.policyx]",
)
@click.option(
    "--condense",
    is_flag=True,
    help="Write far fewer alpha vectors, valued anew; their bound may be a little lower.",
)
@click.option(
    "--trace",
    type=click.Path(path_type=Path),
    metavar="CSV",
    help="Where to write how the bounds closed in.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option("--quiet", is_flag=True, help="Do not say what is being done.")
def command(
    *,
    problem: str,
    time_limit: float | None,
    gap: float,
    relative_gap: float,
    max_backups: int | None,
    memory_limit: int | None,
    start_policy: Path | None,
    out: Path | None,
    condense: bool,
    trace: Path | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Plan for a problem: a policy with certified bounds.

    PROBLEM is a .pomdp or .pomdpx file, the name of a task (see `coadapt tasks`) or a .toml file
    with a task. The value of the policy is at least the lower bound, that of the best one at most
    the upper. A file that exists is replaced.

    Ctrl-C ends the search; the policy found so far is written, and the exit code is 130. If
    PROBLEM, an option or a file cannot be used the exit code is 2 and nothing is written.
    """
    from coadapt.momdp.files import read_policy, write_policy
    from coadapt.momdp.files.policies import policy_suffix
    from coadapt.momdp.policy import value_at_roots
    from coadapt.momdp.sarsop import SARSOP, compile_kernels, condensed, kernels_are_compiled
    from coadapt.momdp.sarsop.search import COMPILING

    try:
        solver = SARSOP(
            gap=gap,
            relative_gap=relative_gap,
            max_backups=max_backups,
            time_limit=time_limit,
            memory_limit=None if memory_limit is None else memory_limit << 20,
            progress=not quiet,
        )
    except ValueError as error:
        setting, _, rest = str(error).partition(" ")
        raise InputError(f"--{setting.replace('_', '-')} {rest}") from error
    target = Path(f"{Path(problem).stem}.policyx") if out is None else out
    _ = policy_suffix(target)
    require_writable(target, Path(problem))
    if trace is not None:
        used = [] if start_policy is None else [start_policy]
        require_writable(trace, Path(problem), target, *used)
    with progress_line(not quiet) as tell:
        tell(f"reading {printable(problem)}")
        begin = perf_counter()
        momdp = load_problem(problem)
        load_seconds = perf_counter() - begin
        start = None if start_policy is None else read_policy(start_policy)
        begin = perf_counter()
        if not (quiet or kernels_are_compiled()):
            tell(COMPILING)
            if not sys.stderr.isatty():
                click.echo(COMPILING, err=True)
        compile_kernels(start is not None or condense)
        compile_seconds = perf_counter() - begin
    launch_seconds = seconds_since_launch()
    try:
        solution = solver.solve(momdp, start)
    except MemoryError as error:
        if memory_limit is None:
            raise
        _, _, rest = str(error).partition(": ")
        raise InputError(f"--memory-limit {memory_limit}: {rest or 'not enough'}") from error
    except ValueError as error:
        if start_policy is None:
            raise
        raise FileError(start_policy, None, f"cannot be the start: {error}") from error
    policy = condensed(momdp, solution.policy) if condense else solution.policy
    policy_lower = value_at_roots(momdp, policy) if condense else solution.lower
    write_policy(policy, target)
    if trace is not None:
        _write_trace(solution.trace, trace)
    if as_json:
        x, y, a, o = momdp.shape
        record = {
            "problem": problem,
            "shape": {"observed": x, "hidden": y, "actions": a, "observations": o},
            "discount": momdp.discount,
            "lower": solution.lower,
            "upper": solution.upper,
            "gap": solution.gap,
            "status": solution.status.value,
            "seconds": solution.seconds,
            "backups": solution.backups,
            "vectors": solution.vectors,
            "load_seconds": load_seconds,
            "compile_seconds": compile_seconds,
            "launch_seconds": launch_seconds,
            "peak_memory_mb": peak_memory_mb(),
            "policy": str(target),
            "policy_lower": policy_lower,
            "policy_vectors": len(policy.vectors),
        }
        click.echo(json.dumps(record))
    else:
        click.echo(_summary(problem, momdp, solution, load_seconds))
        if condense:
            vectors = f"{len(policy.vectors):,} alpha vectors"
            click.echo(f"  condensed  {vectors}, value at least {policy_lower:.6g}")
        click.echo(f"Policy written to {printable(str(target))}")
    return INTERRUPTED if solution.status.value == "interrupted" else 0


def _summary(name: str, problem: MOMDP, solution: Solution, load_seconds: float) -> str:
    """The result for people."""
    x, y, a, o = problem.shape
    how = ENDS[solution.status.value]
    return "\n".join(
        [
            printable(name),
            f"  problem  {x:,} observed x {y:,} hidden states, {a:,} actions, "
            f"{o:,} observations, discount {problem.discount:g}",
            f"  value    {solution.lower:.6g} to {solution.upper:.6g}",
            f"  gap      {solution.gap:.3g} ({how})",
            f"  work     {solution.backups:,} backups in {solution.seconds:.3g} s, "
            f"after {load_seconds:.3g} s of reading",
            f"  policy   {solution.vectors:,} alpha vectors",
        ]
    )


def _write_trace(trace: tuple[Record, ...], path: Path) -> None:
    from coadapt.momdp.files.atomic import replacing

    text = io.StringIO(newline="")
    table = csv.writer(text, lineterminator="\n")
    table.writerow(TRACE)
    # repr: every bit of the numbers.
    table.writerows([repr(getattr(record, name)) for name in TRACE] for record in trace)
    with replacing(path) as file:
        file.write(text.getvalue().encode())
