"""What a study's file says that an analysis needs: conditions, scales, hypotheses.

The file is the `study.toml` of an export, or one of one's own with these parts alone. What else
stands in it is of no concern here.
"""

from __future__ import annotations

import os
from hashlib import sha256
from pathlib import Path

import msgspec

from coadapt.errors import FileError
from coadapt.hypotheses import Hypothesis
from coadapt.requirements import require
from coadapt.toml import LARGEST_FILE, parse_toml


class Rewards(msgspec.Struct, frozen=True, kw_only=True):
    """What goals are worth: ``R_opt`` and ``R_sub`` (Sec. 6.5)."""

    optimal: float = 11.0
    other: float = 10.0


class DeclaredItem(msgspec.Struct, frozen=True, kw_only=True):
    """An item of a scale; one with an expected answer is a check of attention."""

    name: str
    text: str = ""
    reversed: bool = False
    expected: int | None = None


class DeclaredScale(msgspec.Struct, frozen=True, kw_only=True):
    """A scale and the labels of its points, the lowest first."""

    name: str
    items: tuple[DeclaredItem, ...]
    points: tuple[str, ...] = ("1", "2", "3", "4", "5")
    source: str = ""

    @property
    def rated(self) -> tuple[DeclaredItem, ...]:
        """The items that count towards the score."""
        return tuple(item for item in self.items if item.expected is None)


class DeclaredCondition(msgspec.Struct, frozen=True, kw_only=True):
    """A condition and how many completed sessions were planned for it."""

    name: str
    robot: str = ""
    quota: int | None = None


class Declaration(msgspec.Struct, frozen=True, kw_only=True):
    """What was declared.

    Attributes:
        title: of the study.
        task, trials, practice, belief: as in the protocol.
        rewards: of the goals.
        conditions: the robots.
        scales: what is rated.
        hypotheses: what is tested.
    """

    title: str = ""
    task: str = ""
    trials: int = 3
    practice: int | None = None
    belief: str = ""
    rewards: Rewards = Rewards()
    conditions: tuple[DeclaredCondition, ...] = ()
    scales: tuple[DeclaredScale, ...] = ()
    hypotheses: tuple[Hypothesis, ...] = ()

    def __post_init__(self) -> None:
        require(("trials",), self.trials >= 1, "at least 1", self.trials)
        conditions = {condition.name for condition in self.conditions}
        scales = {scale.name for scale in self.scales}
        for i, hypothesis in enumerate(self.hypotheses):
            if conditions:
                hypothesis.require_known(("hypotheses", i), conditions, scales)


def read_declaration(path: str | os.PathLike[str]) -> tuple[Declaration, str]:
    """The declaration in a file, and the SHA-256 of that file.

    Raises:
        FileError: if it cannot be read or used; names the line where there is one.
    """
    try:
        raw = Path(path).read_bytes()
    except OSError as error:
        found = f"found no readable file ({error.strerror}), expected a study's protocol"
        raise FileError(path, None, found) from error
    if len(raw) > LARGEST_FILE:
        raise FileError(path, None, f"found more than {LARGEST_FILE:,} bytes")
    declared, _ = parse_toml(raw, path, Declaration, "a study's protocol")
    return declared, sha256(raw).hexdigest()
