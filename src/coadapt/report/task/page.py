"""The report of a task as one HTML page that needs nothing else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from coadapt import __version__
from coadapt.formalism import SharedAutonomy
from coadapt.momdp.sarsop import Status
from coadapt.report.html import Grid, environment, fixed, inline_svg, percent
from coadapt.report.task.results import RobotPerformance, TaskResults
from coadapt.simulation import Episode


def render_page(found: TaskResults, svgs: Mapping[str, str], files: Sequence[str]) -> str:
    """The page.

    Args:
        found: all results.
        svgs: the figures ``behaviour``, ``outcomes`` and ``beliefs`` as SVG documents.
        files: names of the files that lie beside the page.
    """
    world = found.model.world
    planned = found.planned
    return (
        environment()
        .get_template("task.html.j2")
        .render(
            version=__version__,
            found=found,
            world=world,
            best=world.goals[world.optimal_goal],
            first=found.model.mode_names[found.first_mode],
            planned=planned,
            shape=found.model.to_momdp().shape,
            certified=found.solution.status is Status.GAP,
            figure={name: inline_svg(text, name) for name, text in svgs.items()},
            performance_tables=[_performance(found, robot) for robot in found.robots],
            sample_tables=[
                _steps(found, episode, f"A run with a partner of α = {shown.alpha:g}")
                for episode, shown in zip(
                    planned.samples, (planned.by_alpha[0], planned.by_alpha[-1]), strict=True
                )
            ],
            parameter_table=_parameters(found),
            files=files,
        )
    )


def _performance(found: TaskResults, robot: RobotPerformance) -> Grid:
    goals = found.model.world.goals
    head = ["α", "reward", "standard error", *(f"ends at {g.name}" for g in goals)]
    head += ["steps", "steps seen as disagreement", "last estimate of α"]
    knows = len(robot.samples[0].decisions[-1].belief) == len(found.model.alpha.prior)
    rows = [
        [
            f"{p.alpha:g}",
            fixed(p.summary.reward.mean),
            fixed(p.summary.reward.standard_error),
            *(percent(float(share)) for share in p.summary.goals),
            fixed(p.summary.steps.mean, 1),
            fixed(p.summary.disagreement.mean, 2),
            fixed(p.estimate, 2) if knows else "–",
        ]
        for p in robot.by_alpha
    ]
    return Grid(robot.label, head, rows)


def _steps(found: TaskResults, episode: Episode, caption: str) -> Grid:
    model, world = found.model, found.model.world
    rows = [
        [
            f"{t}",
            world.state_names[d.state],
            model.mode_names[mode],
            "none" if d.human_input is None else model.input_names[d.human_input],
            world.action_names[d.action],
            fixed(float(d.belief.sum(axis=1) @ model.alpha.levels), 2),
            *(fixed(float(b), 2) for b in d.belief.sum(axis=0)),
        ]
        for t, (d, mode) in enumerate(zip(episode.decisions, episode.modes, strict=True), start=1)
    ]
    head = ["step", "state", "person’s mode", "input", "robot’s action", "estimate of α"]
    head += [f"b({name})" for name in model.mode_names]
    return Grid(caption, head, rows, text_columns=5)


def _parameters(found: TaskResults) -> Grid:
    model = found.model
    rows = [
        ("states of the world", f"{model.world.states}"),
        ("robot’s actions", ", ".join(model.world.action_names)),
        ("person’s inputs", ", ".join(model.input_names)),
        ("memory k, steps", f"{model.memory}"),
        ("adaptability", ", ".join(model.alpha.names)),
        ("discount γ", f"{model.discount:g}"),
    ]
    if isinstance(model, SharedAutonomy):
        rows.append(("cost of disagreement C", f"{model.disagreement_cost:g}"))
        rows.append(("cost of other actions C_a", f"{model.action_disagreement_cost:g}"))
    return Grid("Parameters", ("parameter", "value"), [list(row) for row in rows], text_columns=2)
