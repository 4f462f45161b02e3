"""The researcher watches a trial again."""

from __future__ import annotations

import re

import pytest

from coadapt.study.session.events import Stepped
from tests.study.browser.conftest import Visitor
from tests.study.browser.inspector import Inspector
from tests.study.browser.person import (
    at_stage,
    choose,
    go_on,
    key_of,
    picture,
)
from tests.study.browser.serving import Serving


def test_the_replay(waiting: Serving, visitor: Visitor) -> None:
    participant = visitor()
    participant.goto(waiting.to_practice())
    participant.wait_for_selector("text=Push in any direction")
    for key in ("ArrowLeft", "ArrowLeft", "ArrowLeft", "ArrowUp", "ArrowUp", "ArrowUp"):
        if participant.locator(".over").count() == 0:
            participant.keyboard.press(key)
    participant.wait_for_selector(".over button:focus")
    participant.keyboard.press("Enter")
    at_stage(participant, "choice 1")
    choose(participant, "goal", 0)
    go_on(participant)
    at_stage(participant, "briefing 1")
    go_on(participant)
    at_stage(participant, "trial 1")
    participant.wait_for_selector("text=Push in any direction")
    for _ in range(20):
        if participant.locator(".over").count():
            break
        participant.keyboard.press("ArrowUp")
        participant.wait_for_timeout(50)
    participant.wait_for_selector(".over button:focus")
    participant.keyboard.press("Enter")
    at_stage(participant, "debrief 1")
    events = waiting.events(key_of(participant))
    steps = [event for event in events if isinstance(event, Stepped) and event.belief is not None]

    page = visitor(bypass_csp=True)
    inspector = Inspector(page)
    page.goto(waiting.admin_link())
    page.wait_for_selector("h1")
    inspector.look("dashboard")
    picture(page, "dashboard")
    page.goto(f"{waiting.address}/admin/sessions/{waiting.number(key_of(participant))}")
    page.get_by_role("heading", name="Session").wait_for()
    inspector.look("a session")
    picture(page, "session")
    page.get_by_role("link", name="Watch trial").click()
    told = page.locator("#replay [role=status]")
    told.wait_for()
    assert told.inner_text() == f"Before the first of {len(steps)} steps."
    # What the robot believes would tell the condition: it is not even sent.
    assert page.locator("#replay figure").count() == 0
    inspector.look("a replay")
    page.get_by_role("button", name="Play").click()
    last = f"Step {len(steps)} of {len(steps)}"
    page.wait_for_function(
        "last => document.querySelector('#replay [role=status]').textContent.startsWith(last)",
        arg=last,
    )
    picture(page, "replay")

    # Unblinded, the researcher sees what it believed before each decision.
    watched = page.url
    page.goto(f"{waiting.address}/admin")
    page.get_by_label("I want to know").check()
    page.get_by_role("button", name="Unblind").click()
    page.get_by_role("button", name="Hide again").wait_for()
    page.goto(watched)
    slider = page.get_by_role("slider", name="Step")
    slider.press("ArrowRight")
    slider.press("ArrowRight")
    assert told.inner_text().startswith(f"Step 2 of {len(steps)}")
    belief = steps[1].belief
    assert belief is not None
    texts = page.locator("#replay figure text").all_text_contents()
    shown = [float(text) for text in texts if re.fullmatch(r"[01]\.[0-9]{3}", text)]
    expected = [sum(row) for row in belief] + [sum(row[m] for row in belief) for m in range(2)]
    assert shown == pytest.approx(expected, abs=6e-4)
    inspector.look("a replay with beliefs")
    picture(page, "replay beliefs")
    assert inspector.problems == []
