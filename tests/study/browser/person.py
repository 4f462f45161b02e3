"""What simulated people do with a page."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Locator, Page

MOST_TABS = 60
"""Presses of Tab within which everything on a page is reached."""

SCREENSHOTS = os.environ.get("COADAPT_SCREENSHOTS")
"""A folder for pictures of all pages, if they are wanted."""

FOCUSED = "element => element === document.activeElement"


def at_stage(page: Page, stage: str) -> None:
    """Wait until the page of ``stage`` is there; keep a picture of it if wanted."""
    page.wait_for_selector(f'body[data-stage="{stage}"]')
    picture(page, stage)


def picture(page: Page, name: str) -> None:
    """Keep a picture of ``page``, if pictures are wanted."""
    if SCREENSHOTS:
        folder = Path(SCREENSHOTS)
        folder.mkdir(parents=True, exist_ok=True)
        size = page.viewport_size
        width = size["width"] if size else 0
        page.screenshot(path=folder / f"{name.replace(' ', '-')}-{width}.png", full_page=True)


def tab_to(page: Page, wanted: Locator) -> None:
    """Press Tab until ``wanted`` has the focus, which has to be seen."""
    for _ in range(MOST_TABS):
        if wanted.evaluate(FOCUSED):
            break
        page.keyboard.press("Tab")
    else:
        raise AssertionError(f"Tab does not lead to {wanted}")
    # A choice is outlined as a whole, not its little circle alone.
    ring = wanted.evaluate(
        "e => getComputedStyle(e.type === 'radio' ? e.closest('label') : e).outlineStyle"
    )
    assert ring == "solid", f"the focus on {wanted} is not seen"


def choose(page: Page, name: str, number: int) -> None:
    """Choose the ``number``-th answer, from 0, of radio buttons by the keyboard alone."""
    radios = page.locator(f'input[name="{name}"]')
    tab_to(page, radios.first)
    page.keyboard.press("Space")
    for _ in range(number):
        page.keyboard.press("ArrowDown")
    assert radios.nth(number).is_checked()


def go_on(page: Page, label: str = "Continue") -> None:
    """Reach a button by Tab and press Enter."""
    tab_to(page, page.get_by_role("button", name=label))
    page.keyboard.press("Enter")


def key_of(page: Page) -> str:
    """The key of the session that ``page`` shows."""
    found = re.search(r"/s/([^/?]+)", page.url)
    assert found
    return found[1]


def aside(page: Page) -> str:
    """How far it is to the left goal, in the words of the drawing: "2 left, 3 forward"."""
    label = page.locator(".stage svg").get_attribute("aria-label") or ""
    return label.partition("left: ")[2].partition(";")[0]


def steer_left(page: Page, hold: Callable[[str], object], let_go: Callable[[str], object]) -> None:
    """Steer the hand to the left goal, with whatever ``hold`` and ``let_go`` do."""
    page.wait_for_selector("text=Push in any direction")
    hold("left")
    page.wait_for_function(
        "() => !/left: \\d+ left/.test(document.querySelector('.stage svg').ariaLabel)"
    )
    let_go("left")
    hold("forward")
    page.wait_for_selector(".over")
    let_go("forward")


def steer_ahead(page: Page, hold: Callable[[str], object], let_go: Callable[[str], object]) -> None:
    """Hold "forward" until the trial is over: a robot that does not adapt goes its own way."""
    page.wait_for_selector("text=Push in any direction")
    hold("forward")
    page.wait_for_selector(".over")
    let_go("forward")


KEYS = {"left": "ArrowLeft", "forward": "ArrowUp", "right": "ArrowRight"}


def by_keyboard(page: Page) -> tuple[Callable[[str], None], Callable[[str], None]]:
    """Holding and letting go of the arrow keys."""
    return lambda way: page.keyboard.down(KEYS[way]), lambda way: page.keyboard.up(KEYS[way])


def try_keys(page: Page) -> None:
    """Pass the preflight with a keyboard."""
    choose(page, "device", 0)
    tab_to(page, page.locator(".box"))
    for key in KEYS.values():
        page.keyboard.press(key)
    page.wait_for_selector("#check-connection.good")
    page.wait_for_selector("#check-device.good")
