"""Hypotheses as data: what is expected, of which outcome, and by which test, before data exist.

A study declares its hypotheses in `study.toml`, an entry of ``[[hypotheses]]`` each. The analysis
reads them from there and runs those tests and no others.
"""

from __future__ import annotations

from itertools import combinations, pairwise
from typing import Literal

import msgspec

from coadapt.requirements import FieldError, Key, require, require_known

PERFORMANCE = "performance"
"""The mean reward of a participant's trials (Sec. 7.1)."""

SWITCHED = "switched"
"""Whether a participant went for another goal than the one chosen before the trials."""

Test = Literal["kruskal_wallis", "anova", "welch", "proportions"]

Pairs = Literal["mann_whitney", "tukey", "games_howell", "fisher"]

BY_TEST: dict[Test, tuple[Pairs, ...]] = {
    "kruskal_wallis": ("mann_whitney",),
    "anova": ("tukey", "games_howell"),
    "welch": ("games_howell",),
    "proportions": ("fisher",),
}
"""The comparisons of pairs that go with each test of all conditions."""

HOLDS_FAMILY: frozenset[Pairs] = frozenset({"tukey", "games_howell"})
"""Comparisons that are corrected for all pairs by themselves."""


class Hypothesis(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A hypothesis and how it is tested.

    Attributes:
        name: for example "H1".
        text: the hypothesis in words.
        outcomes: what it is about: `PERFORMANCE`, `SWITCHED`, or names of scales. Each is tested by
            itself.
        order: names of conditions, that with the highest expected outcome first.
        test: of all conditions in ``order``: ``"kruskal_wallis"``, ``"anova"``, ``"welch"``, or,
            for
            `SWITCHED` alone, ``"proportions"``.
        pairs: of two conditions: ``"mann_whitney"``, ``"tukey"``, ``"games_howell"``, ``"fisher"``.
        compare: ``"neighbours"``: those that follow each other in ``order``; ``"all"``: every pair.
        correction: of the pairs' p for their number: ``"bonferroni"``, ``"holm"`` or ``"none"``;
            Tukey's
            and Games and Howell's are corrected for all pairs in any case.
        level: a p below it is significant.
        equivalence: the smallest difference of two means that would matter; pairs without a
            significant
            difference are then tested for equivalence within it. None for no such test.

    Raises:
        FieldError: if the parts do not fit together.
    """

    name: str
    text: str
    outcomes: tuple[str, ...]
    order: tuple[str, ...]
    test: Test = "kruskal_wallis"
    pairs: Pairs = "mann_whitney"
    compare: Literal["neighbours", "all"] = "neighbours"
    correction: Literal["bonferroni", "holm", "none"] = "bonferroni"
    level: float = 0.05
    equivalence: float | None = None

    def __post_init__(self) -> None:
        require(("name",), bool(self.name.strip()), "some text", "empty")
        require(("text",), bool(self.text.strip()), "some text", "empty")
        _require_different(("outcomes",), self.outcomes, 1)
        _require_different(("order",), self.order, 2)
        require(("level",), 0 < self.level < 1, "above 0 and below 1", self.level)
        fitting = BY_TEST[self.test]
        wanted = f"{' or '.join(fitting)} with the test {self.test}"
        require(("pairs",), self.pairs in fitting, wanted, self.pairs)
        counts = self.outcomes == (SWITCHED,)
        wanted = f"proportions for the outcome {SWITCHED}, and for it alone"
        require(("test",), counts == (self.test == "proportions"), wanted, self.test)
        bound = self.equivalence
        require(("equivalence",), bound is None or bound > 0, "above 0", bound)

    @property
    def compared(self) -> tuple[tuple[str, str], ...]:
        """The pairs that the hypothesis is about: the first of each is expected to be higher."""
        return tuple((pairwise if self.compare == "neighbours" else _combined)(self.order))

    def require_known(self, key: Key, conditions: set[str], scales: set[str]) -> None:
        """Raise FieldError unless conditions and outcomes are those of a study.

        Args:
            key: where the hypothesis stands.
            conditions: the study's.
            scales: the study's.
        """
        for name in self.order:
            require_known((*key, "order"), name, conditions, "conditions")
        for name in self.outcomes:
            known = scales | {PERFORMANCE, SWITCHED}
            require_known((*key, "outcomes"), name, known, f"outcomes {', '.join(sorted(known))}")


def published(no: str, mutual: str, one_way: str) -> tuple[Hypothesis, Hypothesis]:
    """H1 and H2 of Sec. 6.2 with the tests of Sec. 7, for conditions of these names.

    The paper does not test equivalence; that "no significant difference" in H2 is followed by a
    test of equivalence within half a point is ours.
    """
    return (
        Hypothesis(
            name="H1",
            text=(
                "Teams perform better without adaptation than with mutual adaptation, and better "
                "with mutual adaptation than with one-way adaptation."
            ),
            outcomes=(PERFORMANCE,),
            order=(no, mutual, one_way),
            test="kruskal_wallis",
            pairs="mann_whitney",
            correction="bonferroni",
        ),
        Hypothesis(
            name="H2",
            text=(
                "Trust in the robot and perceived collaboration are higher with one-way adaptation "
                "than with mutual adaptation, and higher with mutual adaptation than without "
                "adaptation."
            ),
            outcomes=("trust", "collaboration"),
            order=(one_way, mutual, no),
            test="anova",
            pairs="tukey",
            equivalence=0.5,
        ),
    )


def _combined(names: tuple[str, ...]) -> combinations[tuple[str, str]]:
    return combinations(names, 2)


def _require_different(key: Key, names: tuple[str, ...], fewest: int) -> None:
    require(key, len(names) >= fewest, f"at least {fewest} names", len(names))
    if len(set(names)) < len(names):
        raise FieldError(key, "has a name twice, expected different names")
