"""``coadapt analyse``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from coadapt.cli import main
from tests.analysis.exported import Tables, export
from tests.analysis.test_analyse import COUNTS


def test_counts_as_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "counts.csv").write_text(COUNTS)
    assert main(["analyse", str(tmp_path / "counts.csv"), "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    (tested,) = record["tested"]
    # Sec. 7.1
    assert round(tested["overall"]["statistic"], 2) == 39.84
    assert [p["found"]["details"]["U_min"] for p in tested["pairs"]] == [28.5, 49.5]
    assert [p["found"]["comparisons"] for p in tested["pairs"]] == [2, 2]
    assert "differ from the questionnaire" in " ".join(record["notes"])


def test_an_export(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def change(tables: Tables) -> None:
        tables["answers"][0]["value"] = 9

    folder, out = export(tmp_path / "x", change), tmp_path / "out"
    assert main(["analyse", str(folder), "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert "H1: Teams perform better" in said
    assert "value: found '9', expected a point from 1 to 5; treated as a missing answer" in said
    assert str(out / "report.html") in said
    assert (out / "tables" / "tests.csv").is_file()
    assert json.loads((out / "results.json").read_bytes())["plan"]["status"] == "declared"


@pytest.mark.parametrize(
    ("name", "says"),
    [("absent.csv", "found no readable file"), (".", "found no protocol")],
)
def test_data_that_cannot_be_read(
    name: str, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["analyse", str(tmp_path / name)]) == 2
    said = capsys.readouterr().err
    assert says in said and said.count("\n") == 1


def test_a_plan_that_cannot_be_used(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "counts.csv").write_text(COUNTS)
    plan = tmp_path / "plan.toml"
    plan.write_text('[[hypotheses]]\nname = "H"\ntext = "t"\noutcomes = ["x"]\norder = ["a"]\n')
    assert main(["analyse", str(tmp_path / "counts.csv"), "--plan", str(plan)]) == 2
    said = capsys.readouterr().err
    assert "plan.toml:1" in said or "plan.toml:5" in said
    assert "order must be at least 2 names" in said
