"""The door to problem files: which reader a file needs, and what can go wrong opening it."""

from __future__ import annotations

import os
from pathlib import Path

from coadapt.errors import FileError
from coadapt.momdp.files.cassandra_reader import read_cassandra
from coadapt.momdp.files.limits import MAX_FILE_BYTES
from coadapt.momdp.files.pomdpx_reader import read_pomdpx
from coadapt.momdp.model import MOMDP


def read_pomdp(path: str | os.PathLike[str]) -> MOMDP:
    """The problem in a file, in the format that its suffix names.

    Args:
        path: a file that ends in ``.pomdp`` (Cassandra's format) or ``.pomdpx``, in any case.

    Raises:
        coadapt.errors.InputError: if the file cannot be read, is not in its format, or is too
            large. The message begins with the file and the line, and says what was found and what
            was expected.
    """
    place = Path(path)
    suffix = place.suffix.lower()
    if suffix not in (".pomdp", ".pomdpx"):
        raise FileError(
            place, None, f"found a name that ends in {suffix!r}, expected .pomdp or .pomdpx"
        )
    check_openable(place)
    try:
        if suffix == ".pomdpx":
            with place.open("rb") as file:
                return read_pomdpx(place, file)
        # Old files have comments in any encoding; their words are ASCII.
        with place.open(encoding="utf-8-sig", errors="replace") as lines:
            return read_cassandra(place, lines)
    except OSError as error:
        raise FileError(place, None, f"cannot be read: {error.strerror}") from error


def check_openable(path: Path) -> None:
    """Refuse what is not a file of a size that is read.

    Raises:
        FileError: if it is missing, no ordinary file, or larger than `MAX_FILE_BYTES`.
    """
    try:
        size = path.stat().st_size
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "not a file name"
        raise FileError(path, None, f"cannot be read: {reason}") from error
    if not path.is_file():
        raise FileError(path, None, "found something else than a file, expected a file")
    if size > MAX_FILE_BYTES:
        raise FileError(path, None, f"found {size:,} bytes, expected at most {MAX_FILE_BYTES:,}")
