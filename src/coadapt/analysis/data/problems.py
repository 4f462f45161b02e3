"""What is wrong in the data, row by row, and what was done about it."""

from __future__ import annotations

import msgspec


class Problem(msgspec.Struct, frozen=True, kw_only=True):
    """A value or a row that cannot be used as it is.

    Attributes:
        file: name of the file.
        line: of the file, from 1; None of a row that is missing.
        participant: whom it concerns, "" if nobody.
        column: where it stands, "" for the whole row.
        found: what is there.
        expected: what should be.
        done: what was done about it.
    """

    file: str
    line: int | None
    participant: str
    column: str
    found: str
    expected: str
    done: str

    @property
    def place(self) -> str:
        """File and line."""
        return self.file if self.line is None else f"{self.file}:{self.line}"


LEFT_OUT = "the participant is left out of every analysis"

AS_MISSING = "treated as a missing answer"

NOT_USED = "the row is not used"
