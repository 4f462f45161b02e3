"""Performance as counts: how many participants of a condition reached the optimal goal how often.

    condition,optimal_trials,participants
    mutual_adaptation,0,4
    mutual_adaptation,1,7

This is how published results can be written down from which single participants cannot be told.
"""

from __future__ import annotations

from collections import Counter

from coadapt.analysis.data.declaration import Declaration, Rewards
from coadapt.analysis.data.problems import NOT_USED, Problem
from coadapt.analysis.data.rows import Row, Table, as_count
from coadapt.analysis.data.study_data import Flow, Person, StudyData, Trial
from coadapt.errors import FileError, excerpt

COLUMNS = ("condition", "optimal_trials", "participants")

RECONSTRUCTED = {"no_adaptation": 19, "mutual_adaptation": 16, "one_way_adaptation": 17}
"""The sizes of the groups in the counts that were reconstructed from the paper's statistics."""

NOTE = (
    "These group sizes (19, 16, 17; 52 in all) are those of the counts reconstructed from the "
    "paper’s statistics of performance. They differ from the questionnaire’s: its F(2, 48) says 51 "
    "participants. No counts with 18 in No-adaptation give the published χ² and U; either one "
    "participant answered no questionnaire or one of the published numbers is misprinted. The "
    "counts are what fits the published statistics, not records of the participants."
)


def from_counts(table: Table, declared: Declaration, sha256: str) -> StudyData:
    """The data in a table of counts; each participant becomes one with that many optimal trials.

    Raises:
        FileError: if a column is missing, or no row can be used.
    """
    table.require(COLUMNS)
    trials, rewards = declared.trials, declared.rewards
    people: list[Person] = []
    problems: list[Problem] = []
    seen: dict[tuple[str, int], int] = {}
    for row in table.rows:
        problem = _problem(table, row, declared, seen)
        if problem is not None:
            problems.append(problem)
            continue
        condition = row.cells["condition"]
        optimal, count = as_count(row.get("optimal_trials")), as_count(row.get("participants"))
        assert optimal is not None and count is not None
        seen[condition, optimal] = row.line
        begin = sum(person.condition == condition for person in people)
        people += [
            Person(
                name=f"{condition} {begin + i + 1}",
                condition=condition,
                trials=_trials(optimal, trials, rewards),
            )
            for i in range(count)
        ]
    if not people:
        raise FileError(table.path, None, "found no row that can be used")
    names = [c.name for c in declared.conditions]
    sizes = Counter(person.condition for person in people)
    conditions = tuple(
        [n for n in names if n in sizes] or dict.fromkeys(p.condition for p in people)
    )
    notes = ["The data are counts: which trial of a participant was which is not known."]
    if sizes == RECONSTRUCTED:
        notes.append(NOTE)
    analysed = {name: sizes[name] for name in conditions}
    return StudyData(
        form="counts",
        source=table.name,
        sha256=sha256,
        declared=declared,
        conditions=conditions,
        people=tuple(people),
        flow=Flow(
            opened=len(people),
            standing={"counted": len(people)},
            left_out={},
            allocated=analysed,
            analysed=analysed,
        ),
        problems=tuple(problems),
        notes=tuple(notes),
    )


def _trials(optimal: int, trials: int, rewards: Rewards) -> tuple[Trial, ...]:
    reached = [i < optimal for i in range(trials)]
    return tuple(
        Trial(number=i + 1, optimal=o, reward=rewards.optimal if o else rewards.other)
        for i, o in enumerate(reached)
    )


def _problem(
    table: Table, row: Row, declared: Declaration, seen: dict[tuple[str, int], int]
) -> Problem | None:
    known = [c.name for c in declared.conditions]
    condition, optimal = row.get("condition"), as_count(row.get("optimal_trials"))
    count = as_count(row.get("participants"))
    column, expected = "", ""
    if condition is None or (known and condition not in known):
        column, expected = "condition", f"one of {', '.join(known)}" if known else "a name"
    elif optimal is None or not 0 <= optimal <= declared.trials:
        column, expected = "optimal_trials", f"a whole number from 0 to {declared.trials}"
    elif count is None or count < 0:
        column, expected = "participants", "a whole number of at least 0"
    elif (condition, optimal) in seen:
        line = seen[condition, optimal]
        expected = f"one row for each condition and count; line {line} has the same"
    else:
        return None
    found = excerpt(row.get(column) or "nothing") if column else "a second row"
    return Problem(
        file=table.name,
        line=row.line,
        participant="",
        column=column,
        found=found,
        expected=expected,
        done=NOT_USED,
    )
