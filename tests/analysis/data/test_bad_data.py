"""What is wrong in data is listed row by row with what was done about it; nothing goes silently."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from coadapt.analysis.analyse import analyse
from coadapt.analysis.data import Problem, StudyData, read_data
from coadapt.analysis.data.export import ANSWER, PERSON, STEP, TRIAL
from coadapt.analysis.measures import reliabilities, scale_scores
from coadapt.errors import FileError
from coadapt.study.export import TABLES
from tests.analysis.exported import EACH, Tables, export


def only(data: StudyData) -> Problem:
    assert len(data.problems) == 1, data.problems
    return data.problems[0]


def row(tables: Tables, table: str, **given: Any) -> dict[str, Any]:
    return next(r for r in tables[table] if all(r[k] == v for k, v in given.items()))


def test_good_data_have_no_problems(tmp_path: Path) -> None:
    data = read_data(export(tmp_path / "x"))
    assert data.problems == ()
    assert len(data.people) == 3 * EACH
    assert data.flow.analysed == dict.fromkeys(data.conditions, EACH)
    assert data.flow.left_out == {}


def test_a_participant_twice(tmp_path: Path) -> None:
    def change(tables: Tables) -> None:
        tables["participants"].append(dict(row(tables, "participants", participant="p02")))

    data = read_data(export(tmp_path / "x", change))
    first, second = data.problems
    assert (first.line, second.line) == (3, 3 * EACH + 2)
    for problem in data.problems:
        assert problem.participant == "p02" and problem.column == "participant"
        assert problem.done == "the participant is left out of every analysis"
    assert "p02" not in [person.name for person in data.people]
    assert data.flow.left_out == {"several rows of one pseudonym": 2}
    assert data.flow.opened == len(data.people) + sum(data.flow.left_out.values())


def test_an_unknown_condition(tmp_path: Path) -> None:
    def change(tables: Tables) -> None:
        row(tables, "participants", participant="p05")["condition"] = "telepathy"

    data = read_data(export(tmp_path / "x", change))
    problem = only(data)
    assert (problem.participant, problem.line, problem.column) == ("p05", 6, "condition")
    assert problem.found == "'telepathy'" and "mutual_adaptation" in problem.expected
    assert len(data.people) == 3 * EACH - 1
    assert data.flow.left_out == {"of no known condition": 1}


@pytest.mark.parametrize("value", [0, 6, -1, 2.5, "agree", ""])
def test_an_answer_out_of_range(tmp_path: Path, value: object) -> None:
    def change(tables: Tables) -> None:
        row(tables, "answers", participant="p01", item="trust_trustworthy")["value"] = value

    data = read_data(export(tmp_path / "x", change))
    problem = only(data)
    assert (problem.participant, problem.column, problem.line) == ("p01", "value", 3)
    assert problem.expected == "a point from 1 to 5"
    assert problem.done == "treated as a missing answer"
    assert "trust_trustworthy" not in data.people[0].ratings
    # Half of the items of the scale are still there.
    assert scale_scores(data)["p01"]["trust"] == data.people[0].ratings["trust_right_thing"]
    assert reliabilities(data)[0].dropped == 1


def test_a_missing_trial(tmp_path: Path) -> None:
    def change(tables: Tables) -> None:
        tables["trials"].remove(row(tables, "trials", participant="p04", trial=2))

    data = read_data(export(tmp_path / "x", change))
    problem = only(data)
    assert (problem.participant, problem.line, problem.column) == ("p04", None, "trial")
    assert problem.found == "no row of trial 2"
    found = analyse(data)
    (person,) = [p for p in found.people if p.participant == "p04"]
    assert person.performance is None and person.scores["trust"] is not None
    assert found.tested[0].missing == {"no_adaptation": 1}
    assert any("left out: 1 in no_adaptation" in text for text in found.deviations)
    assert found.tested[0].overall.sentence.count(f"N = {3 * EACH - 1}") == 1


def test_an_unfinished_trial_and_one_twice(tmp_path: Path) -> None:
    def change(tables: Tables) -> None:
        row(tables, "trials", participant="p01", trial=1)["finished"] = "false"
        tables["trials"].append(dict(row(tables, "trials", participant="p02", trial=3)))
        last = row(tables, "trials", participant="p03", trial=3)
        tables["trials"].append(last | {"trial": 4})

    data = read_data(export(tmp_path / "x", change))
    assert {(p.participant, p.column) for p in data.problems} == {
        ("p01", "finished"),
        ("p02", "trial"),
        ("p03", "trial"),
    }
    assert [len(person.trials) for person in data.people[:3]] == [2, 3, 3]


def test_rows_of_nobody_and_items_of_no_scale(tmp_path: Path) -> None:
    def change(tables: Tables) -> None:
        tables["answers"][0]["participant"] = "p99"
        tables["answers"][1]["item"] = "liking"

    data = read_data(export(tmp_path / "x", change))
    assert [(p.found, p.done) for p in data.problems[:2]] == [
        ("'p99'", "the row is not used"),
        ("'liking'", "the row is not used"),
    ]
    missing = [p.found for p in data.problems[2:]]
    assert missing == ["no answer to trust_right_thing", "no answer to trust_trustworthy"]


def test_attention_checks_exclude_nobody_but_are_listed(tmp_path: Path) -> None:
    def change(tables: Tables) -> None:
        row(tables, "participants", participant="p07")["checks_failed"] = 1

    data = read_data(export(tmp_path / "x", change))
    assert "kept" in only(data).done
    assert len(data.people) == 3 * EACH


def test_who_is_not_included_is_counted_by_the_reason(tmp_path: Path) -> None:
    def change(tables: Tables) -> None:
        for name, standing in (("p01", "declined"), ("p02", "withdrawn"), ("p03", "stale")):
            row(tables, "participants", participant=name).update(
                {"included": "false", "standing": standing}
            )

    data = read_data(export(tmp_path / "x", change))
    assert data.flow.left_out == {"declined": 1, "withdrawn": 1, "stale": 1}
    assert data.flow.allocated["no_adaptation"] == EACH
    assert data.flow.analysed["no_adaptation"] == EACH - 1


OWN = """participant,condition,optimal_1,optimal_2,optimal_3,switched,age
a1,no_adaptation,true,true,true,false,30
a2,no_adaptation,true,true,,false,31
a2,no_adaptation,true,true,,false,31
a3,deaf,true,true,true,false,32
a4,one_way_adaptation,false,maybe,false,perhaps,33
a5,one_way_adaptation,false,false,false,false,34
a5,one_way_adaptation,true,false,false,false,34
a6,mutual_adaptation,true,false,false,true,35
,mutual_adaptation,true,false,false,true,36
"""

PLAN = """
[[conditions]]
name = "no_adaptation"
[[conditions]]
name = "mutual_adaptation"
[[conditions]]
name = "one_way_adaptation"
"""


def test_a_table_of_ones_own(tmp_path: Path) -> None:
    (tmp_path / "own.csv").write_text(OWN)
    (tmp_path / "plan.toml").write_text(PLAN)
    data = read_data(tmp_path / "own.csv", tmp_path / "plan.toml")
    listed = [(p.line, p.participant, p.column, p.done.split()[0]) for p in data.problems]
    assert listed == [
        (10, "", "participant", "the"),
        (4, "a2", "participant", "the"),
        (3, "a2", "optimal_3", "the"),
        (5, "a3", "condition", "the"),
        (6, "a4", "optimal_2", "treated"),
        (6, "a4", "switched", "treated"),
        (8, "a5", "participant", "the"),
        (7, "a5", "participant", "the"),
    ]
    assert [p.name for p in data.people] == ["a1", "a2", "a4", "a6"]
    assert data.flow.opened == len(data.people) + sum(data.flow.left_out.values())
    assert any("age" in note for note in data.notes)


COUNTS = """condition,optimal_trials,participants
no_adaptation,3,5
mutual_adaptation,1,4
mutual_adaptation,1,2
one_way_adaptation,4,1
one_way_adaptation,0,few
one_way_adaptation,0,5
"""


def test_counts(tmp_path: Path) -> None:
    (tmp_path / "counts.csv").write_text(COUNTS)
    data = read_data(tmp_path / "counts.csv")
    assert [(p.line, p.column, p.done) for p in data.problems] == [
        (4, "", "the row is not used"),
        (5, "optimal_trials", "the row is not used"),
        (6, "participants", "the row is not used"),
    ]
    assert data.flow.analysed == dict(zip(data.conditions, (5, 4, 5), strict=True))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "expected a CSV file with a header"),
        ("a,b\n1,2\n", "expected a column 'participant'"),
        ("participant,participant\n", "has the column 'participant' twice"),
        ("participant,condition\n", "no row that can be used"),
        ("participant,condition\na,b,c\n", "found 3 cells, expected at most 2"),
        ("condition,optimal_trials,participants\nx,9,9\n", "no row that can be used"),
        ('participant,condition\n"a,b\n', "is no CSV file"),
    ],
)
def test_files_that_cannot_be_used(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "x.csv").write_text(text)
    with pytest.raises(FileError, match=says):
        read_data(tmp_path / "x.csv")


def test_folders_that_cannot_be_used(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="found no protocol"):
        read_data(tmp_path)
    folder = export(tmp_path / "x")
    (folder / "data" / "description-trials_data.csv").unlink()
    with pytest.raises(FileError, match="found no table of trials"):
        read_data(folder)


def test_an_export_has_the_columns_that_are_read() -> None:
    """The two know each other by file alone; this is where they meet."""
    written = {t.name: {c.name for c in t.columns} for t in TABLES}
    more = {"goal", "optimal", "steps", "changed", "inputs", "disagreements", "matched"}
    assert {"belief_alpha", "duration", *more, *TRIAL} <= written["trials"]
    assert {"simulated", "checks_failed", *PERSON} <= written["participants"]
    assert {"agreement", "matched", *STEP} <= written["steps"]
    assert set(ANSWER) <= written["answers"]
