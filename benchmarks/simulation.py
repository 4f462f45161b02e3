"""Simulated episodes: decisions a second, single decisions, and a million runs against exact ones.

Prints the tables of `benchmarks/README.md`; nothing else should run on the machine. Times are those
of the processor, best of several.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

import coadapt as ca
from coadapt.report.performance import ALPHAS
from coadapt.simulation import evaluate_all
from coadapt.simulation.schedule import MAX_STEPS


def seconds(call: Callable[[], object], repeat: int = 5) -> float:
    """Processor seconds of the fastest of some calls."""
    best = float("inf")
    for _ in range(repeat):
        start = time.process_time()
        call()
        best = min(best, time.process_time() - start)
    return best


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1_000_000, help="runs for each alpha")
    parser.add_argument("--gap", type=float, default=1e-3, help="where the planner stops")
    parser.add_argument("--tolerance", type=float, default=1e-5, help="of the exact evaluation")
    options = parser.parse_args()
    model = ca.SharedAutonomy(ca.worlds.table_clearing())
    policy = ca.SARSOP(gap=options.gap).solve(model.to_momdp()).policy
    robot = ca.robots.MutualAdaptation(model, policy)
    bare = ca.robots.MutualAdaptation(model, policy, ca.robots.NEVER_MATCH)
    partners = [ca.SimulatedPartner(alpha, 0) for alpha in ALPHAS]

    def rng() -> np.random.Generator:
        return np.random.default_rng(0)

    start = time.process_time()
    ca.simulate_batch(robot, partners[2], 1, rng())
    print(f"first episode, kernels compiled or read from disk: {time.process_time() - start:.2f} s")

    batch = ca.simulate_batch(robot, partners[2], 100_000, rng())
    rate = batch.steps.sum() / seconds(
        lambda: ca.simulate_batch(robot, partners[2], 100_000, rng())
    )
    few = ca.simulate(robot, partners[2], 1000, rng())
    many_loop = sum(e.steps for e in few) / seconds(
        lambda: ca.simulate(robot, partners[2], 1000, rng()), 3
    )
    one = [ca.simulate(robot, partners[2], 1, np.random.default_rng(i))[0] for i in range(100)]
    one_loop = sum(e.steps for e in one) / seconds(
        lambda: [ca.simulate(robot, partners[2], 1, np.random.default_rng(i)) for i in range(100)],
        3,
    )
    print("| decisions a second, one core | |")
    print("| --- | --- |")
    print(f"| `simulate_batch` | {rate:,.0f} |")
    print(f"| `simulate`, 1,000 episodes side by side | {many_loop:,.0f} |")
    print(f"| `simulate`, one episode at a time | {one_loop:,.0f} |")
    print(
        f"| speed-up over the second, the third | {rate / many_loop:.0f}, {rate / one_loop:.0f} |"
    )

    def act() -> None:
        for _ in range(1000):
            robot.reset()
            robot.act(model.world.start, 1)

    print(f"\none `robot.reset()` and `robot.act`: {1e3 * seconds(act):.1f} us")

    figure = seconds(lambda: [ca.simulate_batch(bare, p, 1000, rng()) for p in partners])
    print(f"1,000 runs for each of the {len(ALPHAS)} alpha of Fig. 6: {figure:.3f} s")

    print(f"\n{options.runs:,} runs for each alpha, the policy alone, against the exact curve\n")
    print("| alpha | exact | not followed | simulated | standard errors apart |")
    print("| --- | --- | --- | --- | --- |")
    exact = evaluate_all(bare, partners, tolerance=options.tolerance, max_steps=MAX_STEPS)
    start, worst = time.process_time(), 0.0
    for i, (partner, e) in enumerate(zip(partners, exact, strict=True)):
        found = ca.simulate_batch(bare, partner, options.runs, np.random.default_rng([1, i]))
        error = found.reward.std(ddof=1) / np.sqrt(options.runs)
        # What the exact evaluation did not follow may lie anywhere between the goals' rewards.
        apart = max(0.0, abs(found.reward.mean() - e.reward) - e.reward_error) / error
        worst = max(worst, apart)
        print(
            f"| {partner.adaptability:g} | {e.reward:.6f} | {e.unresolved:.1e} | "
            f"{found.reward.mean():.6f} | {apart:.2f} |"
        )
    print(f"\nfurthest apart: {worst:.2f} standard errors; {time.process_time() - start:.0f} s")
    if worst > 4:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
