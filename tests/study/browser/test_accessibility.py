"""Every page before axe, the checker of accessibility, with large text and on narrow screens."""

from __future__ import annotations

from tests.study.browser.conftest import Visitor
from tests.study.browser.inspector import Inspector
from tests.study.browser.person import at_stage, by_keyboard, choose, go_on, steer_ahead, steer_left
from tests.study.browser.serving import Serving


def test_no_page_has_a_serious_violation(serving: Serving, visitor: Visitor) -> None:
    # The checker is no part of the pages: their policy is set aside for it.
    page = visitor(bypass_csp=True)
    inspector = Inspector(page)
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
        if number == 1:
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
        if number == 1:
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
    assert inspector.looks == 21


def test_the_checker_finds_what_is_wrong(serving: Serving, visitor: Visitor) -> None:
    page = visitor(bypass_csp=True)
    page.goto(serving.address)
    page.evaluate(
        "() => document.querySelector('main').insertAdjacentHTML('beforeend',"
        ' \'<img src="/static/icon.svg"><p class="faint">faint</p>\')'
    )
    page.add_style_tag(content=".faint { color: #ccc; width: 200vw; }")
    inspector = Inspector(page)
    inspector.look("spoiled")
    text = "\n".join(inspector.problems)
    assert "image-alt" in text
    assert "color-contrast" in text
    assert "too wide" in text
