"""The page on the study format lists what the format has, with its defaults."""

from __future__ import annotations

import re
from pathlib import Path

import msgspec
import pytest

from coadapt.hypotheses import Hypothesis
from coadapt.study.protocol import (
    Allocation,
    Clock,
    Condition,
    Item,
    Question,
    Recruitment,
    Scale,
    Study,
    Texts,
)
from coadapt.study.protocol.study import Rewards

PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "study-format.md").read_text("utf-8")
SECTIONS = dict(re.findall(r"^## ([^\n]+)\n(.*?)(?=^## |\Z)", PAGE, re.MULTILINE | re.DOTALL))
ROWS = re.compile(r"^\| `(\w+)` \| ([^|]*) \|", re.MULTILINE)

PLACES = [
    (Rewards, "`[rewards]`"),
    (Clock, "`[clock]`"),
    (Condition, "`[[conditions]]`"),
    (Allocation, "`[allocation]`"),
    (Recruitment, "`[recruitment]`"),
    (Question, "`[[questions]]`"),
    (Hypothesis, "`[[hypotheses]]`"),
]


def keys(section: str) -> list[str]:
    return [name for name, _ in ROWS.findall(SECTIONS[section])]


@pytest.mark.parametrize(("part", "section"), PLACES)
def test_every_key_is_listed(part: type[msgspec.Struct], section: str) -> None:
    assert keys(section) == list(part.__struct_fields__)


def test_scales_items_and_the_top_level() -> None:
    listed = keys("`[[scales]]` and `[[scales.items]]`")
    assert sorted(listed) == sorted([*Scale.__struct_fields__, *Item.__struct_fields__])
    tables = re.findall(r"`\[+(\w+)\]+`", SECTIONS["Top level"])
    assert sorted([*keys("Top level"), *tables]) == sorted(Study.__struct_fields__)
    named = set(re.findall(r"`(\w+)`", SECTIONS["`[texts]`"]))
    assert named == set(Texts.__struct_fields__)


@pytest.mark.parametrize(("part", "section"), [*PLACES, (Study, "Top level")])
def test_defaults_are_those_of_the_format(part: type[msgspec.Struct], section: str) -> None:
    written = dict(ROWS.findall(SECTIONS[section]))
    checked = 0
    for field in msgspec.structs.fields(part):
        if field.name not in written:
            continue
        shown = written[field.name].strip().strip("`")
        default = field.default
        if field.required:
            assert shown == "needed", field.name
        elif isinstance(default, bool):
            assert shown == f"{default}".lower(), field.name
        elif isinstance(default, int | float):
            assert float(shown) == default, field.name
        elif isinstance(default, str):
            assert shown.strip('"') == default, field.name
        elif field.name == "covariates":
            assert shown == '["choice"]'
        else:
            assert shown in ("none", "no limit", "Prolific's three"), field.name
        checked += 1
    assert checked > 0
