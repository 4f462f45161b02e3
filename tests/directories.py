"""Directories that several tests share for as long as they run."""

from __future__ import annotations

import shutil
from pathlib import Path
from tempfile import mkdtemp

_made: list[Path] = []


def shared_directory(prefix: str) -> Path:
    """A new directory, there until the last test has run."""
    _made.append(Path(mkdtemp(prefix=prefix)))
    return _made[-1]


def remove_shared_directories() -> None:
    """Remove them all."""
    while _made:
        shutil.rmtree(_made.pop(), ignore_errors=True)
