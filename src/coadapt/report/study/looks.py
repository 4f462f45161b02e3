"""How conditions look and what they are called in figures and tables."""

from __future__ import annotations

from collections.abc import Sequence

from coadapt.report.figures.style import FIXED, HUMAN, MUTUAL, ONE_WAY, ONE_WAY_TEXT, PATH, ROBOT

KNOWN = {
    "no_adaptation": (FIXED, "D"),
    "mutual_adaptation": (MUTUAL, "o"),
    "one_way_adaptation": (ONE_WAY, "s"),
}
"""Colour and marker of the paper's conditions, as in the report of its simulations."""

OTHERS = ((HUMAN, "^"), (PATH, "v"), (ROBOT, "P"), (MUTUAL, "X"), (ONE_WAY, "*"))


def looks(conditions: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Colour and marker of each condition."""
    rest = iter(OTHERS * (1 + len(conditions) // len(OTHERS)))
    return {name: KNOWN[name] if name in KNOWN else next(rest) for name in conditions}


def text_color(color: str) -> str:
    """The colour for words about what has ``color``: dark enough to read."""
    return ONE_WAY_TEXT if color == ONE_WAY else color


def title_of(name: str) -> str:
    """``mutual_adaptation`` as ``Mutual adaptation``."""
    if name == "one_way_adaptation":
        return "One-way adaptation"
    words = name.replace("_", " ").strip()
    return words[:1].upper() + words[1:]


def spoken(text: str, conditions: Sequence[str]) -> str:
    """``text`` with the titles of conditions instead of their names."""
    for name in sorted(conditions, key=len, reverse=True):
        text = text.replace(name, title_of(name))
    return text


def two_lines(name: str) -> str:
    """The title, broken at a blank near its middle."""
    title = title_of(name)
    blanks = [i for i, sign in enumerate(title) if sign == " "]
    if not blanks or len(title) < 10:
        return title
    at = min(blanks, key=lambda i: abs(i - len(title) / 2))
    return f"{title[:at]}\n{title[at + 1 :]}"
