"""The folder that `coadapt study export` writes: tables of participants, trials, steps and
answers."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TypeVar

import msgspec

from coadapt.analysis.data.courses import Courses, numbers
from coadapt.analysis.data.declaration import Declaration
from coadapt.analysis.data.problems import AS_MISSING, LEFT_OUT, NOT_USED, Problem
from coadapt.analysis.data.rows import Row, Table, as_count, as_flag, as_number, read_table
from coadapt.analysis.data.study_data import Flow, Person, StudyData, Trial
from coadapt.errors import FileError, excerpt

MANIFEST, PROTOCOL = "export.json", "materials/study.toml"

PERSON = ("participant", "included", "standing", "condition")
TRIAL = ("participant", "trial", "finished", "at_optimal", "reward")
ANSWER = ("participant", "item", "kind", "value")
STEP = ("participant", "stage", "number", "counts", "step", "belief", "input", "action")
"""Columns that each table must have; others are used where they are there."""


class Change(msgspec.Struct, frozen=True, kw_only=True):
    """A change of the protocol: when, and of which values."""

    at: str
    values: tuple[str, ...]


class Manifest(msgspec.Struct, frozen=True, kw_only=True):
    """What of ``export.json`` is needed here."""

    protocol_sha256: str = ""
    protocol_changes: tuple[Change, ...] = ()
    protocol_edited: tuple[str, ...] = ()

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader must know of the protocol."""
        notes = [
            f"The protocol was changed while participants came, on {change.at}: "
            f"{', '.join(change.values)}."
            for change in self.protocol_changes
        ]
        if self.protocol_edited:
            notes.append(
                "Values of the protocol differ from what participants were last served: "
                f"{', '.join(self.protocol_edited)}."
            )
        return tuple(notes)


class Model(msgspec.Struct, frozen=True, kw_only=True):
    """What of ``materials/model.json`` is needed here."""

    goals: tuple[str, ...] = ()
    adaptability: tuple[float, ...] = ()
    disagreement_cost: float | None = None


Kind = TypeVar("Kind")


def table_path(folder: Path, name: str) -> Path:
    """The CSV file of the table ``name``; FileError if there is none."""
    found = sorted((folder / "data").glob(f"*{name}_data.csv"))
    if not found:
        expected = (
            f"expected data/description-{name}_data.csv in it, as `coadapt study export` writes"
        )
        raise FileError(folder, None, f"found no table of {name}; {expected}")
    return found[0]


def from_export(
    folder: Path, declared: Declaration, sha256: str, *, with_steps: bool = True
) -> StudyData:
    """The data in an export.

    Args:
        folder: the export.
        declared: what the study declares.
        sha256: of the tables.
        with_steps: whether also the steps are read, which are many.

    Raises:
        FileError: if a table is missing or cannot be read.
    """
    manifest = _json(folder / MANIFEST, Manifest)
    model = _json(folder / "materials" / "model.json", Model)
    reader = _Reader(folder, declared, model, with_steps=with_steps)
    people = reader.people()
    conditions = reader.conditions or tuple(dict.fromkeys(p.condition for p in people))
    if not people:
        raise FileError(folder, None, "found no completed session that can be analysed")
    return StudyData(
        form="export",
        source=folder.name,
        sha256=sha256,
        declared=declared,
        stored_sha256=manifest.protocol_sha256,
        conditions=conditions,
        people=tuple(people),
        flow=reader.flow(people, conditions),
        problems=tuple(reader.problems),
        notes=manifest.notes,
        adaptability=model.adaptability,
        disagreement_cost=model.disagreement_cost,
    )


