"""A guarded XML parser: elements of a known grammar, with their lines.

Document types are refused, and with them entities, internal and external. The depth is limited. An
element that the grammar does not allow at its place is an error.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import BinaryIO, Protocol, final
from xml.parsers import expat

from coadapt.errors import FileError, excerpt
from coadapt.momdp.files.limits import MAX_DEPTH

CHUNK = 1 << 24
"""Bytes handed to the parser at a time."""

ANYTHING = "*"
"""As the grammar of an element: its contents are skipped."""


@dataclass(frozen=True)
class Kind:
    """What an element may contain.

    Attributes:
        children: names of the elements allowed in it, or `ANYTHING`.
        text: whether its text matters; elsewhere only white space is allowed.
        required: attributes that it must have.
    """

    children: frozenset[str] | str = frozenset()
    text: bool = False
    required: tuple[str, ...] = ()


class Handler(Protocol):
    """Receives the elements of a document."""

    def begin(self, line: int, path: tuple[str, ...], attributes: dict[str, str]) -> None:
        """The element at the end of ``path`` begins."""
        ...

    def end(self, line: int, path: tuple[str, ...], text: str) -> None:
        """The element ends; ``line`` is where it began."""
        ...


@final
class _Parser:
    """Calls a handler for the elements of one document."""

    def __init__(
        self, path: object, root: str, grammar: Mapping[str, Kind], handler: Handler
    ) -> None:
        self._path = path
        self._root = root
        self._grammar = grammar
        self._handler = handler
        self._open: tuple[str, ...] = ()
        self._lines: list[int] = []
        self._text: list[str] = []
        self._skipping = 0
        self.expat = expat.ParserCreate()
        self.expat.buffer_text = True
        self.expat.buffer_size = 1 << 16
        self.expat.StartElementHandler = self._begin
        self.expat.EndElementHandler = self._end
        self.expat.CharacterDataHandler = self._characters
        self.expat.StartDoctypeDeclHandler = self._refuse_doctype
        self.expat.EntityDeclHandler = self._refuse_doctype

    def _error(self, message: str) -> FileError:
        return FileError(self._path, self.expat.CurrentLineNumber, message)

    def _refuse_doctype(self, *arguments: object) -> None:
        del arguments
        raise self._error("found a document type or entity declaration, expected plain elements")

    def _begin(self, name: str, attributes: dict[str, str]) -> None:
        if len(self._open) + self._skipping >= MAX_DEPTH:
            raise self._error(f"found elements nested {MAX_DEPTH} deep, expected fewer")
        if self._skipping:
            self._skipping += 1
            return
        if self._open:
            allowed = self._grammar[self._open[-1]].children
            if allowed == ANYTHING:
                self._skipping = 1
                return
            if name not in allowed:
                wanted = ", ".join(f"<{child}>" for child in sorted(allowed)) or "no element"
                raise self._error(
                    f"found <{_short(name)}> in <{self._open[-1]}>, expected {wanted}"
                )
        elif name != self._root:
            raise self._error(f"found <{_short(name)}>, expected <{self._root}>")
        if self._text and self._open:
            self._check_text()
        for attribute in self._grammar[name].required:
            if not attributes.get(attribute, "").strip():
                raise self._error(f"found <{name}> without {attribute}, expected {attribute}='...'")
        self._open = (*self._open, name)
        self._lines.append(self.expat.CurrentLineNumber)
        self._text = []
        self._handler.begin(self._lines[-1], self._open, attributes)

    def _end(self, name: str) -> None:
        del name
        if self._skipping:
            self._skipping -= 1
            return
        if not self._grammar[self._open[-1]].text:
            self._check_text()
        self._handler.end(self._lines.pop(), self._open, "".join(self._text))
        self._text = []
        self._open = self._open[:-1]

    def _characters(self, data: str) -> None:
        if not self._skipping:
            self._text.append(data)

    def _check_text(self) -> None:
        """Refuse words between elements."""
        words = "".join(self._text).strip()
        skipped = self._grammar[self._open[-1]].children == ANYTHING
        if words and not skipped:
            raise self._error(
                f"found {excerpt(words)} in <{self._open[-1]}>, expected elements only"
            )


def parse_xml(
    path: object, file: BinaryIO, root: str, grammar: Mapping[str, Kind], handler: Handler
) -> None:
    """Parse ``file`` and hand its elements to ``handler``.

    Args:
        path: the file, for error messages.
        file: the open file.
        root: name of the outermost element.
        grammar: what each element may contain.
        handler: called in document order.

    Raises:
        FileError: if the file is not well-formed XML, or does not follow the grammar.
    """
    parser = _Parser(path, root, grammar, handler)
    try:
        while chunk := file.read(CHUNK):
            parser.expat.Parse(chunk, False)
        parser.expat.Parse(b"", True)
    except FileError:
        raise
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        raise FileError(
            path,
            error.lineno,
            f"found malformed XML ({reason}), expected elements that are complete",
        ) from error
    except (LookupError, ValueError) as error:
        # An encoding that is unknown, or that the parser cannot use.
        raise FileError(
            path, 1, "found text in an unknown encoding, expected UTF-8 or ISO-8859-1"
        ) from error


def _short(name: str) -> str:
    return name if len(name) <= 40 else name[:37] + "..."
