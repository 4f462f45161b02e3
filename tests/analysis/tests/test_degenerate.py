"""Samples about which a test says nothing are refused with the reason; no number is ever NaN."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.analysis import tests as ct
from coadapt.analysis.tests.samples import CannotTest

ALL: dict[str, Callable[[dict[str, list[float]]], Any]] = {
    "kruskal_wallis": ct.kruskal_wallis,
    "mann_whitney": ct.mann_whitney,
    "one_way_anova": ct.one_way_anova,
    "welch_anova": ct.welch_anova,
    "tukey": ct.tukey,
    "games_howell": ct.games_howell,
    "cumulative_logit": ct.cumulative_logit,
    "equivalence": lambda groups: ct.equivalence(groups, 0.5),
}


def numbers(value: object) -> Iterator[float]:
    """All numbers in a result."""
    if isinstance(value, msgspec.Struct):
        value = msgspec.to_builtins(value)
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, (list, tuple)):
        for part in value:
            yield from numbers(part)
    elif isinstance(value, float):
        yield value


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize(
    ("groups", "says"),
    [
        ({"a": [3.0, 3.0, 3.0], "b": [3.0, 3.0]}, "nothing differs|are the same|no group"),
        ({"a": [1.0, 2.0, 3.0]}, "at least 2 groups"),
        ({"a": [1.0, 2.0, 3.0], "b": []}, "values a group, b has 0"),
        ({"a": [1.0, 2.0, math.nan], "b": [1.0, 2.0]}, "needs finite numbers, a has others"),
        ({"a": [1.0, 2.0, math.inf], "b": [1.0, 2.0]}, "needs finite numbers, a has others"),
    ],
)
def test_refused_with_the_reason(name: str, groups: dict[str, list[float]], says: str) -> None:
    with pytest.raises(CannotTest, match=says):
        ALL[name](groups)


@pytest.mark.parametrize("name", ["one_way_anova", "tukey", "equivalence"])
def test_groups_without_any_variance_but_different(name: str) -> None:
    with pytest.raises(CannotTest, match="values differ in no group"):
        ALL[name]({"a": [1.0, 1.0, 1.0], "b": [2.0, 2.0]})


@pytest.mark.parametrize("name", ["welch_anova", "games_howell"])
def test_a_constant_group_has_no_variance_to_weigh_by(name: str) -> None:
    with pytest.raises(CannotTest, match="all values of b are the same"):
        ALL[name]({"a": [1.0, 2.0, 1.0], "b": [2.0, 2.0]})


def test_groups_that_do_not_overlap_have_no_odds_ratio() -> None:
    with pytest.raises(CannotTest, match="do not overlap"):
        ct.cumulative_logit({"a": [1.0, 1, 2, 2, 1], "b": [4.0, 4, 5, 4, 5]})


@pytest.mark.parametrize(
    ("counts", "says"),
    [
        ({"a": (0, 5), "b": (0, 7)}, "none of 12 did it"),
        ({"a": (5, 5), "b": (7, 7)}, "all of 12 did it"),
        ({"a": (0, 0), "b": (1, 7)}, "nobody in a"),
        ({"a": (8, 7), "b": (1, 7)}, "8 of 7 in a is no proportion"),
        ({"a": (1, 7)}, "at least 2 groups"),
    ],
)
def test_counts_that_say_nothing(counts: dict[str, tuple[int, int]], says: str) -> None:
    with pytest.raises(CannotTest, match=says):
        ct.proportions(counts)


values = st.lists(st.integers(1, 5).map(float), min_size=1, max_size=8)


@given(
    st.lists(values, min_size=2, max_size=4),
    st.sampled_from(sorted(set(ALL) - {"games_howell", "tukey"})),
)
def test_no_number_is_ever_nan(groups: list[list[float]], name: str) -> None:
    named = {f"g{i}": group for i, group in enumerate(groups)}
    try:
        result = ALL[name](named)
    except CannotTest:
        return
    assert all(map(math.isfinite, numbers(result))) or (
        # Where ranks or values are told apart without rest, F has no bound.
        name == "one_way_anova" and result.statistic == math.inf
    )
    for effect in result.effects:
        assert effect.low <= effect.high
        if effect.name not in ("ω²", "g"):  # their estimates are corrected, their intervals not
            assert effect.low - 1e-9 <= effect.value <= effect.high + 1e-9
    assert 0 <= result.p <= 1
    assert msgspec.json.decode(msgspec.json.encode(result), type=ct.TestResult) == result


def test_extreme_pairs_have_intervals_of_some_width() -> None:
    found = ct.mann_whitney({"a": [3.0] * 17, "b": [0.0] * 17})
    r = found.effects[0]
    assert r.value == r.high == 1 and 0.5 < r.low < 1
    found = ct.mann_whitney({"a": [0.0] * 17, "b": [3.0] * 17})
    assert found.effects[0].low == -1 and found.effects[0].high == pytest.approx(-r.low)


@given(st.lists(st.floats(0, 1), min_size=1, max_size=8))
def test_corrections_keep_the_order(values: list[float]) -> None:
    holm, bonferroni = ct.adjusted(values, "holm"), ct.adjusted(values, "bonferroni")
    for p, h, b in zip(values, holm, bonferroni, strict=True):
        assert p <= h <= b <= 1
    assert ct.adjusted(values, "none") == tuple(values)
    order = sorted(range(len(values)), key=lambda i: values[i])
    assert [holm[i] for i in order] == sorted(holm)


def test_what_was_not_tested_counts_as_a_comparison() -> None:
    done = ct.mann_whitney({"a": [1.0, 2, 3, 3], "b": [4.0, 4, 5, 5]})
    missed = ct.NotTested(test="Mann-Whitney", groups=("a", "c"), reason="nothing differs")
    found = ct.correct([done, missed], "bonferroni")
    assert isinstance(found[0], ct.TestResult) and found[0].comparisons == 2
    assert found[0].adjusted == 2 * done.p
    assert found[1] == missed
