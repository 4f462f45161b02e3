"""The report of a study as one HTML page that needs nothing else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from coadapt import __version__
from coadapt.analysis.analyse import Analysis
from coadapt.analysis.measures import disagreement_cost
from coadapt.analysis.scales import Reliability
from coadapt.analysis.tests import Check, Effect, Found, Group, TestResult, apa
from coadapt.report.html import Grid, environment, fixed, inline_svg, percent
from coadapt.report.study.looks import spoken, title_of
from coadapt.report.study.tables import all_tests
from coadapt.report.study.words import checklist, method

NONE = "–"

CORRECTED = {"bonferroni": "Bonferroni", "holm": "Holm", "studentised range": "range"}


def render_page(
    found: Analysis,
    svgs: Mapping[str, str],
    shown: Mapping[str, tuple[int, int]],
    files: Sequence[str],
) -> str:
    """The page.

    Args:
        found: the analysis.
        svgs: the figures ``panels`` and ``timelines_CONDITION`` as SVG documents.
        shown: by condition with timelines, how many participants are drawn, of how many.
        files: names of the files that lie beside the page.
    """
    made, data = environment(), found.data
    made.filters["title_of"] = title_of
    made.filters["spoken"] = partial(spoken, conditions=data.conditions)
    return made.get_template("study.html.j2").render(
        version=__version__,
        found=found,
        title=data.declared.title or data.source,
        people=len(data.people),
        conditions=data.conditions,
        cost=disagreement_cost(data),
        facts=_facts(found),
        left_out=sum(data.flow.left_out.values()),
        figure={name: inline_svg(text, name) for name, text in svgs.items()},
        panels_alt=_alt(found),
        measure_table=_measures(found),
        scale_tables=[_scale(scale) for scale in found.scales],
        test_tables=_tests(found),
        assumption_table=_assumptions(found),
        problem_table=_problems(found),
        courses=[_course(name, *count) for name, count in shown.items()],
        method=method(found),
        checklist_table=Grid(
            "What readers ask for",
            ("item", "what these data say", "to be written by you"),
            checklist(found),
            text_columns=3,
        ),
        files=files,
    )


def _facts(found: Analysis) -> list[dict[str, str]]:
    facts = [
        {
            "name": f"{tested.hypothesis}: {title_of(tested.outcome).lower()}",
            "value": tested.verdict,
            "note": _short(tested.overall),
        }
        for tested in found.tested
    ]
    problems = len(found.data.problems)
    note = "listed row by row below" if problems else "nothing was found wrong"
    return [*facts, {"name": "Bad data", "value": f"{problems}", "note": note}]


def _short(found: Found) -> str:
    if not isinstance(found, TestResult):
        return found.reason
    df = apa.degrees(found.df)
    return (
        f"{found.test}: {found.symbol}{df} = {apa.number(found.statistic)}, {apa.p_value(found.p)}"
    )


def _alt(found: Analysis) -> str:
    texts = [
        f"{title_of(s.measure)}: "
        + ", ".join(f"{title_of(g.name)} {fixed(g.mean, 2)}" for g in s.groups)
        for s in found.summaries
        if s.measure == "performance" or s.measure in {scale.scale for scale in found.scales}
    ]
    return "Means by condition. " + ". ".join(texts) + "."


def _measures(found: Analysis) -> Grid:
    rows: list[list[str]] = []
    for summary in found.summaries:
        by_name = {group.name: group for group in summary.groups}
        cells = [_group(by_name.get(name)) for name in found.data.conditions]
        rows.append([title_of(summary.measure), *cells])
    switched = [
        [p.switched for p in found.people if p.condition == name and p.switched is not None]
        for name in found.data.conditions
    ]
    if any(switched):
        shares = [f"{sum(s)} of {len(s)}" if s else NONE for s in switched]
        rows.append(["Switched to another goal", *shares])
    head = ["measure", *(title_of(name) for name in found.data.conditions)]
    return Grid("Measures by condition", head, rows)


def _group(group: Group | None) -> str:
    if group is None:
        return NONE
    sd = NONE if group.sd is None else fixed(group.sd, 2)
    return f"{fixed(group.mean, 2)} ({sd}); {fixed(group.median, 2)}"


def _scale(scale: Reliability) -> dict[str, object]:
    shown = [apa.effect(e) for e in (scale.alpha, scale.spearman_brown) if e is not None]
    text = f"{title_of(scale.scale)}, from {scale.n} who answered every item. "
    text += (f"{'; '.join(shown)}. " if shown else "") + " ".join(scale.notes)
    rows = [
        [
            item.name,
            f"{item.n}",
            f"{item.missing}",
            _number(item.mean),
            _number(item.sd),
            NONE if item.lowest is None else percent(item.lowest, 0),
            NONE if item.highest is None else percent(item.highest, 0),
            _number(item.rest),
            _number(item.alpha_without),
        ]
        for item in scale.items
    ]
    head = (
        "item",
        "n",
        "missing",
        "mean",
        "SD",
        "at lowest",
        "at highest",
        "item-rest r",
        "α without",
    )
    return {"text": text, "grid": Grid(f"Items of {scale.scale}", head, rows)}


def _number(value: float | None, digits: int = 2) -> str:
    return NONE if value is None else fixed(value, digits)


def _tests(found: Analysis) -> list[Grid]:
    head = ("part", "test", "groups", "statistic", "p", "corrected p", "effect")
    grids: dict[str, list[list[str]]] = {}
    for hypothesis, outcome, part, one in all_tests(found):
        caption = f"{hypothesis}: {title_of(outcome).lower()}" if hypothesis else f"{outcome}?"
        grids.setdefault(caption, []).append([part, *_test(one, found.data.conditions)])
    return [Grid(caption, head, rows, text_columns=4) for caption, rows in grids.items()]


def _test(found: Found, conditions: Sequence[str]) -> list[str]:
    names = found.names if isinstance(found, TestResult) else found.groups
    groups = " – ".join(map(title_of, names)) if len(names) < len(conditions) else "all"
    if not isinstance(found, TestResult):
        return [found.test, groups, spoken(found.reason, conditions), NONE, NONE, NONE]
    statistic = f"{found.symbol}{apa.degrees(found.df)} = {apa.number(found.statistic, 3)}"
    if "U1" in found.details:
        statistic = f"U = {found.statistic:g}, U1 = {found.details['U1']:g}"
    corrected = NONE
    if found.comparisons > 1:
        name = CORRECTED.get(found.correction, found.correction)
        corrected = f"{_p(found.adjusted)} ({name}, {found.comparisons})"
    effect = _effect(found.effects[0]) if found.effects else NONE
    return [found.test, groups, statistic, _p(found.p), corrected, effect]


def _p(value: float) -> str:
    return "< .001" if value < 0.001 else apa.proportion(value, 3)


def _effect(effect: Effect) -> str:
    name = effect.name.split(",")[0]
    low, high = fixed(effect.low, 2), fixed(effect.high, 2)
    return f"{name} {fixed(effect.value, 2)} [{low}, {high}]"


def _assumptions(found: Analysis) -> Grid:
    rows: list[list[str]] = []
    for hypothesis, outcome, _, one in all_tests(found):
        if not isinstance(one, TestResult):
            continue
        about = f"{hypothesis} {outcome}".strip()
        for check in one.assumptions:
            row = [about, one.test, check.assumption, check.method, *_check(check)]
            row = [spoken(cell, found.data.conditions) for cell in row]
            if row not in rows:
                rows.append(row)
    head = ("about", "test", "assumption", "looked at by", "result", "note")
    return Grid("Assumptions", head, rows, text_columns=6)


def _check(check: Check) -> list[str]:
    result = NONE
    if check.holds is not None:
        result = "nothing against it" if check.holds else "data speak against it"
    if check.p is not None:
        result += f", {apa.p_value(check.p)}"
    return [result, check.note or NONE]


def _problems(found: Analysis) -> Grid | None:
    if not found.data.problems:
        return None
    rows = [
        [p.place, p.participant or NONE, p.column or NONE, p.found, p.expected, p.done]
        for p in found.data.problems
    ]
    head = ("where", "participant", "column", "found", "expected", "what was done")
    return Grid("What is wrong in the data", head, rows, text_columns=6)


def _course(condition: str, drawn: int, people: int) -> dict[str, str]:
    some = (
        f"The first {drawn} of {people} participants"
        if drawn < people
        else f"All {people} participants"
    )
    return {
        "name": f"timelines_{condition}",
        "title": title_of(condition),
        "shown": f"{some} of {title_of(condition)} whose steps were recorded.",
    }
