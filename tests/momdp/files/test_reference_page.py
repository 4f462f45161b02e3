"""The page on file formats says what the code does."""

from __future__ import annotations

import re
from pathlib import Path

from coadapt.momdp.files import limits, values

PAGE = Path(__file__).parents[3] / "docs" / "reference" / "file-formats.md"


def test_limits_are_those_of_the_code() -> None:
    stated = {
        name: int(value.replace(",", ""))
        for name, value in re.findall(r"\| `(MAX_\w+)` \| ([\d,]+) \|", PAGE.read_text())
    }
    assert stated == {name: getattr(limits, name) for name in dir(limits) if name[:4] == "MAX_"}


def test_tolerances_are_those_of_the_code() -> None:
    text = " ".join(PAGE.read_text().split())
    assert values.SUM_TOLERANCE == 1e-4
    assert "may differ from 1 by 1e-4" in text
    assert values.EXACT_SUM == 1e-12
    assert "within 1e-12 of 1 are left" in text
