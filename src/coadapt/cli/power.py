"""``coadapt power``: how many participants a study needs, from simulated experiments."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import click

from coadapt.cli.options import changed_setup, number_option, setup_options
from coadapt.cli.outputs import require_writable
from coadapt.cli.progress import progress_line
from coadapt.errors import InputError, printable

if TYPE_CHECKING:
    from coadapt.analysis.experiment.people import People, Rates
    from coadapt.analysis.experiment.power import Needed, PowerPoint
    from coadapt.formalism import SharedAutonomy
    from coadapt.robots.task_setup import AnySetup

FIGURES = (".png", ".svg", ".pdf")

LARGEST = 1000
"""Participants in a condition."""


def _sizes(text: str) -> tuple[int, ...]:
    """``"4:12:4"`` or ``"4,8,12"`` as ``(4, 8, 12)``."""
    try:
        if ":" in text:
            first, last, step = (int(part) for part in (*text.split(":"), "1")[:3])
            found = tuple(range(first, last + 1, step))
        else:
            found = tuple(int(part) for part in text.split(","))
    except ValueError:
        raise click.BadParameter(f"{text!r} is not like 4,8,12 or 4:12:4") from None
    if not found or found[0] < 2 or found[-1] > LARGEST:
        raise click.BadParameter(f"{text!r} does not lie from 2 to {LARGEST:,}")
    if any(a >= b for a, b in pairwise(found)):
        raise click.BadParameter(f"{text!r} does not increase")
    return found


@click.command(name="power")
@click.argument("task", required=False)
@number_option("--mean", click.FloatRange(0, 1), 0.5, "Mean adaptability in the population.")
@number_option(
    "--sd", click.FloatRange(0, 0.5), 0.25, "Its standard deviation (beta distribution)."
)
@number_option(
    "--noise", click.FloatRange(0, 1), 0.0, "Mean rate of inputs other than those meant."
)
@number_option(
    "--noise-sd",
    click.FloatRange(0, 0.5),
    0.0,
    "Its standard deviation among people (beta distribution); 0: the same for all.",
)
@number_option(
    "--lapses",
    click.FloatRange(0, 1),
    0.0,
    "Mean share of the steps in which people are absent-minded.",
)
@number_option(
    "--lapses-sd",
    click.FloatRange(0, 0.5),
    0.0,
    "Its standard deviation among people (beta distribution); 0: the same for all.",
)
@number_option(
    "--lapse-steps", click.FloatRange(1), 3.0, "Mean number of steps that a lapse lasts."
)
@click.option(
    "--sizes",
    type=_sizes,
    default="4:60:4",
    show_default=True,
    metavar="N,... or FIRST:LAST:STEP",
    help="Participants in each condition.",
)
@click.option("--trials", type=click.IntRange(1, 10), default=3, show_default=True)
@click.option(
    "--beliefs",
    type=click.Choice(("carry", "reset")),
    default="carry",
    show_default=True,
    help="What becomes of the robot's belief between trials.",
)
@click.option(
    "--between-trials",
    type=click.Choice(("keep", "anew")),
    default="keep",
    show_default=True,
    help="Whether people keep their mode from trial to trial or choose it anew.",
)
@click.option(
    "--first-mode", metavar="GOAL", help="The goal all want at first.  [that of least reward]"
)
@number_option(
    "--wanted", click.FloatRange(0, 1, min_open=True, max_open=True), 0.8, "The power to reach."
)
@click.option("--experiments", type=click.IntRange(10, 1_000_000), default=2000, show_default=True)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, metavar="N")
@click.option(
    "--figure",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Draw the power curve: .png, .svg or .pdf.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of a table.")
@setup_options
def command(
    *,
    task: str | None,
    mean: float,
    sd: float,
    noise: float,
    noise_sd: float,
    lapses: float,
    lapses_sd: float,
    lapse_steps: float,
    sizes: tuple[int, ...],
    trials: int,
    beliefs: str,
    between_trials: str,
    first_mode: str | None,
    wanted: float,
    experiments: int,
    seed: int,
    figure: Path | None,
    as_json: bool,
    **given: object,
) -> None:
    """How many participants a study needs, from simulated experiments.

    TASK is the name of a task, see `coadapt tasks`, or a .toml file; table clearing if left out.
    The study has the paper's three conditions, without, with mutual and with one-way adaptation,
    each with participants of its own. H1 says that teams do better in each than in the next. It is
    found if a Kruskal-Wallis test and Mann-Whitney tests of both pairs, with Bonferroni's
    correction, say so at the level 0.05.

    Participants differ in alpha, in how often their hands slip and in how often they are
    absent-minded. The robots know of alpha alone.

    The same seed gives the same numbers.
    """
    if figure is not None:
        require_writable(figure)
        if figure.suffix not in FIGURES:
            raise InputError(f"--figure must end in {', '.join(FIGURES)}, not {figure.name}")
    if given.pop("robot", None) is not None:
        raise InputError("--robot is not for power, which simulates all three robots")
    import numpy as np

    from coadapt.analysis.adaptability.beta import beta_weights, spread_of
    from coadapt.analysis.experiment.people import People
    from coadapt.analysis.experiment.pool import Protocol, simulate_pool
    from coadapt.analysis.experiment.power import (
        QUESTIONS,
        Conditions,
        participants_needed,
        power_curve,
    )

    try:
        spread = spread_of(mean, sd)
    except ValueError as error:
        raise InputError(f"--sd cannot be used: {error}") from error
    people = People(
        noise=_rates("noise", noise, noise_sd),
        lapses=_rates("lapses", lapses, lapses_sd),
        lapse_steps=lapse_steps,
    )
    setup = _setup(task, given)
    model = setup.model()
    protocol = Protocol(
        trials=trials,
        carry_belief=beliefs == "carry",
        keep_mode=between_trials == "keep",
        first_mode=_mode(model, first_mode),
    )
    rng = np.random.default_rng(seed)
    with progress_line(not as_json) as tell:
        robots = [_robot(setup, name).build(tell) for name in ROBOTS_IN_ORDER]
        tell("Simulating people in all conditions")
        pools = [simulate_pool(robot, protocol, rng, who=people) for robot in robots]
        weights = beta_weights(np.array(mean), np.array(spread), pools[0].points)
        points = power_curve(
            Conditions(*pools),
            weights,
            sizes,
            experiments,
            rng,
            tell=lambda n: tell(f"Simulating experiments: {n} participants in each condition"),
        )
        needed = [participants_needed(points, wanted, q) for q in range(len(QUESTIONS))]
        if figure is not None:
            from coadapt.report.figures import style
            from coadapt.report.figures.power import power

            with style.settings():
                drawn = power(
                    points, needed, wanted, _population(mean, sd, people).replace("; ", "\n")
                )
                figure.write_bytes(style.render(drawn, figure.suffix[1:]))
    names = model.mode_names
    wants = None if protocol.first_mode is None else names[protocol.first_mode]
    if as_json:
        record = {
            "task": model.world.name,
            "population": {"mean": mean, "sd": sd, **asdict(people)},
            "trials": trials,
            "beliefs": beliefs,
            "between_trials": between_trials,
            "first_mode": wants,
            "seed": seed,
            "wanted": wanted,
            "questions": list(QUESTIONS),
            "points": [asdict(point) for point in points],
            "needed": dict(zip(QUESTIONS, (asdict(n) for n in needed), strict=True)),
        }
        click.echo(json.dumps(record))
        return
    click.echo(
        printable(
            f"{model.world.name}: {_population(mean, sd, people)}; {trials} trials, "
            f"beliefs {beliefs}, modes {between_trials}, first goal {wants}"
        )
    )
    click.echo("\n".join(_lines(points, needed, wanted)))
    if figure is not None:
        click.echo(f"Figure saved to {printable(str(figure))}")


def _rates(name: str, mean: float, sd: float) -> Rates:
    from coadapt.analysis.experiment.people import Rates

    try:
        return Rates(mean, sd)
    except ValueError as error:
        raise InputError(f"--{name}-sd cannot be used: {error}") from error


def _population(mean: float, sd: float, people: People) -> str:
    """In a few words; of noise and lapses only where there are any."""
    said = [f"alpha: mean {mean:g}, SD {sd:g}"]
    for name, rates in (("noise", people.noise), ("lapses", people.lapses)):
        if rates.mean > 0:
            said.append(f"{name}: mean {rates.mean:g}, SD {rates.sd:g}")
    return "; ".join(said)


ROBOTS_IN_ORDER = ("no_adaptation", "mutual_adaptation", "one_way_adaptation")


def _lines(points: list[PowerPoint], needed: list[Needed], wanted: float) -> list[str]:
    from coadapt.analysis.experiment.power import QUESTIONS

    lines = ["", "Probability of finding it (95 % Monte-Carlo interval)"]
    lines.append("     n  " + "".join(f"{question:>26}" for question in QUESTIONS))
    for point in points:
        cells = [
            f"{power:6.1%} ({low:6.1%} to {high:6.1%})"
            for power, low, high in zip(point.power, point.low, point.high, strict=True)
        ]
        lines.append(f"  {point.n:4}  " + "".join(f"{cell:>26}" for cell in cells))
    lines.append("")
    for question, found in zip(QUESTIONS, needed, strict=True):
        if found.n is None:
            text = f"{wanted:.0%} is not reached"
        else:
            surely = "" if found.surely is None else f", surely with {found.surely}"
            text = f"{wanted:.0%} with {found.n} participants in each condition{surely}"
        lines.append(f"{question}: {text}")
    return lines


def _setup(task: str | None, given: Mapping[str, object]) -> AnySetup:
    from coadapt.cli.problems import task_setup
    from coadapt.robots.setup import RobotSetup

    return changed_setup(RobotSetup() if task is None else task_setup(task), given)


def _robot(setup: AnySetup, name: str) -> AnySetup:
    from coadapt.robots.task_setup import changed

    return changed(setup, {"robot": name})


def _mode(model: SharedAutonomy, name: str | None) -> int:
    if name is None:
        rewards = [goal.reward for goal in model.world.goals]
        return rewards.index(min(rewards))
    if name not in model.mode_names:
        names = ", ".join(model.mode_names)
        raise InputError(f"--first-mode must be one of {names}, not {name!r}")
    return model.mode_names.index(name)
