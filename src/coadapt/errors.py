"""The error for what a user gave us: a file, an option, a value."""

from __future__ import annotations

LONGEST_EXCERPT = 60
"""Characters of a file's contents that a message repeats."""


class InputError(ValueError):
    """Something the user gave cannot be used.

    The message is one line that names what was found and what was expected. The command line
    prints it without a traceback and exits with code 2.
    """

    def __init__(self, message: str) -> None:
        super().__init__(printable(message))


class FileError(InputError):
    """A file cannot be used; the message begins with its path, and the line where there is one.

    Attributes:
        path: the file.
        line: number of the line from 1, or None if the file as a whole is meant.
    """

    def __init__(self, path: object, line: int | None, message: str) -> None:
        place = f"{path}" if line is None else f"{path}:{line}"
        super().__init__(f"{place}: {message}")
        self.path = str(path)
        self.line = line


def excerpt(text: str) -> str:
    """``text`` in quotes, shortened, with control characters escaped."""
    shown = text if len(text) <= LONGEST_EXCERPT else text[: LONGEST_EXCERPT - 3] + "..."
    return repr(shown)


def printable(text: str) -> str:
    """``text`` on one line, without characters that would steer a terminal."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
