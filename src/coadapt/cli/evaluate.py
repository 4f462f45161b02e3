"""``coadapt evaluate``: what a policy collects, by simulation and exactly."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

import click

from coadapt.cli.problems import load_problem
from coadapt.cli.progress import progress_line
from coadapt.errors import FileError, printable

if TYPE_CHECKING:
    from coadapt.momdp import MOMDP, AlphaVectorPolicy
    from coadapt.momdp.evaluate import SimulatedValue

MOST_ENTRIES = 400_000
"""Numbers in the transitions written out, ``|Y|**2`` for each edge, beyond which the exact value is
not tried."""

MOST_BELIEFS = 10_000
"""Pairs of observed state and belief after which the exact value is given up."""

PRECISION = 1e-6
"""Width of the exact interval as a part of the value's size, or of 1."""


@dataclass(frozen=True)
class ExactValue:
    """The exact value, or why there is none.

    Attributes:
        lower, upper: bounds of the value, weighted by the probability of the roots; None where it
            was not tried.
        beliefs: pairs of observed state and belief that were followed.
        obstacle: why the bounds are further apart than `PRECISION` or missing; empty if they are
            not.
        seconds: time it took.
    """

    lower: float | None
    upper: float | None
    beliefs: int
    obstacle: str
    seconds: float


@click.command(name="evaluate")
@click.argument("problem")
@click.argument("policy", type=click.Path(path_type=Path))
@click.option(
    "--episodes",
    type=click.IntRange(min=2),
    default=10_000,
    metavar="N",
    help="Simulated episodes.  [10000]",
)
@click.option(
    "--horizon",
    type=click.IntRange(min=1),
    metavar="N",
    help="Steps after which an episode is cut off.  [where the discount is 0.0001, at most 10000]",
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, metavar="S", help="Seed of the episodes.  [0]"
)
@click.option("--no-exact", is_flag=True, help="Leave out the exact value.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option("--quiet", is_flag=True, help="Do not say what is being done.")
def command(
    *,
    problem: str,
    policy: Path,
    episodes: int,
    horizon: int | None,
    seed: int,
    no_exact: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Evaluate a policy by simulation and exactly.

    PROBLEM is a .pomdp or .pomdpx file, the name of a task (see `coadapt tasks`) or a .toml file
    with a task; POLICY is a .policyx, .policy or .coadapt file. The exact value is computed where
    the problem is small enough.

    If PROBLEM, POLICY or an option cannot be used the exit code is 2.
    """
    import numpy as np

    from coadapt.momdp.evaluate import simulate_policy
    from coadapt.momdp.files import read_policy
    from coadapt.momdp.policy import require_fit, value_at_roots

    with progress_line(not quiet) as tell:
        tell(f"reading {printable(problem)}")
        momdp = load_problem(problem)
        vectors = read_policy(policy)
        try:
            require_fit(momdp, vectors)
            begin = perf_counter()
            tell("preparing the simulator, which is compiled once for this machine")
            simulated = simulate_policy(
                momdp,
                vectors,
                episodes,
                rng=np.random.default_rng(seed),
                horizon=horizon,
                progress=lambda done: tell(f"simulating: {done:,} of {episodes:,} episodes"),
            )
            simulation_seconds = perf_counter() - begin
        except ValueError as error:
            raise FileError(policy, None, f"{error}") from error
        tell("computing the exact value")
        exact = _skipped() if no_exact else exact_value_of(momdp, vectors)
    claimed = value_at_roots(momdp, vectors)
    if not as_json:
        click.echo(f"{printable(problem)} under {printable(str(policy))}")
        click.echo(_summary(claimed, simulated, exact))
        return
    low, high = simulated.interval
    record = {
        "problem": problem,
        "policy": str(policy),
        "claimed": claimed,
        "mean": simulated.mean,
        "standard_error": simulated.standard_error,
        "interval_95": [low, high],
        "episodes": simulated.episodes,
        "seed": seed,
        "horizon": simulated.horizon,
        "steps": simulated.steps,
        "unfinished": simulated.unfinished,
        "truncation": simulated.truncation,
        "seconds": simulation_seconds,
        "exact": {
            "lower": exact.lower,
            "upper": exact.upper,
            "beliefs": exact.beliefs,
            "obstacle": exact.obstacle or None,
            "seconds": exact.seconds,
        },
    }
    click.echo(json.dumps(record))


def exact_value_of(problem: MOMDP, policy: AlphaVectorPolicy) -> ExactValue:
    """The exact value of ``policy`` in ``problem``, where that is feasible.

    Args:
        problem: the problem.
        policy: one that fits the problem, with alpha vectors for every observed state.
    """
    import numpy as np

    from coadapt.momdp.exact import evaluate_policy
    from coadapt.momdp.policy import value_at_roots

    entries = len(problem.edge_next) * problem.shape[1] ** 2
    if entries > MOST_ENTRIES:
        obstacle = f"the transitions written out are {entries:,} numbers, above {MOST_ENTRIES:,}"
        return ExactValue(None, None, 0, obstacle, 0.0)
    begin = perf_counter()
    weight = np.array([root.probability for root in problem.roots])
    claimed = value_at_roots(problem, policy)
    tolerance = PRECISION * max(1.0, abs(claimed))
    value = evaluate_policy(problem, policy, tolerance, max_beliefs=MOST_BELIEFS)
    close = bool(np.all(value.upper - value.lower <= tolerance))
    return ExactValue(
        lower=float(weight @ value.lower),
        upper=float(weight @ value.upper),
        beliefs=value.beliefs,
        obstacle="" if close else f"{value.beliefs:,} beliefs are too few",
        seconds=perf_counter() - begin,
    )


def _skipped() -> ExactValue:
    return ExactValue(None, None, 0, "not asked for", 0.0)


def _summary(claimed: float, simulated: SimulatedValue, exact: ExactValue) -> str:
    """The result for people."""
    low, high = simulated.interval
    lines = [
        f"  claimed    {claimed:.6g}, the value of the alpha vectors",
        f"  simulated  {simulated.mean:.6g} with standard error {simulated.standard_error:.2g}; "
        f"95 % interval {low:.6g} to {high:.6g}",
        f"             {simulated.episodes:,} episodes of at most {simulated.horizon:,} steps; "
        f"what lies beyond is worth at most {simulated.truncation:.2g}",
    ]
    if exact.lower is None or exact.upper is None:
        lines.append(f"  exact      not feasible: {exact.obstacle}")
    elif exact.obstacle:
        lines.append(
            f"  exact      not feasible: {exact.obstacle}; between {exact.lower:.6g} and "
            f"{exact.upper:.6g}"
        )
    else:
        middle = (exact.lower + exact.upper) / 2
        lines.append(f"  exact      {middle:.6g}, by {exact.beliefs:,} beliefs")
    return "\n".join(lines)
