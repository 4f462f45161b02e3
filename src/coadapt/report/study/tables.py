"""The tables of the report: one form for CSV files and the page."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass

import msgspec

from coadapt.analysis.analyse import Analysis
from coadapt.analysis.measures import PersonMeasures, TrialMeasures
from coadapt.analysis.tests import Found, TestResult

Cell = str | float | int | bool | None


@dataclass(frozen=True)
class Data:
    """A table in full precision.

    Attributes:
        name: stem of its file.
        columns: their names.
        rows: a cell for each column; None where there is nothing to say.
    """

    name: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def csv(self) -> bytes:
        """The table as CSV."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows([[_plain(cell) for cell in row] for row in self.rows])
        return text.getvalue().encode()


def tables(found: Analysis) -> tuple[Data, ...]:
    """All tables."""
    return (
        participants(found),
        _structs("trials", TrialMeasures, found.trials),
        summaries(found),
        scales(found),
        tests(found),
        problems(found),
        courses(found),
    )


def participants(found: Analysis) -> Data:
    """Every participant in numbers."""
    names = [scale.name for scale in found.data.declared.scales]
    columns = [f.name for f in msgspec.structs.fields(PersonMeasures) if f.name != "scores"]
    rows = [
        (*(getattr(p, name) for name in columns), *(p.scores.get(name) for name in names))
        for p in found.people
    ]
    return Data("participants", (*columns, *names), tuple(rows))


def summaries(found: Analysis) -> Data:
    """Measures by condition."""
    rows = [
        (s.measure, g.name, g.n, g.mean, g.sd, g.median) for s in found.summaries for g in s.groups
    ]
    return Data("measures", ("measure", "condition", "n", "mean", "sd", "median"), tuple(rows))


def scales(found: Analysis) -> Data:
    """Every item in numbers, with the coefficients of its scale."""
    rows: list[tuple[Cell, ...]] = []
    for scale in found.scales:
        alpha, brown = scale.alpha, scale.spearman_brown
        coefficients: tuple[Cell, ...] = (
            *((alpha.value, alpha.low, alpha.high) if alpha else (None, None, None)),
            *((brown.value, brown.low, brown.high) if brown else (None, None, None)),
        )
        rows += [
            (
                scale.scale,
                item.name,
                item.n,
                item.missing,
                item.mean,
                item.sd,
                item.lowest,
                item.highest,
                item.rest,
                item.alpha_without,
                *coefficients,
            )
            for item in scale.items
        ]
    columns = ("scale", "item", "n", "missing", "mean", "sd", "lowest", "highest", "item_rest")
    of_scale = ("alpha", "alpha_low", "alpha_high")
    of_two = ("spearman_brown", "spearman_brown_low", "spearman_brown_high")
    return Data("scales", (*columns, "alpha_without", *of_scale, *of_two), tuple(rows))


def all_tests(found: Analysis) -> list[tuple[str, str, str, Found]]:
    """Every test as hypothesis, outcome, its part in it, and what it found."""
    rows: list[tuple[str, str, str, Found]] = []
    for t in found.tested:
        rows.append((t.hypothesis, t.outcome, "all conditions", t.overall))
        for pair in t.pairs:
            part = "pair" if pair.declared else "pair, beyond the hypothesis"
            rows.append((t.hypothesis, t.outcome, part, pair.found))
            if pair.equivalence is not None:
                rows.append((t.hypothesis, t.outcome, "equivalence", pair.equivalence))
        rows += [(t.hypothesis, t.outcome, "sensitivity", one) for one in t.sensitivity]
    rows += [("", e.question, "exploratory", e.found) for e in found.exploratory]
    return rows


def tests(found: Analysis) -> Data:
    """Every test."""
    rows: list[tuple[Cell, ...]] = []
    for hypothesis, outcome, part, one in all_tests(found):
        names = one.names if isinstance(one, TestResult) else one.groups
        head: tuple[Cell, ...] = (hypothesis, outcome, part, one.test, " | ".join(names))
        if isinstance(one, TestResult):
            effect = one.effects[0] if one.effects else None
            size = (
                (effect.name, effect.value, effect.low, effect.high, effect.level) if effect else ()
            )
            rows.append(
                (
                    *head,
                    one.symbol,
                    one.statistic,
                    " ".join(f"{df:g}" for df in one.df),
                    one.p,
                    one.comparisons,
                    one.correction,
                    one.adjusted,
                    *(size or (None,) * 5),
                    one.details.get("U1"),
                    one.details.get("U_min"),
                    one.sentence,
                )
            )
        else:
            rows.append((*head, *(None,) * 14, one.sentence))
    columns = ("hypothesis", "outcome", "part", "test", "groups", "symbol", "statistic", "df", "p")
    corrected = ("comparisons", "correction", "p_adjusted")
    effect = ("effect", "effect_value", "effect_low", "effect_high", "effect_level", "U1", "U_min")
    return Data("tests", (*columns, *corrected, *effect, "sentence"), tuple(rows))


def problems(found: Analysis) -> Data:
    """What is wrong in the data, and what was done about it."""
    columns = ("file", "line", "participant", "column", "found", "expected", "done")
    rows = [tuple(getattr(p, name) for name in columns) for p in found.data.problems]
    return Data("problems", columns, tuple(rows))


def courses(found: Analysis) -> Data:
    """Every recorded step of every trial."""
    alphas = found.data.adaptability
    rows: list[tuple[Cell, ...]] = []
    for person in found.data.people:
        for trial in person.trials:
            for t, step in enumerate(trial.course):
                whole = len(step.belief) == len(alphas)
                beliefs: Sequence[Cell] = step.belief if whole else (None,) * len(alphas)
                head = (person.name, person.condition, trial.number, t, step.input, step.action)
                rows.append((*head, step.matched, step.disagreement, step.towards, *beliefs))
    columns = ("participant", "condition", "trial", "step", "input", "action", "matched")
    beliefs = tuple(f"belief_{alpha:g}" for alpha in alphas)
    return Data("courses", (*columns, "disagreement", "towards_optimal", *beliefs), tuple(rows))


def _structs(name: str, kind: type[msgspec.Struct], rows: Sequence[msgspec.Struct]) -> Data:
    columns = tuple(field.name for field in msgspec.structs.fields(kind))
    return Data(name, columns, tuple(msgspec.structs.astuple(row) for row in rows))


def _plain(cell: Cell) -> str:
    if cell is None:
        return ""
    if isinstance(cell, bool):
        return "true" if cell else "false"
    return repr(cell) if isinstance(cell, float) else str(cell)
