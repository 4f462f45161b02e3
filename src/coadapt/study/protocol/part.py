"""What all parts of a protocol have in common."""

from __future__ import annotations

import re

import msgspec

from coadapt.errors import excerpt
from coadapt.requirements import Key, require

LONGEST_TEXT = 50_000
"""Characters of one text."""

_IDENTIFIER = re.compile(r"[a-z][a-z0-9_]{0,39}")


class Part(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A part of a protocol: unknown names in it are refused."""


def require_identifier(key: Key, name: str) -> None:
    """Raise FieldError unless ``name`` can name a column of the exported data."""
    wanted = "lower-case letters, digits and _, beginning with a letter, 40 at most"
    require(key, _IDENTIFIER.fullmatch(name) is not None, wanted, excerpt(name))


def require_text(key: Key, text: str) -> None:
    """Raise FieldError if ``text`` is empty or too long."""
    require(key, bool(text.strip()), "some text", "empty")
    length = len(text)
    require(key, length <= LONGEST_TEXT, f"{LONGEST_TEXT:,} characters at most", f"{length:,}")
