"""From the link to the debrief by the keyboard alone, with everything that can come between."""

from __future__ import annotations

from itertools import groupby

from playwright.sync_api import Page

from coadapt.study.session.events import Answered, Began, Checked, Opened, Pressed, Stepped
from tests.study.browser.conftest import Visitor
from tests.study.browser.person import (
    at_stage,
    by_keyboard,
    choose,
    go_on,
    key_of,
    picture,
    steer_ahead,
    steer_left,
    tab_to,
    try_keys,
)
from tests.study.browser.serving import Serving


def onward(page: Page) -> None:
    """At the end of a training session or trial the button to go on has the focus."""
    page.wait_for_selector(".over button:focus")
    page.keyboard.press("Enter")


def test_from_the_link_to_the_debrief(serving: Serving, visitor: Visitor) -> None:
    page = visitor()
    hold, let_go = by_keyboard(page)
    page.goto(f"{serving.address}/?PROLIFIC_PID=keys&STUDY_ID=s&SESSION_ID=t&other=1")
    at_stage(page, "welcome 1")
    go_on(page)
    at_stage(page, "preflight 1")
    try_keys(page)
    picture(page, "preflight 1 tried")
    go_on(page)
    at_stage(page, "consent 1")
    go_on(page, "I agree to take part")
    at_stage(page, "instructions 1")
    go_on(page)
    for number in (1, 2):
        at_stage(page, f"practice {number}")
        steer_left(page, hold, let_go)
        onward(page)
    at_stage(page, "choice 1")
    choose(page, "goal", 0)
    go_on(page)
    at_stage(page, "briefing 1")
    go_on(page)
    for number in (1, 2, 3):
        at_stage(page, f"trial {number}")
        steer_ahead(page, hold, let_go)
        picture(page, f"trial {number} over")
        onward(page)

    # A forgotten answer: the page says where, has the focus there and keeps the other one.
    at_stage(page, "scale 1")
    choose(page, "trust_right_thing", 3)
    go_on(page)
    page.wait_for_selector(".problem")
    picture(page, "scale 1 problem")
    assert page.locator('input[name="trust_right_thing"][value="4"]').is_checked()
    missing = page.locator('input[name="trust_trustworthy"]').first
    assert missing.evaluate("element => element === document.activeElement")
    described = page.locator("fieldset.wrong").get_attribute("aria-describedby")
    assert page.locator(f"#{described}").inner_text() == "Please choose one of the answers."
    choose(page, "trust_trustworthy", 1)
    go_on(page)

    # An answered page stays answered, whatever the browser's own buttons are used for.
    at_stage(page, "scale 2")
    page.reload()
    at_stage(page, "scale 2")
    page.go_back()
    at_stage(page, "scale 2")
    scale = serving.study.scales[1]
    for item in scale.items:
        choose(page, item.name, 2)
    go_on(page)
    at_stage(page, "questions 1")
    tab_to(page, page.locator("textarea").first)
    page.keyboard.type("It went well – mostly.")
    page.reload()
    go_on(page)
    at_stage(page, "debrief 1")
    back = page.get_by_role("link", name="Finish")
    tab_to(page, back)
    assert back.get_attribute("href") == "https://recruitment.example/done"
    assert not page.get_by_text("Withdraw").count()

    key = key_of(page)
    session, events = serving.session(key), serving.events(key)
    assert session.end == "finished"
    assert session.device == "keyboard"
    assert [result.goal for result in session.results] == [1, 1, 1]
    assert session.answers["trust_right_thing"] == 4
    assert session.answers["trust_trustworthy"] == 2
    assert "It went well – mostly." in session.answers.values()
    opened = next(event for event in events if isinstance(event, Opened))
    assert opened.parameters == {"PROLIFIC_PID": "keys", "STUDY_ID": "s", "SESSION_ID": "t"}
    checked = next(event for event in events if isinstance(event, Checked))
    assert (checked.width, checked.height) == (1280, 800)
    assert 0 < checked.latency < 5
    assert "Chrom" in checked.browser
    pressed = [event for event in events if isinstance(event, Pressed)]
    assert {event.device for event in pressed} == {"keyboard"}
    assert len([event for event in events if isinstance(event, Answered)]) == 3

    # By the same link, in another browser, the same person finds what they left.
    again = visitor()
    again.goto(f"{serving.address}/?PROLIFIC_PID=keys")
    at_stage(again, "debrief 1")


