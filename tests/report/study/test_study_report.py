"""The report of a study: a page that needs nothing else, figures, and tables for a paper."""

from __future__ import annotations

import csv
import io
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import msgspec
import numpy as np
import pytest

from coadapt.analysis.analyse import Analysis, analyse
from coadapt.analysis.data import read_data
from coadapt.report.study.files import make_study_files
from coadapt.report.study.latex import escaped, latex_files
from coadapt.report.study.looks import looks, spoken, title_of, two_lines
from coadapt.report.study.panels import mean_interval
from coadapt.report.study.timelines import done_with
from tests.analysis.exported import EACH, Tables, export


def change(tables: Tables) -> None:
    """A missing trial, and a title that would break a page that trusted it."""
    tables["trials"] = [t for t in tables["trials"] if (t["participant"], t["trial"]) != ("p04", 2)]
    tables["participants"][4]["condition"] = "<script>alert(1)</script>"


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Analysis:
    return analyse(read_data(export(tmp_path_factory.mktemp("study") / "x", change)))


@pytest.fixture(scope="module")
def files(found: Analysis) -> dict[str, bytes]:
    return make_study_files(found)


class Page(HTMLParser):
    """Collects identifiers, links, and what would be loaded from elsewhere."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.ids += [value for name, value in attrs if name == "id" and value]
        if tag == "a":
            self.links.append(given.get("href") or "")
        if tag in ("script", "link", "img", "iframe", "object"):
            self.loaded.append(tag)


def test_the_page_needs_nothing_else(files: dict[str, bytes]) -> None:
    text = files["report.html"].decode()
    page = Page(text)
    assert page.loaded == []
    assert not re.search(r"""(src|href)=["']https?:""", text)
    assert len(page.ids) == len(set(page.ids))
    assert {link.removeprefix("#") for link in page.links} <= set(page.ids)
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in text


def test_the_page_says_what_was_found(found: Analysis, files: dict[str, bytes]) -> None:
    text = files["report.html"].decode()
    for tested in found.tested:
        assert spoken(tested.overall.sentence, found.data.conditions).replace("<", "&lt;") in text
    assert "no row of trial 2" in text
    assert "without a value and left out: 1 in No adaptation" in text
    assert "The analysis is the declared one" in text
    assert text.count("<svg") == 4  # the panels, and timelines of three conditions


def test_tables_hold_everything(found: Analysis, files: dict[str, bytes]) -> None:
    rows = {
        name: list(csv.DictReader(io.StringIO(files[f"tables/{name}.csv"].decode())))
        for name in ("participants", "trials", "tests", "problems", "courses", "scales", "measures")
    }
    assert len(rows["participants"]) == len(found.people) == 3 * EACH - 1
    assert len(rows["trials"]) == len(found.trials)
    assert len(rows["problems"]) == len(found.data.problems) == 2
    assert len(rows["courses"]) == 3 * len(found.trials)
    assert [r["item"] for r in rows["scales"]][:2] == ["trust_right_thing", "trust_trustworthy"]
    first = rows["tests"][0]
    assert float(first["p"]) == found.tested[0].overall.p  # type: ignore[union-attr]
    assert first["sentence"] == found.tested[0].overall.sentence
    performance = {p.participant: p.performance for p in found.people}
    for row in rows["participants"]:
        value = performance[row["participant"]]
        assert row["performance"] == ("" if value is None else repr(value))


def test_latex_has_no_sign_of_its_own_unescaped(files: dict[str, bytes]) -> None:
    text = files["tables/sentences.tex"].decode()
    assert not re.search(r"(?<!\\)[#%&_]", text)
    assert text.isascii()
    assert "\\caption{Tests of H1." in files["tables/tests.tex"].decode()
    assert escaped("50 % & χ² < 1_a") == r"50 \% \& $\chi$\textsuperscript{2} $<$ 1\_a"


PAPER = r"""\documentclass[%s]{article}
\usepackage{array,booktabs}
\begin{document}
\input{tables/method}
\input{tables/measures}
\input{tables/tests}
\input{tables/sentences}
\end{document}
"""


AWKWARD = r"[*a_b] {5%} \x&#1~^$|"
"""A name that means something to LaTeX, at the beginning of a row too."""


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="LaTeX is not installed")
@pytest.mark.parametrize("columns", ["onecolumn", "twocolumn"])
@pytest.mark.parametrize("is_awkward", [False, True])
def test_a_paper_that_reads_the_files_compiles(
    tmp_path: Path, found: Analysis, columns: str, is_awkward: bool
) -> None:
    # Done by hand, too, with pdfTeX 1.40.24, XeTeX 0.999994 and LuaHBTeX 1.15.0.
    if is_awkward:
        rows = f"{AWKWARD},3,9\n{AWKWARD},2,9\nplain,1,9\nplain,2,9\n"
        (tmp_path / "c.csv").write_text(f"condition,optimal_trials,participants\n{rows}")
        found = analyse(read_data(tmp_path / "c.csv"))
    (tmp_path / "tables").mkdir()
    for name, text in latex_files(found).items():
        (tmp_path / name).write_bytes(text)
    assert (AWKWARD[:2] in (tmp_path / "tables" / "measures.tex").read_text()) == is_awkward
    (tmp_path / "paper.tex").write_text(PAPER % columns)
    ran = subprocess.run(
        ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "paper.tex"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    if "booktabs.sty' not found" in ran.stdout:
        pytest.skip("LaTeX's package booktabs is not installed")
    assert ran.returncode == 0, ran.stdout
    assert not re.findall("Overfull|Missing character|too large", ran.stdout), ran.stdout


def test_without_ratings_or_steps(tmp_path: Path) -> None:
    (tmp_path / "c.csv").write_text(
        "condition,optimal_trials,participants\na,3,4\nb,0,3\nb,1,2\n", encoding="utf-8"
    )
    found = analyse(read_data(tmp_path / "c.csv"))
    made = make_study_files(found)
    text = made["report.html"].decode()
    assert "There is no hypothesis to test" in text
    assert "Timelines" not in text and text.count("<svg") == 1
    assert make_study_files(found) == made  # the same data give the same bytes


def test_intervals_of_means() -> None:
    # R: t.test(c(1, 2, 3, 4))$conf.int is 0.4457397 to 4.5542603.
    mean, low, high = mean_interval(np.array([1.0, 2.0, 3.0, 4.0]))
    assert (mean, low, high) == pytest.approx((2.5, 0.4457397, 4.5542603), abs=1e-7)
    assert mean_interval(np.array([3.0, 3.0])) == (3.0, 3.0, 3.0)


def test_names() -> None:
    assert title_of("one_way_adaptation") == "One-way adaptation"
    assert two_lines("mutual_adaptation") == "Mutual\nadaptation"
    assert spoken("no_adaptation and x", ("no_adaptation",)) == "No adaptation and x"
    many = looks([f"c{i}" for i in range(9)])
    assert len(many) == 9


def test_what_the_robot_did(found: Analysis) -> None:
    step = found.data.people[0].trials[0].course[0]
    assert done_with(step) == "overrode"
    assert done_with(found.data.people[0].trials[0].course[1]) == "matched"
    assert done_with(msgspec.structs.replace(step, action=step.input)) == "followed"
    assert done_with(msgspec.structs.replace(step, input=None)) == "no input"