class _Reader:
    """Reads the tables and keeps what is wrong with them."""

    def __init__(
        self, folder: Path, declared: Declaration, model: Model, *, with_steps: bool
    ) -> None:
        self._declared, self._model = declared, model
        self.conditions = tuple(c.name for c in declared.conditions)
        self.problems: list[Problem] = []
        self.left_out: Counter[str] = Counter()
        self._people = self._table(folder, "participants", PERSON)
        self._trials = self._by_person(self._table(folder, "trials", TRIAL))
        self._answers = self._by_person(self._table(folder, "answers", ANSWER))
        self._items = {i.name: len(s.points) for s in declared.scales for i in s.rated}
        steps = self._table(folder, "steps", STEP) if with_steps else None
        self._courses = Courses(steps, model.goals)
        self._files = {
            name: table_path(folder, name).name for name in ("participants", "trials", "answers")
        }

    def _table(self, folder: Path, name: str, columns: tuple[str, ...]) -> Table:
        table = read_table(table_path(folder, name))
        table.require(columns)
        return table

    def _by_person(self, table: Table) -> dict[str, list[Row]]:
        known = {row.get("participant") for row in self._people.rows}
        found: dict[str, list[Row]] = {}
        for row in table.rows:
            name = row.get("participant")
            if name is None or name not in known:
                self._problem(table.name, row, "participant", "one of participants", NOT_USED)
            else:
                found.setdefault(name, []).append(row)
        return found

    def people(self) -> list[Person]:
        """Those who can be analysed."""
        file, rows = self._files["participants"], self._people.rows
        count = Counter(row.get("participant") for row in rows)
        lines = {row.get("participant"): row.line for row in reversed(rows)}
        found: list[Person] = []
        for row in rows:
            name = row.get("participant")
            if name is None:
                self._problem(file, row, "participant", "a pseudonym", NOT_USED)
                self.left_out["without a pseudonym"] += 1
            elif count[name] > 1:
                expected = f"one row a participant; line {lines[name]} has the same pseudonym"
                if lines[name] == row.line:
                    expected = f"one row a participant, found {count[name]}"
                self._problem(file, row, "participant", expected, LEFT_OUT)
                self.left_out["several rows of one pseudonym"] += 1
            elif not as_flag(row.get("included")):
                standing = row.get("standing") or "of unknown standing"
                if standing == "completed":
                    standing = "simulated, among people"
                self.left_out[standing] += 1
            else:
                person = self._person(name, row)
                found += [] if person is None else [person]
        return found

    def _person(self, name: str, row: Row) -> Person | None:
        condition, file = row.get("condition"), self._files["participants"]
        if condition is None or (self.conditions and condition not in self.conditions):
            expected = f"one of {', '.join(self.conditions)}" if self.conditions else "a name"
            self._problem(file, row, "condition", expected, LEFT_OUT)
            self.left_out["of no known condition"] += 1
            return None
        failed = as_count(row.get("checks_failed")) or 0
        if failed:
            done = "kept; attention checks exclude nobody by themselves"
            self._problem(file, row, "checks_failed", "0", done)
        return Person(
            name=name,
            condition=condition,
            trials=self._trials_of(name),
            ratings=self._ratings(name),
            checks_failed=failed,
        )

    def _trials_of(self, name: str) -> tuple[Trial, ...]:
        file, wanted = self._files["trials"], self._declared.trials
        found: dict[int, Trial] = {}
        bad = "the participant is left out of what needs every trial"
        for row in self._trials.get(name, ()):
            number, reward = as_count(row.get("trial")), as_number(row.get("reward"))
            if number is None or not 1 <= number <= wanted:
                self._problem(file, row, "trial", f"a number from 1 to {wanted}", NOT_USED)
            elif number in found:
                self._problem(file, row, "trial", "one row a trial", NOT_USED)
            elif not as_flag(row.get("finished")):
                self._problem(file, row, "finished", "true: the trial came to its end", bad)
            elif reward is None:
                self._problem(file, row, "reward", "a number", bad)
            else:
                found[number] = self._trial(name, number, reward, row)
        for number in range(1, wanted + 1):
            if number not in found and not self._has_row(name, number):
                self.problems.append(
                    Problem(
                        file=file,
                        line=None,
                        participant=name,
                        column="trial",
                        found=f"no row of trial {number}",
                        expected=f"{wanted} trials",
                        done=bad,
                    )
                )
        return tuple(found[number] for number in sorted(found))

    def _has_row(self, name: str, number: int) -> bool:
        rows = self._trials.get(name, ())
        return any(as_count(row.get("trial")) == number for row in rows)

    def _trial(self, name: str, number: int, reward: float, row: Row) -> Trial:
        belief = numbers(row.get("belief_alpha"))
        return Trial(
            number=number,
            goal=row.get("goal"),
            optimal=bool(as_flag(row.get("at_optimal"))),
            reward=reward,
            switched=as_flag(row.get("changed")),
            steps=as_count(row.get("steps")),
            inputs=as_count(row.get("inputs")),
            disagreements=as_count(row.get("disagreements")),
            matched=as_count(row.get("matched")),
            seconds=as_number(row.get("duration")),
            belief=belief,
            course=self._courses.of(name, number, row.get("optimal")),
        )

    def _ratings(self, name: str) -> dict[str, int]:
        file = self._files["answers"]
        found: dict[str, int] = {}
        for row in self._answers.get(name, ()):
            item = row.get("item") or ""
            if row.get("kind") != "rating":
                continue
            if item not in self._items:
                self._problem(file, row, "item", "an item of the protocol", NOT_USED)
                continue
            value, points = as_count(row.get("value")), self._items[item]
            if value is None or not 1 <= value <= points:
                self._problem(file, row, "value", f"a point from 1 to {points}", AS_MISSING)
            elif item in found:
                self._problem(file, row, "item", "one answer to each item", NOT_USED)
            else:
                found[item] = value
        for item in self._items:
            if item not in found and not self._answered(name, item):
                self.problems.append(
                    Problem(
                        file=file,
                        line=None,
                        participant=name,
                        column="item",
                        found=f"no answer to {item}",
                        expected="an answer to every item",
                        done=AS_MISSING,
                    )
                )
        return found

    def _answered(self, name: str, item: str) -> bool:
        return any(row.get("item") == item for row in self._answers.get(name, ()))

    def flow(self, people: list[Person], conditions: tuple[str, ...]) -> Flow:
        """What became of those who came."""
        rows = self._people.rows
        names = {person.name for person in people}
        return Flow(
            opened=len(rows),
            standing=dict(Counter(row.get("standing") or "unknown" for row in rows)),
            left_out=dict(self.left_out),
            allocated={c: sum(r.get("condition") == c for r in rows) for c in conditions},
            analysed={c: sum(p.condition == c for p in people) for c in conditions},
            simulated=sum(
                bool(as_flag(r.get("simulated"))) and r.get("participant") in names for r in rows
            ),
        )

    def _problem(self, file: str, row: Row, column: str, expected: str, done: str) -> None:
        self.problems.append(
            Problem(
                file=file,
                line=row.line,
                participant=row.get("participant") or "",
                column=column,
                found=excerpt(row.get(column) or "nothing"),
                expected=expected,
                done=done,
            )
        )


def _json(path: Path, kind: type[Kind]) -> Kind:
    try:
        return msgspec.json.decode(path.read_bytes(), type=kind)
    except FileNotFoundError:
        return kind()
    except (OSError, msgspec.MsgspecError) as error:
        raise FileError(path, None, f"cannot be used: {error}") from error
