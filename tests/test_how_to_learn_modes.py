"""The page on learning modes from demonstrations shows what happens."""

from __future__ import annotations

import re
from pathlib import Path
from textwrap import dedent
from typing import Any

import numpy as np
import pytest

PAGE = Path(__file__).parents[1] / "docs" / "how-to" / "learn-modes-from-demonstrations.md"


def blocks(kind: str) -> list[str]:
    """The blocks of one kind, in order."""
    fences = re.findall(
        r"^( *)```(\w*)\n(.*?)^\1```$", PAGE.read_text("utf-8"), re.DOTALL | re.MULTILINE
    )
    return [dedent(text) for _, label, text in fences if label == kind]


def test_the_page_prints_what_it_shows(capsys: pytest.CaptureFixture[str]) -> None:
    names: dict[str, Any] = {}
    exec(compile("".join(blocks("python")), PAGE.name, "exec"), names)
    assert capsys.readouterr().out == "".join(blocks(""))
    # The model of the last block has the fitted costs.
    policies = names["model"].modal_policies
    np.testing.assert_allclose(policies.sum(axis=2), 1.0, atol=1e-12)
