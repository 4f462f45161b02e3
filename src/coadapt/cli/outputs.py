"""Files that a command is going to write: whether it can is found out before the work begins."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryFile

from coadapt.errors import FileError


def require_writable(path: Path, *inputs: Path) -> None:
    """See whether the file ``path`` can be made or replaced.

    Args:
        path: the file to write.
        inputs: files that must not be replaced by it.

    Raises:
        FileError: if it cannot be written, or is one of ``inputs``.
    """
    try:
        if path.exists() and not path.is_file():
            raise FileError(path, None, "found something else than a file, expected a file")
        if any(_same(path, other) for other in inputs):
            raise FileError(path, None, "found a file that is in use, expected another to write to")
        with TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise FileError(path, None, f"cannot be written: {error.strerror}") from error


def _same(path: Path, other: Path) -> bool:
    if path.exists() and other.exists():
        return path.samefile(other)
    return path.absolute() == other.absolute()
