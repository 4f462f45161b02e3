"""Reading a sweep from TOML."""

from __future__ import annotations

import os
from pathlib import Path

from coadapt.simulation.sweep.cells import Layout, lay_out
from coadapt.simulation.sweep.grid import Sweep
from coadapt.toml import Places, parse_toml, read_toml

WHAT = "a sweep"


def read_sweep(path: str | os.PathLike[str]) -> Layout:
    """The sweep in a TOML file with its cells. Files of tasks are looked for beside it.

    Raises:
        FileError: if it cannot be read or used; names the line where there is one.
        InputError: if there are too many cells.
    """
    return _laid_out(*read_toml(path, Sweep, WHAT), path)


def parse_sweep(raw: bytes, path: str | os.PathLike[str]) -> Layout:
    """The sweep in the TOML text ``raw`` with its cells.

    Args:
        raw: the text.
        path: for messages, and the place beside which files of tasks are.

    Raises:
        FileError, InputError: as `read_sweep`.
    """
    return _laid_out(*parse_toml(raw, path, Sweep, WHAT), path)


def _laid_out(sweep: Sweep, places: Places, path: str | os.PathLike[str]) -> Layout:
    with places.named():
        return lay_out(sweep, Path(path).parent)
