"""Whether the fit finds what was put in: coverage and widths of the population's intervals.

    python benchmarks/recovery.py [--studies 1000] [--participants 200] [--figure FILE]

Every true population is recovered from many simulated studies of the paper's task, with the
mutual-adaptation robot planned here, three trials a person and beliefs carried over. Of people who
are all alike the mean is asked for, of others the standard deviation too, and of people with a few
values of alpha the weight of each.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np

from coadapt.analysis.adaptability import PersonModel
from coadapt.analysis.adaptability.draws import Design
from coadapt.analysis.adaptability.recovery import Recovered, Recovery, recover, recover_weights
from coadapt.formalism.shared_autonomy import PAPER_ADAPTABILITY
from coadapt.report.figures import style
from coadapt.report.figures.recovery import recovery
from coadapt.robots.setup import RobotSetup

ALIKE = (0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0, 0.02, 0.95, 0.98)
"""Adaptability of populations in which everybody is alike."""

NEVER = 0.0
"""Apart: with it nothing in the data is left to chance that an interval could miss."""

SPREAD = ((0.25, 0.25), (0.5, 0.25), (0.75, 0.25), (0.5, 0.4))
"""Means and standard deviations of others."""

WEIGHTS = ((0.2, 0.2, 0.2, 0.2, 0.2), (0.3, 0.1, 0.2, 0.1, 0.3), (0.5, 0.0, 0.0, 0.0, 0.5))
"""Of the paper's values of alpha."""


def main() -> None:
    """Run all of them and write what they came to."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--studies", type=int, default=1000)
    parser.add_argument("--participants", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("recovery.json"))
    parser.add_argument("--figure", type=Path, help="draw the result to this PNG file")
    given = parser.parse_args()
    robot = RobotSetup().build()
    design = Design(robot, PersonModel(robot.model, mode_lasts=True, first_mode=0))
    done: list[Recovery] = []
    weighed: list[dict[str, object]] = []

    def save() -> None:
        record = {"populations": [each.record() for each in done], "weights": weighed}
        given.out.write_text(json.dumps(record))

    populations = [*((alpha, 0.0) for alpha in (*ALIKE, NEVER)), *SPREAD]
    for i, (mean, sd) in enumerate(populations):
        begin = time.perf_counter()
        rng = np.random.default_rng((given.seed, i))
        found = recover(design, mean, sd, given.participants, given.studies, rng)
        print(f"alpha: mean {mean:g}, SD {sd:g}; {time.perf_counter() - begin:.0f} s")
        print(f"  mean: {_said(found.mean)}")
        if found.sd is not None:
            print(f"  SD: {_said(found.sd)}")
        print(
            f"  SD found {found.estimated_sd.mean():.4f}, own alpha covered "
            f"{found.individual:.1%}, {found.information:.2f} bits",
            flush=True,
        )
        done.append(found)
        save()
    for i, weights in enumerate(WEIGHTS):
        begin = time.perf_counter()
        rng = np.random.default_rng((given.seed, len(populations) + i))
        parts = recover_weights(
            design, PAPER_ADAPTABILITY, weights, given.participants, given.studies, rng
        )
        print(f"weights {weights}; {time.perf_counter() - begin:.0f} s")
        for alpha, part in zip(PAPER_ADAPTABILITY, parts, strict=True):
            print(f"  of alpha {alpha:g}, {part.true:g}: {_said(part)}", flush=True)
        weighed.append({"values": PAPER_ADAPTABILITY, "found": [part.record() for part in parts]})
        save()
    if given.figure is not None:
        with style.settings():
            given.figure.write_bytes(style.render(recovery(done), "png"))


def _said(found: Recovered) -> str:
    low, high = found.coverage_interval
    return (
        f"covered {found.coverage:6.1%} ({low:.1%} to {high:.1%}), bias {found.bias:+.4f}, "
        f"width {found.width:.4f}"
    )


if __name__ == "__main__":
    main()
