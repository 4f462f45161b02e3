"""A whole sweep: what is not finished is found out, and the table written."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from coadapt.simulation.sweep.cell import Cell
from coadapt.simulation.sweep.execute import execute
from coadapt.simulation.sweep.measure import Row
from coadapt.simulation.sweep.store import Store
from coadapt.simulation.sweep.table import Table, table_of
from coadapt.simulation.sweep.table_files import write_table
from coadapt.simulation.sweep.work import Failure
from coadapt.simulation.sweep.workers import Workers

Progress = Callable[[int, int], None]
"""Called with the number of cells that are done with, and of those that failed."""


@dataclass(frozen=True)
class Outcome:
    """What a run of a sweep came to.

    Attributes:
        cells: number of cells.
        kept: number of those that were finished before.
        failed: why cells failed, by their keys, in the grid's order.
        table: the table that was written.
    """

    cells: int
    kept: int
    failed: dict[str, str]
    table: Table


def run_sweep(
    cells: Sequence[Cell],
    directory: Path,
    workers: Callable[[], Workers],
    progress: Progress | None = None,
) -> Outcome:
    """Finish a sweep: run the cells that are not in ``directory`` yet, then write the table.

    The table depends on the cells alone: not on how often the sweep was interrupted, on where the
    cells ran or in what order.

    Args:
        cells: see `coadapt.simulation.sweep.lay_out`.
        directory: of the results; made if it is not there.
        workers: makes the workers, if there is something to do.
        progress: told how far it is.

    Raises:
        FileError: if a file cannot be read or written.
        InputError: if the workers are lost.
    """
    store = Store(directory)
    finished = store.finished()
    left = [cell for cell in cells if cell.key not in finished]
    failed: dict[str, str] = {}
    done = len(cells) - len(left)
    if progress is not None:
        progress(done, 0)

    def tell(cell: Cell, failure: Failure | None) -> None:
        nonlocal done
        done += 1
        if failure is not None:
            failed[cell.key] = failure.message
        if progress is not None:
            progress(done, len(failed))

    if left:
        _execute(left, store, workers, tell)
    rows: list[Sequence[Row] | str] = [
        failed[cell.key] if cell.key in failed else store.rows(cell) for cell in cells
    ]
    table = table_of(cells, rows)
    write_table(table, directory)
    in_order = {cell.key: failed[cell.key] for cell in cells if cell.key in failed}
    return Outcome(len(cells), len(cells) - len(left), in_order, table)


def _execute(
    left: list[Cell],
    store: Store,
    workers: Callable[[], Workers],
    tell: Callable[[Cell, Failure | None], None],
) -> None:
    hands = workers()
    try:
        execute(left, store, hands, tell)
    except BaseException:
        hands.close(now=True)
        raise
    hands.close()
