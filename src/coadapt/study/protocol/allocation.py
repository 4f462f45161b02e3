"""How participants are allocated to conditions."""

from __future__ import annotations

from typing import Literal

from coadapt.requirements import require
from coadapt.study.protocol.part import Part


class Allocation(Part, frozen=True, kw_only=True):
    """Settings of the allocation.

    Attributes:
        method: ``"balanced"``: to the condition with the fewest sessions that are completed or
            under way; ``"blocks"``: in random order within blocks; ``"minimisation"``: to the
            condition that best balances the covariates (Pocock and Simon 1975).
        seed: of the random order.
        stale_minutes: a session without a sign of life for so long no longer counts as under way.
        repeats: of ``"blocks"``: how often each condition stands in a block.
        covariates: of ``"minimisation"``: any of ``"choice"`` (the goal wanted at first) and
            ``"device"`` (what the participant steers with).
        chance: of ``"minimisation"``: probability of the condition that balances best.
    """

    method: Literal["balanced", "blocks", "minimisation"] = "balanced"
    seed: int = 0
    stale_minutes: float = 60.0
    repeats: int = 2
    covariates: tuple[Literal["choice", "device"], ...] = ("choice",)
    chance: float = 0.8

    def __post_init__(self) -> None:
        require(("seed",), self.seed >= 0, "at least 0", self.seed)
        require(("stale_minutes",), self.stale_minutes > 0, "above 0", self.stale_minutes)
        require(("repeats",), self.repeats >= 1, "at least 1", self.repeats)
        require(("chance",), 0 < self.chance <= 1, "above 0 and at most 1", self.chance)
