"""The page on analysing a study: its files can be used as they stand."""

from __future__ import annotations

import re
from pathlib import Path

from coadapt.analysis.analyse import analyse
from coadapt.analysis.data import read_data, read_declaration
from coadapt.hypotheses import BY_TEST

PAGE = Path(__file__).parents[1] / "docs" / "how-to" / "analyse-a-study.md"


def blocks(kind: str) -> list[str]:
    """The blocks of one kind, in order."""
    return re.findall(rf"^```{kind}\n(.*?)^```$", PAGE.read_text("utf-8"), re.DOTALL | re.MULTILINE)


def test_the_plan_and_the_table_go_together(tmp_path: Path) -> None:
    plan, own = tmp_path / "plan.toml", tmp_path / "own.csv"
    plan.write_text(*blocks("toml"))
    own.write_text(blocks("csv")[0])
    declared, _ = read_declaration(plan)
    assert [h.name for h in declared.hypotheses] == ["H1", "H2"]
    data = read_data(own, plan)
    assert data.problems == () and not any("not used" in note for note in data.notes)
    found = analyse(data)
    # The second item is reversed: 6 - 5, with 4.
    assert found.people[0].scores["trust"] == (4 + 1) / 2
    assert found.people[0].performance == (11 + 11 + 10) / 3


def test_the_counts(tmp_path: Path) -> None:
    (tmp_path / "counts.csv").write_text(blocks("csv")[1])
    assert read_data(tmp_path / "counts.csv").flow.analysed == {
        "no_adaptation": 19,
        "mutual_adaptation": 11,
    }


def test_every_test_is_named() -> None:
    text = PAGE.read_text("utf-8")
    for test, pairs in BY_TEST.items():
        for name in (test, *pairs):
            assert f"`{name}`" in text
