"""Reading values from TOML. Whatever is wrong has one message with the line it is in."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import msgspec

from coadapt.errors import FileError
from coadapt.requirements import FieldError, Key, dotted

Kind = TypeVar("Kind")

LARGEST_FILE = 1_000_000
"""Bytes."""

_HEADER = re.compile(r"\s*(\[\[?)\s*([\w.\"' -]+?)\s*\]\]?\s*(#.*)?$")
_KEY = re.compile(r"\s*([\w\"'-][\w.\"' -]*?)\s*=")
_PLACE = re.compile(r"(?P<problem>.*?)(?: - at `(?:key in )?\$(?P<place>.*)`)?", re.DOTALL)
_PART = re.compile(r"\.(\w+)|\[(\d+)\]")
_UNKNOWN = re.compile(r"unknown field `(.*)`")
_AT = re.compile(r"(?P<problem>.*) \(at line (?P<line>\d+), column \d+\)")


def read_toml(path: str | os.PathLike[str], kind: type[Kind], what: str) -> tuple[Kind, Places]:
    """The value of type ``kind`` in a TOML file, and where its parts stand.

    Args:
        path: the file.
        kind: a msgspec type.
        what: what the file should hold, for messages: "a task".

    Raises:
        FileError: if it cannot be read or used; names the line where there is one.
    """
    try:
        with Path(path).open("rb") as stream:
            raw = stream.read(LARGEST_FILE + 1)
    except OSError as error:
        raise FileError(
            path, None, f"found no readable file ({error.strerror}), expected {what}"
        ) from error
    if len(raw) > LARGEST_FILE:
        raise FileError(path, None, f"found more than {LARGEST_FILE:,} bytes, expected {what}")
    return parse_toml(raw, path, kind, what)


def parse_toml(
    raw: bytes, path: str | os.PathLike[str], kind: type[Kind], what: str
) -> tuple[Kind, Places]:
    """The value in the TOML text ``raw``, else as `read_toml`; ``path`` is for messages.

    Raises:
        FileError: as `read_toml`.
    """
    try:
        text = raw.decode().replace("\r\n", "\n")
        values = tomllib.loads(text)
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        found = f"found byte 0x{raw[error.start]:02x}, expected UTF-8 text"
        raise FileError(path, line, found) from error
    except (tomllib.TOMLDecodeError, ValueError, RecursionError) as error:
        found = _AT.fullmatch(str(error))
        problem = str(error) if found is None else found["problem"]
        line = None if found is None else int(found["line"])
        raise FileError(path, line, f"found no TOML ({problem}), expected {what}") from error
    places = Places(path, text)
    try:
        return msgspec.convert(values, kind), places
    except (msgspec.ValidationError, RecursionError) as error:
        key, problem = _explained(error)
        raise FileError(path, places.line(key), problem) from error


class Places:
    """Where the parts of a TOML file stand.

    Args:
        path: the file, for messages.
        text: its contents.
    """

    def __init__(self, path: str | os.PathLike[str], text: str) -> None:
        self._path = path
        self._lines = _lines_of_keys(text)

    def line(self, key: Key) -> int | None:
        """The line where ``key`` is given, or the table around it; None for the file as a whole."""
        while key and key not in self._lines:
            key = key[:-1]
        return self._lines.get(key)

    @contextmanager
    def named(self) -> Generator[None]:
        """A `FieldError` in this block becomes a `FileError` that names the line."""
        try:
            yield
        except FieldError as error:
            raise FileError(self._path, self.line(error.key), str(error)) from error


def _explained(error: Exception) -> tuple[Key, str]:
    """Where a value stands that does not fit the format, and what is wrong with it."""
    found = _PLACE.fullmatch(str(error))
    place = "" if found is None else found["place"] or ""
    parts = _PART.findall(place)
    key: Key = tuple(name or int(number) for name, number in parts)
    cause = error.__cause__
    if isinstance(cause, FieldError):
        inside = FieldError((*key, *cause.key), cause.problem)
        return inside.key, str(inside)
    problem = str(error) if found is None else found["problem"]
    where = f"{dotted(key)}: " if key else ""
    unknown = _UNKNOWN.search(problem)
    at = key if unknown is None else (*key, unknown[1])
    return at, f"{where}{problem[:1].lower()}{problem[1:]}"


def _lines_of_keys(text: str) -> dict[Key, int]:
    """The number of the line that begins each table and gives each key."""
    found: dict[Key, int] = {}
    table: Key = ()
    entries: dict[Key, int] = {}
    quote = ""
    for number, line in enumerate(text.split("\n"), start=1):
        if quote:
            quote = "" if quote in line else quote
            continue
        header, given = _HEADER.fullmatch(line), _KEY.match(line)
        if header is not None:
            table = _table(_names(header[2]), header[1] == "[[", entries)
            found.setdefault(table, number)
        elif given is not None:
            found.setdefault((*table, *_names(given[1])), number)
        for mark in ('"""', "'''"):
            if line.count(mark) % 2 == 1:
                quote = mark
    return found


def _names(dots: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in dots.replace('"', "").replace("'", "").split("."))


def _table(names: tuple[str, ...], is_entry: bool, entries: dict[Key, int]) -> Key:
    """Where a header leads: to the last entry of each array of tables on the way.

    Args:
        names: the parts of the header.
        is_entry: whether it begins a new entry of an array.
        entries: the number of the last entry of each array so far.
    """
    table: Key = ()
    for i, name in enumerate(names):
        table = (*table, name)
        if is_entry and i == len(names) - 1:
            entries[table] = entries.get(table, -1) + 1
        if table in entries:
            table = (*table, entries[table])
    return table
