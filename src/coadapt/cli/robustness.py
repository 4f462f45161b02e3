"""``coadapt robustness``: what a robot loses with people who are not as it assumes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from coadapt.cli.options import setup_options
from coadapt.cli.progress import progress_line
from coadapt.errors import InputError, printable

if TYPE_CHECKING:
    from coadapt.formalism import SharedAutonomy
    from coadapt.simulation import DescribedPartner
    from coadapt.simulation.robustness import Robustness


@click.command(name="robustness")
@click.argument("task", required=False)
@click.option(
    "--partner",
    type=click.FloatRange(0, 1),
    default=0.5,
    show_default=True,
    metavar="ALPHA",
    help="Adaptability of the people.",
)
@click.option(
    "--partner-kind",
    "kinds",
    multiple=True,
    metavar="KIND",
    help="Only people of this kind; may be repeated.  [all, see `coadapt partners`]",
)
@click.option(
    "--mode", metavar="GOAL", help="The goal they want at first.  [drawn from the task's prior]"
)
@click.option(
    "--runs",
    type=click.IntRange(2, 1_000_000),
    default=10_000,
    show_default=True,
    metavar="N",
    help="Episodes with each kind.",
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, metavar="N")
@click.option(
    "--max-steps", type=click.IntRange(1, 100_000), default=1000, show_default=True, metavar="N"
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of a table.")
@setup_options
def command(
    *,
    task: str | None,
    partner: float,
    kinds: tuple[str, ...],
    mode: str | None,
    runs: int,
    seed: int,
    max_steps: int,
    as_json: bool,
    **given: object,
) -> None:
    """Measure what a robot loses with people who break its model.

    TASK is as for `coadapt simulate`. Beside the mutual-adaptation robot stands one that was
    planned for exactly these people and knows all about them but the goal they head for.
    """
    from coadapt.cli.simulate import mode_index, setup_of
    from coadapt.robots import MutualAdaptation
    from coadapt.simulation.robustness import robustness

    setup = setup_of(task, given)
    model = setup.model()
    first = mode_index(model, mode)
    with progress_line(not as_json) as tell:
        robot = setup.build(tell)
        if not isinstance(robot, MutualAdaptation):
            raise InputError(f"robustness is measured of mutual_adaptation, not of {robot.name}")
        partners, left_out = _partners(kinds, partner, first, robot.model)
        found = robustness(
            robot,
            partners,
            runs=runs,
            seed=seed,
            gap=setup.gap,
            max_steps=max_steps,
            progress=tell,
        )
    if as_json:
        rows = [_record(row) for row in found]
        task_name = model.world.name
        click.echo(
            json.dumps(
                {
                    "task": task_name,
                    "partner": partner,
                    "mode": mode,
                    "runs": runs,
                    "seed": seed,
                    "rows": rows,
                    "left_out": left_out,
                }
            )
        )
        return
    click.echo(printable(f"{model.world.name}, people with alpha {partner:g}, {runs:,} runs each"))
    click.echo("\n".join(_lines(found)))
    for name, reason in left_out.items():
        click.echo(printable(f"Left out: {name}: {reason}"))


def _partners(
    kinds: Sequence[str], alpha: float, mode: int | None, model: SharedAutonomy
) -> tuple[dict[str, DescribedPartner], dict[str, str]]:
    """One person of each kind, and why there is none of some."""
    from coadapt.cli.partners import partner_of
    from coadapt.simulation.partners import KINDS

    people: dict[str, DescribedPartner] = {}
    left_out: dict[str, str] = {}
    for kind in kinds or KINDS:
        try:
            people[kind] = partner_of(kind, (), (alpha,), mode, model)
        except InputError as error:
            if kinds:
                raise
            left_out[kind] = str(error)
    return people, left_out


def _record(row: Robustness) -> dict[str, object]:
    record: dict[str, object] = {"partner": row.name}
    for name, mean in (
        ("return_lost", row.return_lost),
        ("reward", row.assuming.reward),
        ("reward_knowing", row.knowing.reward),
        ("reward_lost", row.reward_lost),
        ("disagreement", row.assuming.disagreement),
        ("disagreement_knowing", row.knowing.disagreement),
        ("disagreement_added", row.disagreement_added),
    ):
        if mean is not None:
            record[name] = {"mean": mean.mean, "standard_error": mean.standard_error}
    return {
        **record,
        "no_goal": row.assuming.no_goal,
        "no_goal_knowing": row.knowing.no_goal,
    }


def _lines(found: Sequence[Robustness]) -> list[str]:
    head = ["person", "return lost", "reward", "if known", "lost"]
    rows = [[*head, "disagreement", "if known", "added"]]
    for row in found:
        value, lost, added = row.return_lost, row.reward_lost, row.disagreement_added
        rows.append(
            [
                row.name,
                "-" if value is None else f"{value.mean:.3f} +- {value.standard_error:.3f}",
                f"{row.assuming.reward.mean:.3f}",
                f"{row.knowing.reward.mean:.3f}",
                f"{lost.mean:.3f} +- {lost.standard_error:.3f}",
                f"{row.assuming.disagreement.mean:.3f}",
                f"{row.knowing.disagreement.mean:.3f}",
                f"{added.mean:.3f} +- {added.standard_error:.3f}",
            ]
        )
    first, *widths = (max(map(len, column)) for column in zip(*rows, strict=True))
    return ["  ".join([name.ljust(first), *map(str.rjust, cells, widths)]) for name, *cells in rows]
