"""Every page before axe, the checker of accessibility, with large text and on narrow screens."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from playwright.sync_api import Page

from tests.study.browser.conftest import DESKTOP, Visitor
from tests.study.browser.person import at_stage, by_keyboard, choose, go_on, steer_ahead, steer_left
from tests.study.browser.serving import Serving

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


@pytest.fixture(scope="module")
def axe() -> str:
    """The checker's program, from npm."""
    if not AXE.exists():
        bundle = [sys.executable, str(FRONTEND / "bundle.py"), "--check"]
        subprocess.run(bundle, check=True)
    return AXE.read_text(encoding="utf-8")


class Inspector:
    """Looks at pages and collects what is wrong with them."""

    def __init__(self, page: Page, axe: str) -> None:
        self.page = page
        self.problems: list[str] = []
        self.looks = 0
        self._axe = axe

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


def test_no_page_has_a_serious_violation(serving: Serving, visitor: Visitor, axe: str) -> None:
    # The checker is no part of the pages: their policy is set aside for it.
    page = visitor(bypass_csp=True)
    inspector = Inspector(page, axe)
    hold, let_go = by_keyboard(page)
    page.goto(serving.address)
    inspector.stage("welcome 1")
    page.locator(".withdraw summary").click()
    inspector.look("welcome 1, withdrawing")
    go_on(page)
    for device in (3, 2, 1, 0):
        at_stage(page, "preflight 1")
        page.locator('input[name="device"]').nth(device).check()
        if page.locator("#settings").is_visible():
            page.locator("#settings summary").click()
        inspector.look(f"preflight 1, device {device}")
    page.get_by_role("button", name="Continue").click()
    page.wait_for_selector("#not-yet:visible")
    inspector.look("preflight 1 with a problem")
    page.locator(".box").focus()
    for key in ("ArrowLeft", "ArrowUp", "ArrowRight"):
        page.keyboard.press(key)
    page.wait_for_selector("#check-connection.good")
    go_on(page)
    inspector.stage("consent 1")
    go_on(page, "I agree to take part")
    inspector.stage("instructions 1")
    go_on(page)
    for number in (1, 2):
        at_stage(page, f"practice {number}")
        page.wait_for_selector("text=Push in any direction")
        inspector.look(f"practice {number}")
        steer_left(page, hold, let_go)
        page.get_by_role("button", name="Continue").click()
    inspector.stage("choice 1")
    go_on(page)
    page.wait_for_selector(".problem")
    inspector.look("choice 1 with a problem")
    choose(page, "goal", 0)
    go_on(page)
    inspector.stage("briefing 1")
    go_on(page)
    for number in (1, 2, 3):
        at_stage(page, f"trial {number}")
        steer_ahead(page, hold, let_go)
        inspector.look(f"trial {number}, over")
        page.get_by_role("button", name="Continue").click()
    for number, scale in enumerate(serving.study.scales, start=1):
        inspector.stage(f"scale {number}")
        go_on(page)
        page.wait_for_selector(".problem")
        inspector.look(f"scale {number} with a problem")
        for item in scale.items:
            page.locator(f'input[name="{item.name}"]').first.check()
        go_on(page)
    inspector.stage("questions 1")
    go_on(page)
    inspector.stage("debrief 1")
    page.goto(f"{serving.address}/nothing")
    inspector.look("an error")
    assert inspector.problems == []
    assert inspector.looks == 24


def test_the_checker_finds_what_is_wrong(serving: Serving, visitor: Visitor, axe: str) -> None:
    page = visitor(bypass_csp=True)
    page.goto(serving.address)
    page.evaluate(
        "() => document.querySelector('main').insertAdjacentHTML('beforeend',"
        ' \'<img src="/static/icon.svg"><p class="faint">faint</p>\')'
    )
    page.add_style_tag(content=".faint { color: #ccc; width: 200vw; }")
    inspector = Inspector(page, axe)
    inspector.look("spoiled")
    text = "\n".join(inspector.problems)
    assert "image-alt" in text
    assert "color-contrast" in text
    assert "too wide" in text
