"""What a command takes for PROBLEM: a file, or one of the tasks that are built in."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from coadapt.errors import InputError

if TYPE_CHECKING:
    from coadapt.momdp import MOMDP


def _table_clearing() -> MOMDP:
    from coadapt.formalism import SharedAutonomy
    from coadapt.worlds import table_clearing

    return SharedAutonomy(table_clearing()).to_momdp()


def _table_carrying() -> MOMDP:
    from coadapt.formalism import Collaboration
    from coadapt.worlds import table_carrying

    return Collaboration(table_carrying(), observed="closed").to_momdp()


def _hallway() -> MOMDP:
    from coadapt.formalism import Collaboration
    from coadapt.worlds import hallway

    return Collaboration(hallway(), observed="all").to_momdp()


TASKS: dict[str, Callable[[], MOMDP]] = {
    "table_clearing": _table_clearing,
    "table_carrying": _table_carrying,
    "hallway": _hallway,
}
"""The tasks by their names."""


def load_problem(problem: str) -> MOMDP:
    """The task or the file that ``problem`` names.

    A name with a suffix or a directory is a file.

    Raises:
        InputError: if there is no such task, or the file cannot be used.
    """
    if problem in TASKS:
        return TASKS[problem]()
    path = Path(problem)
    if not path.suffix and problem == path.name:
        known = ", ".join(sorted(TASKS))
        raise InputError(f"{problem}: found no such task, expected a file or one of: {known}")
    from coadapt.momdp.files import read_pomdp

    return read_pomdp(path)
