"""The words of a `.pomdp` file, one after the other, with their lines.

Words are separated by white space; a colon is a word of its own; ``#`` starts a comment that ends
with the line. The file is read as it is needed, so that its size costs no memory.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import final

import numpy as np

from coadapt.arrays import FloatArray
from coadapt.errors import FileError, excerpt
from coadapt.momdp.files.values import numbers, pieces

BLOCK = 20_000
"""Words that are read at a time."""


@final
class Tokens:
    """A cursor over the words of a file.

    Args:
        path: the file, for error messages.
        lines: its lines.
    """

    def __init__(self, path: object, lines: Iterator[str]) -> None:
        self.path = path
        self._lines = lines
        self._rest: Iterator[list[str]] = iter(())  # of the line that is being split
        self._words: list[str] = []
        self._line_of: list[int] = []
        self._next = 0
        self._read = 0

    @property
    def line(self) -> int:
        """The line of the next word; the last line at the end of the file."""
        if self._next < len(self._line_of) or self._fill(1):
            return self._line_of[self._next]
        return max(self._read, 1)

    def peek(self, ahead: int = 0) -> str | None:
        """The next word, or one further ahead; None at the end of the file."""
        place = self._next + ahead
        if place < len(self._words):
            return self._words[place]
        if not self._fill(ahead + 1):
            return None
        return self._words[self._next + ahead]

    def next(self, expected: str) -> str:
        """The next word.

        Raises:
            FileError: at the end of the file.
        """
        word = self.peek()
        if word is None:
            raise self.error(expected)
        self._next += 1
        return word

    def accept(self, word: str) -> bool:
        """Whether the next word is ``word``, which is then passed."""
        if self.peek() != word:
            return False
        self._next += 1
        return True

    def expect(self, word: str) -> None:
        """Pass ``word``.

        Raises:
            FileError: if the next word is another.
        """
        if not self.accept(word):
            raise self.error(repr(word))

    def numbers(self, count: int, expected: str) -> FloatArray:
        """The next ``count`` words as numbers ``[count]``.

        Raises:
            FileError: naming the first word that is not a number.
        """
        if count == 1:
            line = self.line
            return numbers(self.path, line, [self.next(expected)], expected)
        blocks: list[FloatArray] = []
        missing = count
        while missing > 0:
            if not self._fill(1):
                raise FileError(
                    self.path,
                    self.line,
                    f"found the end of the file after {count - missing} of {count} numbers, "
                    f"expected {expected}",
                )
            end = min(self._next + missing, len(self._words))
            words = self._words[self._next : end]
            try:
                blocks.append(numbers(self.path, self.line, words, expected))
            except FileError:
                for i, word in enumerate(words):
                    numbers(self.path, self._line_of[self._next + i], [word], expected)
                raise
            missing -= len(words)
            self._next = end
        return np.concatenate(blocks) if blocks else np.zeros(0)

    def error(self, expected: str) -> FileError:
        """The error that the next word is not what was expected."""
        line, word = self.line, self.peek()
        found = "the end of the file" if word is None else excerpt(word)
        return FileError(self.path, line, f"found {found}, expected {expected}")

    def _fill(self, count: int) -> bool:
        """Whether there are ``count`` words ahead; reads on if they are not there yet."""
        if self._next + count <= len(self._words):
            return True
        del self._words[: self._next], self._line_of[: self._next]
        self._next = 0
        while len(self._words) < max(count, BLOCK):
            words = next(self._rest, None)
            if words is None:
                text = next(self._lines, None)
                if text is None:
                    break
                self._read += 1
                if "#" in text:
                    text = text[: text.index("#")]
                self._rest = pieces(text.replace(":", " : "))
                continue
            self._words += words
            self._line_of += [self._read] * len(words)
        return count <= len(self._words)
