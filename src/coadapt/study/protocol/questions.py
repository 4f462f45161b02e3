"""What participants are asked after the trials: scales of items, and questions."""

from __future__ import annotations

from typing import Literal

from coadapt.requirements import require
from coadapt.study.protocol.part import Part, require_identifier, require_text

AGREEMENT = (
    "Strongly disagree",
    "Disagree",
    "Neither agree nor disagree",
    "Agree",
    "Strongly agree",
)
"""The labels of a five-point Likert item."""

FEWEST_POINTS, MOST_POINTS = 2, 11

MOST_ITEMS = 100


class Item(Part, frozen=True, kw_only=True):
    """A statement that is rated on the points of its scale.

    Attributes:
        name: what it is called in the data.
        text: the statement.
        reversed: whether agreement means less of what the scale measures.
        expected: of an attention check, the point, from 1, that an attentive person chooses; such
            an item is no part of the score.
    """

    name: str
    text: str
    reversed: bool = False
    expected: int | None = None

    def __post_init__(self) -> None:
        require_identifier(("name",), self.name)
        require_text(("text",), self.text)


class Scale(Part, frozen=True, kw_only=True):
    """Items on one page, combined into a score.

    Attributes:
        name: what it is called in the data.
        title: what stands above the items.
        items: the statements.
        points: the labels of the points, the lowest first.
        shuffle: whether every participant sees the items in an order of their own.
        source: where the scale comes from.
    """

    name: str
    items: tuple[Item, ...]
    title: str = ""
    points: tuple[str, ...] = AGREEMENT
    shuffle: bool = False
    source: str = ""

    def __post_init__(self) -> None:
        require_identifier(("name",), self.name)
        count, points = len(self.items), len(self.points)
        require(("items",), 1 <= count <= MOST_ITEMS, f"1 to {MOST_ITEMS} items", count)
        wanted = f"{FEWEST_POINTS} to {MOST_POINTS} labels"
        require(("points",), FEWEST_POINTS <= points <= MOST_POINTS, wanted, points)
        for i, item in enumerate(self.items):
            inside = item.expected is None or 1 <= item.expected <= points
            require(("items", i, "expected"), inside, f"a point from 1 to {points}", item.expected)


class Question(Part, frozen=True, kw_only=True):
    """A question that is answered in words or by a choice.

    Attributes:
        name: what it is called in the data.
        text: the question.
        choices: the answers to choose from; free text if there are none.
        required: whether it must be answered.
        ask: ``"always"``, or ``"if changed"``: only of those who changed their strategy.
    """

    name: str
    text: str
    choices: tuple[str, ...] = ()
    required: bool = False
    ask: Literal["always", "if changed"] = "always"

    def __post_init__(self) -> None:
        require_identifier(("name",), self.name)
        require_text(("text",), self.text)
        different = len(set(self.choices)) == len(self.choices) != 1
        require(
            ("choices",), different, "different answers, none or at least 2", list(self.choices)
        )
