"""The courses of trials: what the robot believed and did, step by step."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from coadapt.analysis.data.rows import Row, Table, as_count, as_flag, as_number
from coadapt.analysis.data.study_data import Step


class Courses:
    """Finds the courses of trials in a table of steps.

    Args:
        steps: the table; None for none.
        goals: names, in the order of the beliefs' columns.
    """

    def __init__(self, steps: Table | None, goals: Sequence[str]) -> None:
        self._goals = tuple(goals)
        self._rows: dict[tuple[str, int], list[Row]] = {}
        for row in () if steps is None else steps.rows:
            number = as_count(row.get("number"))
            if row.get("stage") == "trial" and as_flag(row.get("counts")) and number is not None:
                self._rows.setdefault((row.get("participant") or "", number), []).append(row)

    def of(self, participant: str, trial: int, optimal: str | None) -> tuple[Step, ...]:
        """The steps of a trial, in their order; none if they were not recorded whole.

        Args:
            participant: pseudonym.
            trial: number, from 1.
            optimal: name of the goal that the robot holds to be better.
        """
        if optimal not in self._goals:
            return ()
        column = self._goals.index(optimal)
        rows = self._rows.get((participant, trial), [])
        rows.sort(key=lambda row: as_count(row.get("step")) or 0)
        found = [_step(row, column) for row in rows]
        return tuple(step for step in found if step is not None) if all(found) else ()


def numbers(text: str | None) -> tuple[float, ...] | None:
    """The list of numbers in a cell; None if it holds none."""
    try:
        return msgspec.json.decode(text or "", type=tuple[float, ...])
    except msgspec.MsgspecError:
        return None


def _step(row: Row, column: int) -> Step | None:
    try:
        belief = msgspec.json.decode(row.get("belief") or "", type=tuple[tuple[float, ...], ...])
    except msgspec.MsgspecError:
        return None
    if not belief or any(len(values) <= column for values in belief):
        return None
    agreement = as_number(row.get("agreement"))
    return Step(
        belief=tuple(sum(values) for values in belief),
        towards=sum(values[column] for values in belief),
        input=row.get("input"),
        action=row.get("action"),
        matched=bool(as_flag(row.get("matched"))),
        disagreement=None if agreement is None else 1 - agreement,
    )
