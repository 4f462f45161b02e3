"""The model against the published study: what it predicts once three counts are fitted.

    python benchmarks/published_study.py [--people 2000] [--experiments 4000]

Prints one block for each assumption about what lasts between trials.
"""

from __future__ import annotations

import argparse
from itertools import product

import numpy as np

from coadapt.analysis.experiment.pool import Protocol, simulate_pool
from coadapt.analysis.experiment.power import Conditions
from coadapt.analysis.experiment.published import (
    CHI2,
    PARTICIPANTS,
    RECONSTRUCTED,
    U_LOWER,
    U_UPPER,
    fit_published,
    predict_tests,
)
from coadapt.robots.setup import ROBOT_NAMES, RobotSetup


def main() -> None:
    """Fit and predict under all four assumptions."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--people", type=int, default=2000, help="with each alpha")
    parser.add_argument("--experiments", type=int, default=4000)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    robots = {name: RobotSetup(robot=name).build() for name in ROBOT_NAMES}
    for carry, keep in product((True, False), repeat=2):
        rng = np.random.default_rng(given.seed)
        protocol = Protocol(3, carry, keep, first_mode=0)
        pools = {
            name: simulate_pool(robot, protocol, rng, people=given.people)
            for name, robot in robots.items()
        }
        fit = fit_published(pools["mutual_adaptation"], pools["one_way_adaptation"])
        conditions = Conditions(
            pools["no_adaptation"], pools["mutual_adaptation"], pools["one_way_adaptation"]
        )
        tests = predict_tests(conditions, fit, given.experiments, rng)
        print(f"beliefs {'carried' if carry else 'reset'}, modes {'kept' if keep else 'anew'}:")
        print(f"  alpha: mean {fit.mean:.2f}, SD {fit.sd:.2f}; deviance {fit.deviance:.2f}")
        last, once, never, one_way = fit.groups
        print(
            f"  fitted: mutual at least once {16 * (last + once):.1f} (12), last trial "
            f"{16 * last:.1f} (9), never {16 * never:.1f} (4), one-way once {17 * one_way:.1f} (2)"
        )
        for name, counts in fit.counts.items():
            expected = ", ".join(f"{PARTICIPANTS[name] * p:.1f}" for p in counts)
            print(f"  {name}: 0 to 3 optimal trials {expected}; found {RECONSTRUCTED[name]}")
        for label, values, observed, tail in (
            ("chi2", tests.chi2, CHI2, tests.chi2 >= CHI2),
            ("U upper", tests.u_upper, U_UPPER, tests.u_upper <= U_UPPER),
            ("U lower", tests.u_lower, U_LOWER, tests.u_lower <= U_LOWER),
        ):
            low, middle, high = np.quantile(values, (0.025, 0.5, 0.975))
            print(
                f"  {label}: {middle:.1f} ({low:.1f} to {high:.1f}); found {observed}, "
                f"as extreme with probability {tail.mean():.3f}"
            )
        print(f"  H1 is found in {tests.supported.mean():.1%} of such studies", flush=True)


if __name__ == "__main__":
    main()
