"""Looking at pages with axe, the checker of accessibility rules."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from playwright.sync_api import Page

from tests.study.browser.conftest import DESKTOP
from tests.study.browser.person import at_stage

FRONTEND = Path(__file__).parents[3] / "frontend"
AXE = FRONTEND / "node_modules" / "axe-core" / "axe.min.js"

PHONE = {"width": 375, "height": 720}

NARROWEST = {"width": 320, "height": 640}
"""A window of 1280 pixels at 400 %: nothing has to be scrolled sideways (WCAG 1.4.10)."""

RULES = """async () => {
    const found = await axe.run(document, { resultTypes: ["violations"] });
    return found.violations.map(v =>
        `${v.impact} ${v.id}: ${v.nodes.map(n => n.target.join(" ")).join(", ")}`);
}"""

SERIOUS = ("serious", "critical")

WIDEST = "() => document.documentElement.scrollWidth - innerWidth"

DOUBLE = "html { font-size: 212.5% !important; }"
"""Twice the size of our text."""


def axe() -> str:
    """The checker's program, from npm."""
    if not AXE.exists():
        bundle = [sys.executable, str(FRONTEND / "bundle.py"), "--check"]
        subprocess.run(bundle, check=True)
    return AXE.read_text(encoding="utf-8")


class Inspector:
    """Looks at pages and collects what is wrong with them."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.problems: list[str] = []
        self.looks = 0
        self._axe = axe()

    def look(self, name: str) -> None:
        """Look at the page as it is, on a desktop and on a phone, and with double text."""
        page = self.page
        page.evaluate(self._axe)
        for size in (DESKTOP, PHONE):
            page.set_viewport_size(size)
            self._note(name, f"{size['width']}", page.evaluate(RULES))
        page.set_viewport_size(NARROWEST)
        self._note_width(name, "narrow")
        page.set_viewport_size(DESKTOP)
        style = page.add_style_tag(content=DOUBLE)
        self._note_width(name, "double text")
        style.evaluate("element => element.remove()")
        self.looks += 1

    def stage(self, stage: str) -> None:
        """Look at the page of ``stage``."""
        at_stage(self.page, stage)
        self.look(stage)

    def _note(self, name: str, how: str, found: list[str]) -> None:
        self.problems += [f"{name} {how}: {p}" for p in found if p.startswith(SERIOUS)]

    def _note_width(self, name: str, how: str) -> None:
        wider = self.page.evaluate(WIDEST)
        self.problems += [f"{name} {how}: {wider} pixels too wide"] if wider > 0 else []
