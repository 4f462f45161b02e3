"""Hypotheses as data."""

from __future__ import annotations

from typing import Any

import msgspec
import pytest

from coadapt.hypotheses import Hypothesis, published
from coadapt.requirements import FieldError
from coadapt.study.protocol.reader import template
from coadapt.study.protocol.study import Study
from coadapt.toml import parse_toml

NAMES = ("no_adaptation", "mutual_adaptation", "one_way_adaptation")

GIVEN: dict[str, Any] = {
    "name": "H",
    "text": "a above b",
    "outcomes": ("performance",),
    "order": ("a", "b", "c"),
}


def test_a_new_study_declares_those_of_the_paper() -> None:
    study, _ = parse_toml(template(), "study.toml", Study, "a study")
    assert study.hypotheses == published(*NAMES)


def test_pairs_that_are_compared() -> None:
    assert Hypothesis(**GIVEN).compared == (("a", "b"), ("b", "c"))
    assert Hypothesis(**GIVEN, compare="all").compared == (("a", "b"), ("a", "c"), ("b", "c"))


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"name": " "}, "name must be some text"),
        ({"order": ("a",)}, "order must be at least 2 names"),
        ({"order": ("a", "a")}, "order has a name twice"),
        ({"outcomes": ()}, "outcomes must be at least 1 names"),
        ({"pairs": "tukey"}, "pairs must be mann_whitney with the test kruskal_wallis"),
        ({"outcomes": ("switched",)}, "test must be proportions for the outcome switched"),
        ({"test": "proportions", "pairs": "fisher"}, "test must be proportions for the outcome"),
        ({"level": 1.0}, "level must be above 0 and below 1"),
        ({"equivalence": 0.0}, "equivalence must be above 0"),
    ],
)
def test_parts_that_do_not_fit(changed: dict[str, Any], says: str) -> None:
    with pytest.raises(FieldError, match=says):
        Hypothesis(**(GIVEN | changed))


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"order": ("no_adaptation", "deaf")}, r"hypotheses\[0\].order names 'deaf'"),
        ({"outcomes": ("liking",)}, r"hypotheses\[0\].outcomes names 'liking'"),
    ],
)
def test_names_a_study_does_not_have(changed: dict[str, Any], says: str) -> None:
    study, _ = parse_toml(template(), "study.toml", Study, "a study")
    wrong = msgspec.structs.replace(study.hypotheses[0], **changed)
    with pytest.raises(FieldError, match=says):
        msgspec.structs.replace(study, hypotheses=(wrong,))
