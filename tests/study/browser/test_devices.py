"""Participants with other devices: an unknown gamepad, one switch, a finger."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page

from coadapt.study.session.events import Checked, Noted, Pressed
from tests.study.browser.conftest import Visitor
from tests.study.browser.person import (
    aside,
    at_stage,
    choose,
    go_on,
    key_of,
    picture,
    steer_ahead,
    steer_left,
    tab_to,
)
from tests.study.browser.serving import Serving

PAD = """
window.pad = {
    id: "Test stick (Vendor: 0001)", index: 0, connected: true, mapping: "", timestamp: 0,
    axes: [0, 0, 1.2857], buttons: Array.from({length: 4}, () => ({pressed: false, value: 0})),
};
Navigator.prototype.getGamepads = () => [window.pad, null, null, null];
window.push = value => { window.pad.axes[2] = value; window.pad.timestamp = performance.now(); };
addEventListener("load", () => dispatchEvent(new Event("gamepadconnected")));
"""
"""A pad without a known mapping, whose cross is one axis: -1 is forward, and so on clockwise."""

HAT = {"forward": -1.0, "right": -0.4286, "left": 0.7143, None: 1.2857}


def push(page: Page, way: str | None) -> None:
    """Push the cross of the faked pad, or let go of it."""
    page.evaluate("value => push(value)", HAT[way])


def tap(page: Page, way: str) -> None:
    """Push and let go, as soon as the page has seen it."""
    push(page, way)
    page.wait_for_selector(f'.pad button.held[aria-label="{way}"]')
    push(page, None)
    page.wait_for_selector(".pad button.held", state="detached")


def to_practice_by_gamepad(page: Page, serving: Serving) -> None:
    """From the link to the first training session, the pad calibrated on the way."""
    page.goto(serving.address)
    go_on(page)
    at_stage(page, "preflight 1")
    choose(page, "device", 1)
    for way in ("left", "right", "forward"):
        page.wait_for_selector(f"text=Push the stick or the cross {way}")
        picture(page, "preflight 1 calibration")
        push(page, way)
        page.wait_for_selector(f"text=Push the stick or the cross {way}", state="detached")
        push(page, None)
    page.wait_for_selector("text=Your gamepad is known now")
    for way in ("left", "forward", "right"):
        tap(page, way)
    page.wait_for_selector("#check-device.good")
    page.wait_for_selector("#check-connection.good")
    go_on(page)
    at_stage(page, "consent 1")
    go_on(page, "I agree to take part")
    at_stage(page, "instructions 1")
    go_on(page)
    at_stage(page, "practice 1")


def test_a_gamepad_of_unknown_layout(waiting: Serving, visitor: Visitor) -> None:
    page = visitor(PAD)
    to_practice_by_gamepad(page, waiting)
    page.wait_for_selector("text=Push in any direction")
    for way in ("left", "left", "left", "forward", "forward", "forward"):
        if page.locator(".over").count():
            break
        tap(page, way)
    page.wait_for_selector(".over button:focus")

    events = waiting.events(key_of(page))
    checked = next(event for event in events if isinstance(event, Checked))
    assert (checked.device, checked.pad) == ("gamepad", "Test stick (Vendor: 0001)")
    pressed = [event for event in events if isinstance(event, Pressed)]
    assert {event.device for event in pressed} == {"gamepad"}
    # The pad's own clock is that of the page, and it knew first.
    assert all(
        event.device_time is not None and 0 < event.device_time <= event.page_time
        for event in pressed
    )
    assert [event.sequence for event in pressed] == list(range(len(pressed)))


def test_a_gamepad_from_the_link_to_the_debrief(serving: Serving, visitor: Visitor) -> None:
    page = visitor(PAD)
    to_practice_by_gamepad(page, serving)

    def hold(way: str) -> None:
        push(page, way)

    def let_go(_: str) -> None:
        push(page, None)

    for number in (1, 2):
        at_stage(page, f"practice {number}")
        steer_left(page, hold, let_go)
        go_on(page)
    at_stage(page, "choice 1")
    choose(page, "goal", 0)
    go_on(page)
    at_stage(page, "briefing 1")
    go_on(page)
    for number in (1, 2, 3):
        at_stage(page, f"trial {number}")
        steer_ahead(page, hold, let_go)
        go_on(page)
    for number, scale in enumerate(serving.study.scales, start=1):
        at_stage(page, f"scale {number}")
        for item in scale.items:
            choose(page, item.name, 3)
        go_on(page)
    at_stage(page, "questions 1")
    go_on(page)
    at_stage(page, "debrief 1")

    key = key_of(page)
    session = serving.session(key)
    assert (session.end, session.device) == ("finished", "gamepad")
    assert [result.goal for result in session.results] == [1, 1, 1]
    pressed = [event for event in serving.events(key) if isinstance(event, Pressed)]
    assert {event.device for event in pressed} == {"gamepad"}


def test_one_switch(serving: Serving, visitor: Visitor) -> None:
    page = visitor(reduced_motion="reduce")

    def hold(way: str) -> None:
        # Just as it lights up, so that there is time to press.
        page.wait_for_selector(f'.pad button:not(.scanned)[aria-label="{way}"]')
        page.wait_for_selector(f'.pad button.scanned[aria-label="{way}"]')
        page.keyboard.down("Space")
        page.wait_for_selector(f'.pad button.held[aria-label="{way}"]')

    def let_go(_: str) -> None:
        page.keyboard.up("Space")

    page.goto(serving.address)
    go_on(page)
    at_stage(page, "preflight 1")
    choose(page, "device", 3)
    tab_to(page, page.locator("#settings summary"))
    page.keyboard.press("Enter")
    tab_to(page, page.locator("#scan-seconds"))
    for _ in range(4):
        page.keyboard.press("ArrowLeft")
    page.locator(".box").focus()
    for way in ("left", "forward", "right"):
        hold(way)
        let_go(way)
    page.wait_for_selector("#check-device.good")
    page.wait_for_selector("#check-connection.good")
    picture(page, "preflight 1 switch")
    go_on(page)
    at_stage(page, "consent 1")
    go_on(page, "I agree to take part")
    at_stage(page, "instructions 1")
    go_on(page)
    at_stage(page, "practice 1")
    steer_left(page, hold, let_go)
    # What goes on has the focus: the same switch presses it.
    page.wait_for_selector(".over button:focus")
    page.keyboard.press("Space")
    at_stage(page, "practice 2")
    events = serving.events(key_of(page))
    pressed = [event for event in events if isinstance(event, Pressed)]
    assert {event.device for event in pressed} == {"switch"}
    assert [event.input for event in pressed if event.input is not None] == [0, 1]
    settings = next(e.text for e in events if isinstance(e, Noted) and e.what == "settings")
    assert '"scanSeconds":0.8' in settings


def test_a_finger_on_a_phone(serving: Serving, visitor: Visitor) -> None:
    phone = {"width": 375, "height": 720}
    page = visitor(viewport=phone, has_touch=True, is_mobile=True)

    def hold(way: str) -> None:
        button = page.locator(f'.pad button[aria-label="{way}"]')
        box = button.bounding_box()
        assert box
        assert min(box["width"], box["height"]) >= 44  # WCAG 2.2, 2.5.5
        page.mouse.move(box["x"] + 20, box["y"] + 20)
        page.mouse.down()
        # A finger slips off: the button is still held.
        page.mouse.move(5, 5)

    def let_go(_: str) -> None:
        page.mouse.up()

    page.goto(serving.address)
    at_stage(page, "welcome 1")
    page.get_by_role("button", name="Continue").tap()
    at_stage(page, "preflight 1")
    page.get_by_label("Touch screen or mouse").tap()
    for way in ("left", "forward", "right"):
        page.locator(f'.pad button[aria-label="{way}"]').tap()
    page.wait_for_selector("#check-device.good")
    page.wait_for_selector("#check-connection.good")
    picture(page, "preflight 1 tried")
    page.get_by_role("button", name="Continue").tap()
    at_stage(page, "consent 1")
    page.get_by_role("button", name="I agree").tap()
    at_stage(page, "instructions 1")
    page.get_by_role("button", name="Continue").tap()
    for number in (1, 2):
        at_stage(page, f"practice {number}")
        steer_left(page, hold, let_go)
        picture(page, f"practice {number} over")
        page.get_by_role("button", name="Continue").tap()
    at_stage(page, "choice 1")
    page.get_by_label("Left").tap()
    page.get_by_role("button", name="Continue").tap()
    at_stage(page, "briefing 1")
    page.get_by_role("button", name="Continue").tap()
    at_stage(page, "trial 1")
    steer_ahead(page, hold, let_go)
    page.get_by_role("button", name="Continue").tap()
    at_stage(page, "trial 2")
    session = serving.session(key_of(page))
    assert (session.device, len(session.results)) == ("touch", 1)
    events = serving.events(key_of(page))
    assert {event.device for event in events if isinstance(event, Pressed)} == {"touch"}


@pytest.mark.parametrize("motion", ["reduce", "no-preference"])
def test_motion(waiting: Serving, visitor: Visitor, motion: str) -> None:
    page = visitor(reduced_motion=motion)
    page.goto(waiting.to_practice())
    page.wait_for_selector("text=Push in any direction")
    page.evaluate(
        """() => {
            const hand = document.querySelector(".gripper");
            window.drawn = [];
            new MutationObserver(() => window.drawn.push(hand.getAttribute("transform")))
                .observe(hand, { attributes: true });
        }"""
    )
    before = aside(page)
    page.keyboard.press("ArrowLeft")
    page.wait_for_function(
        "before => !document.querySelector('.stage svg').ariaLabel.includes(before)", arg=before
    )
    page.wait_for_timeout(700)
    drawn = page.evaluate("window.drawn")
    # A step of half a second: one jump, or many places on the way.
    assert (len(drawn) == 1) == (motion == "reduce")
    assert len(drawn) >= 1