def test_a_page_that_is_loaded_again_begins_its_trial_again(
    serving: Serving, visitor: Visitor
) -> None:
    page = visitor()
    hold, let_go = by_keyboard(page)
    page.goto(serving.to_practice())
    page.wait_for_selector("text=Push in any direction")
    hold("left")
    page.wait_for_selector(".banner", state="hidden")
    page.reload()
    page.wait_for_selector("text=This begins again")
    # The key is still held down: it counts once it has been let go of.
    let_go("left")
    steer_left(page, hold, let_go)
    onward(page)
    at_stage(page, "practice 2")
    page.wait_for_selector("text=Push in any direction")
    events = serving.events(key_of(page))
    began = [event for event in events if isinstance(event, Began)]
    assert [(event.stage.number, event.attempt) for event in began] == [(1, 1), (1, 2), (2, 1)]


def test_a_server_that_comes_back_is_found_again(serving: Serving, visitor: Visitor) -> None:
    page = visitor()
    hold, let_go = by_keyboard(page)
    page.goto(serving.to_practice())
    page.wait_for_selector("text=Push in any direction")
    hold("forward")
    page.wait_for_selector(".banner", state="hidden")
    before = len(serving.events(key_of(page)))
    serving.stop()
    page.wait_for_selector("text=The connection is lost")
    picture(page, "practice 1 lost")
    let_go("forward")
    serving.start()
    page.wait_for_selector("text=This begins again")
    steer_left(page, hold, let_go)
    onward(page)
    at_stage(page, "practice 2")
    page.wait_for_selector("text=Push in any direction")
    events = serving.events(key_of(page))
    assert len(events) > before
    assert [event.attempt for event in events if isinstance(event, Began)] == [1, 2, 1]


def test_a_tap_between_two_decisions_counts(serving: Serving, visitor: Visitor) -> None:
    page = visitor()
    page.goto(serving.to_practice())
    page.wait_for_selector("text=Push in any direction")
    for key in ("ArrowLeft", "ArrowUp"):
        page.keyboard.press(key, delay=1)
        steps = "() => document.querySelector('.pad .held') === null"
        page.wait_for_function(steps)
    page.wait_for_timeout(400)
    events = serving.events(key_of(page))
    given = [event.input for event in events if isinstance(event, Stepped)]
    # On a busy machine the message that a key was let go of may miss a strike of the clock.
    assert [i for i, _ in groupby(given) if i is not None] == [0, 1]


def test_withdrawing_and_declining(serving: Serving, visitor: Visitor) -> None:
    page = visitor()
    page.goto(serving.to_practice())
    page.wait_for_selector("text=Push in any direction")
    tab_to(page, page.locator(".withdraw summary"))
    page.keyboard.press("Enter")
    go_on(page, "Withdraw and end my session")
    page.get_by_role("heading", name="You have withdrawn").wait_for()
    picture(page, "withdrawn")
    assert serving.session(key_of(page)).end == "withdrawn"
    page.goto(page.url)
    page.get_by_role("heading", name="You have withdrawn").wait_for()

    other = visitor()
    other.goto(serving.address)
    go_on(other)
    at_stage(other, "preflight 1")
    try_keys(other)
    go_on(other)
    at_stage(other, "consent 1")
    go_on(other, "I do not want to take part")
    other.get_by_role("heading", name="You are not taking part").wait_for()
    picture(other, "declined")
    assert serving.session(key_of(other)).end == "declined"
