"""Tables and sentences for a paper in LaTeX.

Any of its programs reads them; letters that are not Latin need XeLaTeX or LuaLaTeX and a font that
has them. Tables of tests are as wide as the page, also in two columns.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from coadapt.analysis.analyse import Analysis
from coadapt.analysis.tests import Found, TestResult, apa
from coadapt.report.html import fixed
from coadapt.report.study.looks import spoken, title_of
from coadapt.report.study.tables import all_tests
from coadapt.report.study.words import method

NOTHING = "–"
"""Where there is nothing to say."""

WIDTHS = (0.20, 0.22, 0.17, 0.09, 0.24)
"""Of the columns of a table of tests, as parts of the page's width."""


def latex_files(found: Analysis) -> dict[str, bytes]:
    """The files by their names, to be read by ``\\input``."""
    sentences = [spoken(one.sentence, found.data.conditions) for *_, one in all_tests(found)]
    texts = {
        "measures": _measures(found),
        "tests": _tests(found),
        "sentences": "\n\n".join(map(escaped, sentences)),
        "method": escaped(method(found)),
    }
    return {f"tables/{name}.tex": f"{text}\n".encode() for name, text in texts.items()}


def _measures(found: Analysis) -> str:
    """Measures by condition."""
    lines = [
        r"% requires \usepackage{booktabs}",
        r"\begin{table}",
        r"\centering\small",
        r"\caption{Measures}",
        r"\begin{tabular}{@{}lrrrr@{}}",
        r"\toprule",
        r"Condition & $n$ & $M$ & $SD$ & $Mdn$ \\",
    ]
    for summary in found.summaries:
        lines += [r"\midrule", _heading(title_of(summary.measure), 5)]
        lines += [
            _row(title_of(g.name), str(g.n), _fixed(g.mean), _fixed(g.sd), _fixed(g.median))
            for g in summary.groups
        ]
    lines += [r"\bottomrule", r"\end{tabular}", r"\end{table}"]
    return "\n".join(lines)


def _tests(found: Analysis) -> str:
    """A table for each hypothesis, and one for what was looked at beside them."""
    lines = [r"% requires \usepackage{array,booktabs}"]
    for hypothesis, rows in groupby(all_tests(found), key=lambda row: row[0]):
        caption = f"Tests of {hypothesis}" if hypothesis else "Exploratory tests"
        columns = "".join(
            rf">{{\raggedright\arraybackslash}}p{{{width}\textwidth}}" for width in WIDTHS
        )
        lines += [
            r"\begin{table*}",
            r"\centering\footnotesize\setlength{\tabcolsep}{3pt}",
            rf"\caption{{{escaped(caption)}. $p$ is corrected for the number of comparisons.}}",
            rf"\begin{{tabular}}{{@{{}}{columns}@{{}}}}",
            r"\toprule",
            r"Test & Conditions & Statistic & $p$ & Effect \\",
        ]
        for outcome, some in groupby(rows, key=lambda row: row[1]):
            lines += [r"\midrule", _heading(title_of(outcome), len(WIDTHS))]
            lines += [_row(*_test(one, found.data.conditions)) for *_, one in some]
        lines += [r"\bottomrule", r"\end{tabular}", r"\end{table*}"]
    return "\n".join(lines)


def _test(one: Found, conditions: Sequence[str]) -> tuple[str, ...]:
    """The cells of a test."""
    names = one.names if isinstance(one, TestResult) else one.groups
    compared = "all" if set(names) == set(conditions) else ", ".join(map(title_of, names))
    if not isinstance(one, TestResult):
        return (one.test, compared, NOTHING, NOTHING, NOTHING)
    return (
        one.test,
        compared,
        f"{one.symbol}{apa.degrees(one.df)} = {apa.number(one.statistic)}",
        apa.p_value(one.adjusted).removeprefix("p ").removeprefix("= "),
        apa.effect(one.effects[0]) if one.effects else NOTHING,
    )


def _heading(text: str, columns: int) -> str:
    return rf"\multicolumn{{{columns}}}{{@{{}}l}}{{\textit{{{escaped(text)}}}}} \\"


def _row(*cells: str) -> str:
    row = " & ".join(map(escaped, cells)) + r" \\"
    # At the end of the row before, `\\` would take these for its own.
    return "{}" + row if row[0] in "[*" else row


def _fixed(value: float | None) -> str:
    return NOTHING if value is None else fixed(value, 2)


SIGNS = {
    "\\": r"\textbackslash{}",
    "&": r"\&",
    "%": r"\%",
    "$": r"\$",
    "#": r"\#",
    "_": r"\_",
    "{": r"\{",
    "}": r"\}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": "$<$",
    ">": "$>$",
    "|": r"\textbar{}",
    "−": "$-$",
    "±": r"$\pm$",
    "×": r"$\times$",
    "≥": r"$\geq$",
    "≤": r"$\leq$",
    "²": r"\textsuperscript{2}",
    "χ": r"$\chi$",
    "ε": r"$\varepsilon$",
    "η": r"$\eta$",
    "φ": r"$\varphi$",
    "ω": r"$\omega$",
    "α": r"$\alpha$",
    "ρ": r"$\rho$",
    "–": "--",
    "’": "'",
    "“": "``",
    "”": "''",
}
"""What LaTeX needs for signs that are its own, or that its fonts do not have."""


def escaped(text: str) -> str:
    """``text`` on one line, for LaTeX."""
    return "".join(SIGNS.get(sign, sign) for sign in " ".join(text.split()))
