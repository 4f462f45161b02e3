"""The page of equations is what the code says now."""

from __future__ import annotations

import inspect
import re
import runpy
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parent.parent
MADE: dict[str, Any] = runpy.run_path(str(ROOT / "docs" / "make_equations.py"))


def cited(text: str) -> set[str]:
    """The equations and sections that ``text`` cites; "Eq. 6-8" and "Sec. 2 to 5" are ranges."""
    found: set[str] = set()
    for kind, listed in re.findall(
        r"\b(Eq|Sec)\. ([\d.]*\d(?:(?:-| to |, | and )[\d.]*\d)*)", text
    ):
        parts = re.split(r"(-| to |, | and )", listed)
        found.add(f"{kind}. {parts[0]}")
        for before, joint, after in zip(parts[::2], parts[1::2], parts[2::2], strict=False):
            found.add(f"{kind}. {after}")
            if joint in ("-", " to ") and before.isdigit() and after.isdigit():
                found |= {f"{kind}. {n}" for n in range(int(before), int(after) + 1)}
    return found


def test_the_page_is_up_to_date() -> None:
    page: str = MADE["page"]()
    assert (ROOT / "docs" / "reference" / "equations.md").read_text("utf-8") == page


@pytest.mark.parametrize("entry", MADE["ENTRIES"], ids=lambda e: e.where)
def test_what_computes_an_equation_cites_it(entry: Any) -> None:
    for name in entry.code:
        found = MADE["find"](name)
        module = sys.modules[name.partition(":")[0]]
        text = f"{inspect.getdoc(found)}\n{inspect.getdoc(module)}"
        assert entry.where in cited(text), f"{name} does not cite {entry.where}"


def test_no_equation_is_left_out() -> None:
    # The paper numbers nine.
    assert {f"Eq. {n}" for n in range(1, 10)} <= {e.where for e in MADE["ENTRIES"]}


def test_citations_are_found() -> None:
    assert cited("see Eq. 6-8 and (Sec. 2.1 and 3.4)") == {
        "Eq. 6",
        "Eq. 7",
        "Eq. 8",
        "Sec. 2.1",
        "Sec. 3.4",
    }
