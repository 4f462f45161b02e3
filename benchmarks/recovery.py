"""Whether the fit finds what was put in: coverage and widths of the population's intervals.

    python benchmarks/recovery.py [--studies 400] [--participants 200] [--figure FILE]

Every true population is recovered from many simulated studies of the paper's task, with the
mutual-adaptation robot planned here, three trials a person and beliefs carried over.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np

from coadapt.analysis.adaptability import PersonModel
from coadapt.analysis.adaptability.draws import Design
from coadapt.analysis.adaptability.recovery import Recovery, recover
from coadapt.report.figures import style
from coadapt.report.figures.recovery import recovery
from coadapt.robots.setup import RobotSetup

ALIKE = (0.25, 0.5, 0.75, 1.0, 0.0, 0.02, 0.05, 0.1, 0.9, 0.95, 0.98)
"""Adaptability of populations in which everybody is alike."""

SPREAD = ((0.25, 0.25), (0.5, 0.25), (0.75, 0.25), (0.5, 0.4))
"""Means and standard deviations of others."""


def main() -> None:
    """Run all of them and write what they came to."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--studies", type=int, default=400)
    parser.add_argument("--participants", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("recovery.json"))
    parser.add_argument("--figure", type=Path, help="draw the result to this PNG file")
    given = parser.parse_args()
    robot = RobotSetup().build()
    design = Design(robot, PersonModel(robot.model, mode_lasts=True, first_mode=0))
    done: list[Recovery] = []
    populations = [*((alpha, 0.0) for alpha in ALIKE), *SPREAD]
    for i, (mean, sd) in enumerate(populations):
        begin = time.perf_counter()
        rng = np.random.default_rng((given.seed, i))
        found = recover(design, mean, sd, given.participants, given.studies, rng)
        low, high = found.coverage_interval
        print(
            f"alpha {mean:5.2f} sd {sd:4.2f}: covered {found.coverage:6.1%} "
            f"({low:.1%} to {high:.1%}), bias {found.bias:+.4f}, width {found.width:.4f}, "
            f"sd found {found.estimated_sd.mean():.4f}, own alpha covered {found.individual:.1%}, "
            f"{found.information:.2f} bits, {time.perf_counter() - begin:.0f} s",
            flush=True,
        )
        done.append(found)
        given.out.write_text(json.dumps([each.record() for each in done]))
        if given.figure is not None:
            with style.settings():
                given.figure.write_bytes(style.render(recovery(done), "png"))


if __name__ == "__main__":
    main()
