"""Every file of the report of a study."""

from __future__ import annotations

from matplotlib.figure import Figure

from coadapt.analysis.analyse import Analysis
from coadapt.analysis.record import to_json
from coadapt.report.figures import style
from coadapt.report.study.latex import latex_files
from coadapt.report.study.page import render_page
from coadapt.report.study.panels import panels
from coadapt.report.study.tables import tables
from coadapt.report.study.timelines import MOST_PEOPLE, timelines, with_courses
from coadapt.report.write import NUMBERS, PAGE


def make_study_files(found: Analysis) -> dict[str, bytes]:
    """Every file by its name, directories before it with a slash."""
    shown: dict[str, tuple[int, int]] = {}
    with style.settings():
        drawn: dict[str, Figure] = {"panels": panels(found)}
        for condition in found.data.conditions:
            people = with_courses(found, condition)
            if people:
                some = people[:MOST_PEOPLE]
                shown[condition] = len(some), len(people)
                drawn[f"timelines_{condition}"] = timelines(found, some)
        files = {
            f"figures/{name}.{kind}": style.render(figure, kind)
            for name, figure in drawn.items()
            for kind in ("svg", "png")
        }
    svgs = {name: files[f"figures/{name}.svg"].decode() for name in drawn}
    files |= {f"tables/{data.name}.csv": data.csv() for data in tables(found)}
    files |= latex_files(found)
    files[NUMBERS] = to_json(found)
    return {PAGE: render_page(found, svgs, shown, sorted(files)).encode(), **files}
