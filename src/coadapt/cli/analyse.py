"""``coadapt analyse``: the data of a study."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from coadapt.cli.progress import progress_line
from coadapt.errors import printable

if TYPE_CHECKING:
    from coadapt.analysis.analyse import Analysis

MOST_PROBLEMS = 20
"""Problems that are shown; the report has all."""


@click.command(name="analyse")
@click.argument("data", type=click.Path(path_type=Path))
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    metavar="DIR",
    help="Write the report there: report.html, which needs nothing else, figures, tables as CSV "
    "and LaTeX. What else lies there is left alone.",
)
@click.option(
    "--plan",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Conditions, scales and hypotheses, as in a study.toml.  [that of an export]",
)
@click.option("--json", "as_json", is_flag=True, help="Print all numbers as one JSON object.")
def command(*, data: Path, out: Path | None, plan: Path | None, as_json: bool) -> None:
    """Analyse the data of a study: statistics, figures, report.

    DATA is a folder that `coadapt study export` wrote, a CSV file with a row for each participant,
    or one of counts with the columns condition, optimal_trials and participants.

    Tested are the hypotheses that the study declared, or else H1 and H2 of the paper. Whatever is
    wrong in the data is listed row by row with what was done about it.
    """
    from coadapt.analysis.analyse import analyse
    from coadapt.analysis.data import read_data

    with progress_line(not as_json) as tell:
        tell("Reading the data")
        if out is not None:
            from coadapt.report.write import require_writable

            require_writable(out)
        read = read_data(data, plan)
        tell("Testing")
        found = analyse(read)
        if out is not None:
            from coadapt.report.study.files import make_study_files
            from coadapt.report.write import write_files

            tell("Writing the report")
            write_files(make_study_files(found), out)
    if as_json:
        from coadapt.analysis.record import to_json

        click.echo(to_json(found), nl=False)
        return
    click.echo("\n".join(printable(line) for line in summary(found)))
    if out is not None:
        click.echo(f"\nReport: {printable(str((out / 'report.html').resolve()))}")


def summary(found: Analysis) -> list[str]:
    """The main findings as lines of plain text."""
    data = found.data
    sizes = ", ".join(f"{n} in {name}" for name, n in data.flow.analysed.items())
    lines = [f"{data.source}: {len(data.people)} participants analysed, {sizes}."]
    lines += [f"  left out: {n} {reason}" for reason, n in data.flow.left_out.items()]
    lines += [f"  {note}" for note in data.notes]
    lines += ["", found.plan.text]
    for hypothesis in found.plan.hypotheses:
        lines += ["", f"{hypothesis.name}: {hypothesis.text}"]
        for tested in found.tested:
            if tested.hypothesis != hypothesis.name:
                continue
            lines += [f"  {tested.outcome}: {tested.verdict}", f"    {tested.overall.sentence}"]
            for pair in tested.pairs:
                lines.append(f"    {pair.found.sentence}")
                if pair.equivalence is not None:
                    lines.append(f"    {pair.equivalence.sentence}")
    problems = data.problems
    if problems:
        shown = min(len(problems), MOST_PROBLEMS)
        lines += ["", f"Problems in the data, {shown} of {len(problems)}:"]
        for p in problems[:shown]:
            place = f"{p.place}, {p.participant}" if p.participant else p.place
            what = f"{p.column}: " if p.column else ""
            lines.append(f"  {place}: {what}found {p.found}, expected {p.expected}; {p.done}")
    return lines
