"""Files that appear complete or not at all."""

from __future__ import annotations

import os
import secrets
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from coadapt.errors import FileError


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Generator[BinaryIO]:
    """A file to write to, which takes the place of ``path`` when the block ends without an error.

    Raises:
        FileError: if the file cannot be written.
    """
    place = Path(path)
    unfinished = place.with_name(f".{place.name[:100]}.{secrets.token_hex(4)}.tmp")
    try:
        with unfinished.open("xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        unfinished.replace(place)
    except OSError as error:
        raise FileError(path, None, f"cannot be written: {error.strerror}") from error
    finally:
        unfinished.unlink(missing_ok=True)
