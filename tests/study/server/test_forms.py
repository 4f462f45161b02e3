"""Forms: whatever is posted is either an event that can happen now or a refusal that says why."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.study.server.forms import CHOOSE, WRITE, Refusal, clean, read_form
from coadapt.study.session import Session, Stage, advance, plan_of
from coadapt.study.session.events import (
    Answered,
    Checked,
    Chose,
    Consented,
    Declined,
    Event,
    Read,
    decode_event,
    encode_event,
)
from coadapt.study.session.machine import LONGEST_ANSWER
from tests.study.server.pages_of import all_standings, asked_study, standing

CHECKED = {
    "device": "gamepad",
    "width": "1280",
    "height": "720",
    "latency": "0.0123",
    "browser": "Some browser",
    "pad": "Some pad",
}

QUESTIONS = {"why_changed": "", "comments": "", "hand": "2", "games": "", "how": "Fine"}


def read(stage: Stage, *, changed: bool = False, **fields: str) -> tuple[Event, ...] | Refusal:
    session = standing(stage, changed=changed)
    return read_form(asked_study(), session, {"stage": str(stage), **fields})


def test_pages_that_are_read() -> None:
    for kind in ("welcome", "instructions", "briefing", "debrief"):
        assert read(Stage(kind)) == (Read(stage=Stage(kind)),)


def test_consent() -> None:
    assert read(Stage("consent"), consent="yes") == (Consented(),)
    assert read(Stage("consent"), consent="no") == (Declined(),)
    for given_ in ({}, {"consent": "maybe"}):
        refusal = read(Stage("consent"), **given_)
        assert isinstance(refusal, Refusal)
        assert set(refusal.problems) == {"consent"}


def test_the_preflight() -> None:
    (event,) = events(read(Stage("preflight"), **CHECKED))
    assert event == Checked(
        device="gamepad",
        width=1280,
        height=720,
        latency=0.0123,
        browser="Some browser",
        pad="Some pad",
    )


@pytest.mark.parametrize(
    ("field", "value", "problem"),
    [
        ("device", "mind", "device"),
        ("device", "", "device"),
        ("width", "0", "checks"),
        ("height", "1e9", "checks"),
        ("latency", "nan", "checks"),
        ("latency", "inf", "checks"),
        ("latency", "-1", "checks"),
        ("latency", "", "checks"),
    ],
)
def test_checks_that_are_not_complete(field: str, value: str, problem: str) -> None:
    refusal = read(Stage("preflight"), **{**CHECKED, field: value})
    assert isinstance(refusal, Refusal)
    assert set(refusal.problems) == {problem}


def test_long_names_of_browsers_are_cut() -> None:
    (event,) = events(read(Stage("preflight"), **{**CHECKED, "browser": "b" * 2000}))
    assert isinstance(event, Checked)
    assert event.browser == "b" * 500


def test_the_choice() -> None:
    assert read(Stage("choice"), goal="1") == (Chose(goal=1),)
    assert isinstance(read(Stage("choice"), goal="2"), Refusal)
    chosen = advance(asked_study(), standing(Stage("choice")), Chose(goal=0))
    assert read_form(asked_study(), chosen, {"stage": "choice 1", "goal": "1"}) == ()


def test_a_scale() -> None:
    given_ = {"trust_right_thing": "4", "trust_trustworthy": "1"}
    answers = {"trust_right_thing": 4, "trust_trustworthy": 1}
    assert read(Stage("scale"), **given_) == (Answered(stage=Stage("scale"), answers=answers),)
    for wrong in ("0", "6", "", "4.0", "٣", " 4"):
        refusal = read(Stage("scale"), **{**given_, "trust_trustworthy": wrong})
        assert isinstance(refusal, Refusal)
        assert refusal.problems == {"trust_trustworthy": CHOOSE}
        assert refusal.given["trust_right_thing"] == "4"


def test_questions() -> None:
    (event,) = events(read(Stage("questions"), changed=True, **QUESTIONS))
    assert isinstance(event, Answered)
    expected = {"why_changed": None, "comments": None, "hand": 2, "games": None, "how": "Fine"}
    assert event.answers == expected


def test_questions_that_are_not_for_all() -> None:
    (event,) = events(read(Stage("questions"), **QUESTIONS))
    assert isinstance(event, Answered)
    assert "why_changed" not in event.answers


def test_missing_answers_and_long_ones() -> None:
    long = "x" * (LONGEST_ANSWER + 1)
    refusal = read(Stage("questions"), comments=long, hand="", games="3", how=" \n")
    assert isinstance(refusal, Refusal)
    assert "10,001" in refusal.problems["comments"]
    assert refusal.problems["hand"] == CHOOSE
    assert refusal.problems["games"] == CHOOSE
    assert refusal.problems["how"] == WRITE


def test_late_and_repeated_forms_say_nothing() -> None:
    for session in all_standings():
        now = plan_of(asked_study())[session.position]
        for stage in (*plan_of(asked_study()), "", "trial", "practice 0"):
            if stage != now:
                assert read_form(asked_study(), session, {"stage": f"{stage}"}) == ()


def test_nothing_is_taken_from_those_who_have_left() -> None:
    for end in ("declined", "withdrawn", "excluded"):
        session = Session(opened=True, position=0, end=end)
        assert read_form(asked_study(), session, {"stage": "welcome 1"}) == ()


STANDINGS = tuple(all_standings())

VALUES = st.one_of(st.sampled_from(["yes", "0", "1", "5", "keyboard", "0.5", ""]), st.text())

FIELDS = st.sampled_from(
    [*CHECKED, *QUESTIONS, "goal", "consent", "trust_right_thing", "trust_trustworthy", "csrf"]
)


@given(form=st.dictionaries(st.one_of(FIELDS, st.text()), VALUES), where=st.integers(0, 100))
def test_any_form_is_an_event_that_fits_or_a_refusal(form: dict[str, str], where: int) -> None:
    study, session = asked_study(), STANDINGS[where % len(STANDINGS)]
    stage = plan_of(study)[session.position]
    found = read_form(study, session, {**form, "stage": str(stage)})
    if isinstance(found, Refusal):
        assert found.problems or stage.kind in ("practice", "trial")
        assert found.given.keys() == {*form, "stage"}
        return
    for event in found:
        session = advance(study, session, event)
        assert decode_event(encode_event(event)) == event


@given(st.text(st.characters(codec=None)))
def test_texts_can_be_stored_anywhere(text: str) -> None:
    cleaned = clean(text)
    assert cleaned.encode().decode() == cleaned == clean(cleaned)
    assert "\x00" not in cleaned
    assert "\r" not in cleaned


def events(found: tuple[Event, ...] | Refusal) -> tuple[Event, ...]:
    assert not isinstance(found, Refusal), found.problems
    return found
