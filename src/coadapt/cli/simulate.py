"""``coadapt simulate``: a robot with simulated people."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from coadapt.cli.options import changed_built, changed_setup, numbers, setup_options
from coadapt.cli.outputs import require_writable
from coadapt.cli.progress import progress_line
from coadapt.errors import InputError, printable

if TYPE_CHECKING:
    from coadapt.formalism import Model
    from coadapt.robots.built_setup import BuiltSetup
    from coadapt.robots.task_setup import AnySetup


@click.command(name="simulate")
@click.argument("task", required=False)
@click.option(
    "--episodes", type=click.IntRange(1, 1_000_000), default=1000, show_default=True, metavar="N"
)
@click.option(
    "--partner",
    type=numbers,
    default="0.5",
    metavar="ALPHA",
    help="Adaptability of the simulated person, one number or one for each goal.  [0.5]",
)
@click.option(
    "--partner-kind",
    "kind",
    default="follower",
    metavar="KIND",
    help="What kind of person they are, see `coadapt partners`.  [follower]",
)
@click.option(
    "--partner-number",
    "kind_numbers",
    multiple=True,
    metavar="NAME=VALUE",
    help="One of the numbers that describe the kind.",
)
@click.option(
    "--mode", metavar="GOAL", help="The goal they want at first.  [drawn from the task's prior]"
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, metavar="N")
@click.option(
    "--max-steps",
    type=click.IntRange(1, 100_000),
    default=1000,
    show_default=True,
    metavar="N",
    help="An episode without a goal ends after as many.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of a table.")
@click.option(
    "--log",
    "path",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Save the inputs and decisions, for `coadapt replay`.",
)
@setup_options
def command(
    *,
    task: str | None,
    episodes: int,
    partner: tuple[float, ...],
    kind: str,
    kind_numbers: tuple[str, ...],
    mode: str | None,
    seed: int,
    max_steps: int,
    as_json: bool,
    path: Path | None,
    **given: object,
) -> None:
    """Run a robot with simulated people.

    TASK is the name of a task, see `coadapt tasks`, or a .toml file; table clearing if left out.
    Each episode is one trial with a person of the given kind, who follows the adaptation model if
    no other is named. The same seed gives the same episodes.
    """
    import numpy as np

    from coadapt.cli.partners import partner_of
    from coadapt.cli.simulate_output import summary_lines, summary_record
    from coadapt.robots import Collaborator
    from coadapt.robots.built_setup import BuiltSetup
    from coadapt.simulation import simulate, simulate_batch, summarize

    setup = setup_of(task, given)
    model = setup.model()
    first = mode_index(model, mode)
    if len(partner) not in (1, len(model.mode_names)):
        goals = len(model.mode_names)
        raise InputError(f"--partner must be one number or {goals}, not {len(partner)}")
    if not all(0 <= alpha <= 1 for alpha in partner):
        raise InputError(f"--partner must lie from 0 to 1, not {','.join(map(str, partner))}")
    person = partner_of(kind, kind_numbers, partner, first, model)
    if path is not None:
        if isinstance(setup, BuiltSetup):
            raise InputError(f"--log is not for {task}, in which the person moves the world")
        require_writable(path)
    with progress_line(not as_json) as tell:
        robot = setup.build(tell)
        tell(f"Simulating {episodes:,} episodes")
        batch = simulate_batch(
            robot, person, episodes, np.random.default_rng(seed), max_steps=max_steps, beliefs=True
        )
        if not (path is None or isinstance(setup, BuiltSetup) or isinstance(robot, Collaborator)):
            from coadapt.simulation.log_writer import whole_log

            # The same episodes step by step.
            rng = np.random.default_rng(seed)
            found = simulate(robot, person, episodes, rng, max_steps=max_steps)
            with whole_log(path, robot, setup, participants=True) as log:
                for number, episode in enumerate(found, start=1):
                    for step, decision in enumerate(episode.decisions):
                        log.write(float(step), number, decision, str(number))
    summary = summarize(batch, robot.model, levels=robot.planning_model.alpha.levels)
    if as_json:
        record = {
            "task": model.world.name,
            "robot": robot.name,
            "partner": partner[0] if len(partner) == 1 else list(partner),
            "partner_kind": kind,
            "partner_numbers": list(kind_numbers),
            "mode": mode,
            "seed": seed,
            **summary_record(summary, model),
            "log": None if path is None else str(path),
        }
        click.echo(json.dumps(record))
        return
    wanted = "a first goal drawn from the prior" if mode is None else f"{mode} as first goal"
    alpha = "/".join(f"{value:g}" for value in partner)
    who = "person" if kind == "follower" else f"{' '.join([kind, *kind_numbers])} person"
    heading = f"{model.world.name}, {robot.name}, a {who} with alpha {alpha} and {wanted}"
    click.echo(printable(heading))
    click.echo("\n".join(printable(line) for line in summary_lines(summary, model)))
    if path is not None:
        click.echo(f"Log saved to {printable(str(path))}")


def setup_of(task: str | None, given: Mapping[str, object]) -> AnySetup | BuiltSetup:
    """What the robot is built from, for the task or the file that ``task`` names."""
    from coadapt.robots.setup import RobotSetup
    from coadapt.robots.task_setup import TaskSetup
    from coadapt.tasks import BuiltTask, load_task

    if task is None:
        return changed_setup(RobotSetup(), given)
    found = load_task(task)
    if isinstance(found, BuiltTask):
        return changed_built(found, given)
    return changed_setup(TaskSetup(task=found), given)


def mode_index(model: Model, name: str | None) -> int | None:
    """The mode that an option names; None if it names none."""
    if name is None:
        return None
    if name not in model.mode_names:
        raise InputError(f"--mode must be one of {', '.join(model.mode_names)}, not {name!r}")
    return model.mode_names.index(name)
