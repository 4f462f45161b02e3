"""A table of one's own: a row for each participant.

    participant,condition,optimal_1,optimal_2,optimal_3,trust_1,trust_2,...
    p01,mutual_adaptation,true,true,false,4,5,...

Columns beside ``participant`` and ``condition``, any of which may be absent:

* ``reward_1`` ... or ``optimal_1`` ...: of each trial, its reward, or whether the optimal goal was
  reached; or ``performance``: their mean;
* ``switched``: whether the participant went for another goal than the one chosen at first;
* the items of the scales that the declaration names, as the points that were chosen, from 1.
"""

from __future__ import annotations

from coadapt.analysis.data.declaration import Declaration
from coadapt.analysis.data.problems import AS_MISSING, LEFT_OUT, Problem
from coadapt.analysis.data.rows import Row, Table, as_count, as_flag, as_number
from coadapt.analysis.data.study_data import Flow, Person, StudyData, Trial
from coadapt.errors import FileError, excerpt


def from_table(table: Table, declared: Declaration, sha256: str) -> StudyData:
    """The data in a table with a row for each participant.

    Raises:
        FileError: if a column is missing, or no row can be used.
    """
    table.require(("participant", "condition"))
    reader = _Reader(table, declared)
    people = reader.people()
    if not people:
        raise FileError(table.path, None, "found no row that can be used")
    conditions = reader.conditions or tuple(dict.fromkeys(p.condition for p in people))
    analysed = {name: sum(p.condition == name for p in people) for name in conditions}
    return StudyData(
        form="table",
        source=table.name,
        sha256=sha256,
        declared=declared,
        conditions=conditions,
        people=tuple(people),
        flow=Flow(
            opened=len(table.rows),
            standing={"rows": len(table.rows)},
            left_out=reader.left_out,
            allocated={
                name: sum(row.get("condition") == name for row in table.rows) for name in conditions
            },
            analysed=analysed,
        ),
        problems=tuple(reader.problems),
        notes=tuple(reader.notes()),
    )


class _Reader:
    """Reads the rows and keeps what is wrong with them."""

    def __init__(self, table: Table, declared: Declaration) -> None:
        self._table, self._declared = table, declared
        self.conditions = tuple(c.name for c in declared.conditions)
        self.problems: list[Problem] = []
        self.left_out: dict[str, int] = {}
        self._items = {i.name: len(s.points) for s in declared.scales for i in s.items}
        numbers = range(1, declared.trials + 1)
        self._trials = [n for n in numbers if {f"reward_{n}", f"optimal_{n}"} & set(table.columns)]

    def people(self) -> list[Person]:
        """Those who can be analysed."""
        first: dict[str, Row] = {}
        twice: dict[str, list[Row]] = {}
        for row in self._table.rows:
            name = row.get("participant")
            if name is None:
                self._problem(row, "participant", "a pseudonym", "the row is not used")
                self._leave_out("without a pseudonym")
            elif name in first:
                twice.setdefault(name, []).append(row)
            else:
                first[name] = row
        found: list[Person] = []
        for name, row in first.items():
            others = twice.get(name, [])
            alike = all(other.cells == row.cells for other in others)
            reason = "the same row again" if alike else "rows that contradict each other"
            for other in others:
                expected = f"one row a participant; line {row.line} has the same pseudonym"
                done = "the same again: used once" if alike else LEFT_OUT
                self._problem(other, "participant", expected, done)
                self._leave_out(reason)
            if not alike:
                self._problem(row, "participant", "one row a participant", LEFT_OUT)
                self._leave_out(reason)
            else:
                person = self._person(name, row)
                found += [] if person is None else [person]
        return found

    def _person(self, name: str, row: Row) -> Person | None:
        condition = row.get("condition")
        if condition is None or (self.conditions and condition not in self.conditions):
            expected = f"one of {', '.join(self.conditions)}" if self.conditions else "a name"
            self._problem(row, "condition", expected, LEFT_OUT)
            self._leave_out("of no known condition")
            return None
        return Person(
            name=name,
            condition=condition,
            trials=self._trials_of(row),
            ratings=self._ratings(row),
            performance=self._number(row, "performance"),
            switched=self._flag(row, "switched"),
        )

    def _trials_of(self, row: Row) -> tuple[Trial, ...]:
        found: list[Trial] = []
        for n in self._trials:
            reward, optimal = self._number(row, f"reward_{n}"), self._flag(row, f"optimal_{n}")
            rewards = self._declared.rewards
            if reward is None and optimal is not None:
                reward = rewards.optimal if optimal else rewards.other
            if optimal is None and reward is not None:
                optimal = reward == rewards.optimal
            if reward is None:
                column = f"reward_{n}" if f"reward_{n}" in self._table.columns else f"optimal_{n}"
                if column not in row.cells:
                    done = "the participant is left out of what needs every trial"
                    self._problem(row, column, "the result of the trial", done)
                continue
            found.append(Trial(number=n, reward=reward, optimal=optimal))
        return tuple(found)

    def _ratings(self, row: Row) -> dict[str, int]:
        found: dict[str, int] = {}
        for item, points in self._items.items():
            if item not in self._table.columns:
                continue
            value = as_count(row.get(item))
            if value is not None and 1 <= value <= points:
                found[item] = value
            else:
                self._problem(row, item, f"a point from 1 to {points}", AS_MISSING)
        return found

    def _number(self, row: Row, column: str) -> float | None:
        value = as_number(row.get(column))
        if value is None and column in row.cells:
            self._problem(row, column, "a number", "treated as missing")
        return value

    def _flag(self, row: Row, column: str) -> bool | None:
        value = as_flag(row.get(column))
        if value is None and column in row.cells:
            self._problem(row, column, "true or false", "treated as missing")
        return value

    def notes(self) -> list[str]:
        """Of columns that say nothing to the analysis, and items that are absent."""
        known = {"participant", "condition", "performance", "switched", *self._items}
        known |= {f"{kind}_{n}" for kind in ("reward", "optimal") for n in self._trials}
        unused = [c for c in self._table.columns if c and c not in known]
        absent = [item for item in self._items if item not in self._table.columns]
        found = [f"Columns not used: {', '.join(unused)}."] if unused else []
        return found + ([f"Items without a column: {', '.join(absent)}."] if absent else [])

    def _leave_out(self, reason: str) -> None:
        self.left_out[reason] = self.left_out.get(reason, 0) + 1

    def _problem(self, row: Row, column: str, expected: str, done: str) -> None:
        self.problems.append(
            Problem(
                file=self._table.name,
                line=row.line,
                participant=row.get("participant") or "",
                column=column,
                found=excerpt(row.get(column) or "nothing"),
                expected=expected,
                done=done,
            )
        )
