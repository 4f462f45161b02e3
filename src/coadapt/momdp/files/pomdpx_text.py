"""Pieces of `.pomdpx` text: names, entries, sections."""

from __future__ import annotations

from collections.abc import Sequence
from typing import BinaryIO, final
from xml.sax.saxutils import escape

RESERVED = frozenset(("*", "-", ""))


def file_names(names: Sequence[str]) -> tuple[str, ...]:
    """``names`` as words: white space and what XML cannot hold become ``_``, and all differ."""
    words: list[str] = []
    for name in names:
        word = "".join("_" if c.isspace() or not c.isprintable() else c for c in name)
        words.append("_" if word in RESERVED else word)
    if len(set(words)) < len(words):
        seen: set[str] = set()
        for i, word in enumerate(words):
            unique = word
            while unique in seen or (unique != word and unique in words):
                unique = f"{word}~{i}" if unique == word else unique + "~"
            words[i] = unique
            seen.add(unique)
    return tuple(words)


@final
class Writer:
    """Writes elements to a file.

    Args:
        file: an open file.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file

    def line(self, text: str) -> None:
        """Write a line of markup as it is."""
        self._file.write(text.encode() + b"\n")

    def values(self, names: Sequence[str], letter: str) -> str:
        """The element that declares ``names``."""
        if len(names) > 1 and tuple(names) == tuple(f"{letter}{i}" for i in range(len(names))):
            return f"<NumValues>{len(names)}</NumValues>"
        return f"<ValueEnum>{escape(' '.join(names))}</ValueEnum>"

    def begin_table(self, element: str, variable: str, parents: Sequence[str]) -> None:
        """Begin the table of ``variable``."""
        self.line(
            f"<{element}><Var>{variable}</Var><Parent>{' '.join(parents) or 'null'}</Parent>"
            '<Parameter type="TBL">'
        )

    def end_table(self, element: str) -> None:
        """End a table."""
        self.line(f"</Parameter></{element}>")

    def entry(self, instance: Sequence[str], numbers: str, table: str = "ProbTable") -> None:
        """Write one entry of a table."""
        words = escape(" ".join(word for word in instance if word))
        self.line(f"<Entry><Instance>{words}</Instance><{table}>{numbers}</{table}></Entry>")
