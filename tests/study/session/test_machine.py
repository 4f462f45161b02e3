"""The state machine of a session."""

from __future__ import annotations

from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.study.protocol import Study
from coadapt.study.protocol.reader import template
from coadapt.study.session import (
    BEGINNING,
    Event,
    NotNow,
    Session,
    Stage,
    advance,
    decode_event,
    encode_event,
    plan_of,
    replayed,
)
from coadapt.study.session import events as e
from coadapt.toml import parse_toml

STUDY, _ = parse_toml(template(), "study.toml", Study, "a study")
CHECKED = e.Checked(device="gamepad", width=800, height=600, latency=0.02, browser="b")


def answers(study: Study, stage: Stage, session: Session) -> dict[str, e.Answer]:
    if stage.kind == "scale":
        return {item.name: 3 for item in study.scales[stage.number - 1].items}
    changed = ("always", "if changed") if session.changed else ("always",)
    return {question.name: None for question in study.questions if question.ask in changed}


def steered(stage: Stage, wanted: int, attempt: int = 1) -> list[Event]:
    return [
        e.Began(stage=stage, attempt=attempt, start=6),
        e.Pressed(input=0, device="gamepad", sequence=1, page_time=1.0),
        e.Stepped(step=0, state=6, input=0, action=1, reached=19),
        e.Stepped(step=1, state=19, input=None, action=1, reached=32),
        e.Finished(stage=stage, goal=wanted, wanted=wanted, forecast=((0.5, 0.5),)),
    ]


def fitting(study: Study, session: Session, wanted: int = 0) -> list[Event]:
    """The events that lead from the stage of ``session`` to the next."""
    stage = plan_of(study)[session.position]
    match stage.kind:
        case "preflight":
            return [CHECKED]
        case "consent":
            return [e.Consented()]
        case "choice":
            return [e.Chose(goal=0), e.Allocated(condition="mutual_adaptation")]
        case "practice" | "trial":
            return steered(stage, wanted)
        case "scale" | "questions":
            return [e.Answered(stage=stage, answers=answers(study, stage, session))]
        case _:
            return [e.Read(stage=stage)]


def walked(study: Study = STUDY, wanted: int = 0, until: str = "debrief") -> list[Event]:
    """The events of a session up to the stage ``until``."""
    found: list[Event] = [e.Opened(parameters={})]
    while plan_of(study)[replayed(study, found).position].kind != until:
        found += fitting(study, replayed(study, found), wanted)
    return found


def test_a_session_from_the_link_to_the_debrief() -> None:
    session = replayed(STUDY, walked())
    assert session.end == "finished"
    assert [result.goal for result in session.results] == [0, 0, 0]
    assert [result.steps for result in session.results] == [2, 2, 2]
    assert session.condition == "mutual_adaptation"
    assert not session.changed
    # Eight items of the two scales with the attention check, and the comments.
    assert len(session.answers) == 9
    assert "why_changed" not in session.answers
    after = advance(STUDY, session, e.Read(stage=Stage("debrief")))
    assert after == session


def test_who_changed_strategy_is_asked_why() -> None:
    session = replayed(STUDY, walked(wanted=1))
    assert session.changed
    assert "why_changed" in session.answers


def test_a_briefing_is_for_its_condition_alone() -> None:
    before = [*walked(until="choice"), e.Chose(goal=1)]
    told = replayed(STUDY, [*before, e.Allocated(condition="mutual_adaptation")])
    untold = replayed(STUDY, [*before, e.Allocated(condition="no_adaptation")])
    assert plan_of(STUDY)[told.position].kind == "briefing"
    assert plan_of(STUDY)[untold.position] == Stage("trial", 1)


def test_an_interrupted_trial_begins_again() -> None:
    stage = Stage("trial", 1)
    events = [*walked(until="trial"), *steered(stage, 0)[:3], *steered(stage, 0, attempt=2)]
    session = replayed(STUDY, events)
    assert session.results[0].attempts == 2
    assert session.results[0].steps == 2


def test_who_declines_or_withdraws_is_out() -> None:
    declined = replayed(STUDY, [*walked(until="consent"), e.Declined()])
    assert declined.end == "declined"
    withdrawn = replayed(STUDY, [*walked(until="trial"), e.Withdrew()])
    assert withdrawn.end == "withdrawn"
    for session in (declined, withdrawn):
        with pytest.raises(NotNow, match="the session has ended"):
            advance(STUDY, session, e.Consented())


def test_an_exclusion_can_be_taken_back() -> None:
    session = replayed(STUDY, walked(until="trial"))
    excluded = advance(STUDY, session, e.Excluded(reason="asleep"))
    assert excluded.end == "excluded"
    assert advance(STUDY, excluded, e.Readmitted()) == session
    finished = replayed(STUDY, walked())
    out = advance(STUDY, finished, e.Excluded(reason="twice"))
    assert advance(STUDY, out, e.Readmitted()) == finished


@pytest.mark.parametrize(
    ("until", "event", "problem"),
    [
        ("welcome", e.Opened(parameters={}), "open already"),
        ("welcome", CHECKED, "in stage welcome 1"),
        ("preflight", e.Consented(), "in stage preflight 1"),
        ("choice", e.Chose(goal=2), "there is no goal 2"),
        ("choice", e.Allocated(condition="no_adaptation"), "the choice has not been made"),
        ("trial", e.Began(stage=Stage("trial", 2), attempt=1, start=0), "in stage trial 1"),
        ("trial", e.Began(stage=Stage("trial", 1), attempt=2, start=0), "would be attempt 1"),
        ("trial", e.Stepped(step=0, state=0, input=None, action=0, reached=0), "nothing is under"),
        ("scale", e.Answered(stage=Stage("scale", 1), answers={}), "for other questions"),
        ("questions", e.Read(stage=Stage("questions")), "in stage questions 1"),
        ("scale", e.Pressed(input=0, device="touch", sequence=1, page_time=0), "nothing to steer"),
    ],
)
def test_what_does_not_fit_is_refused(until: str, event: Event, problem: str) -> None:
    session = replayed(STUDY, walked(until=until))
    with pytest.raises(NotNow, match=problem):
        advance(STUDY, session, event)


@pytest.mark.parametrize("answer", [0, 6, None, "3"])
def test_an_answer_must_be_a_point_of_the_scale(answer: e.Answer) -> None:
    session = replayed(STUDY, walked(until="scale"))
    given = answers(STUDY, Stage("scale", 1), session) | {"trust_trustworthy": answer}
    with pytest.raises(NotNow, match="the answer to trust_trustworthy does not fit"):
        advance(STUDY, session, e.Answered(stage=Stage("scale", 1), answers=given))


STAGES = st.sampled_from(plan_of(STUDY))
EVENTS: st.SearchStrategy[Any] = st.one_of(
    st.builds(e.Opened, parameters=st.just({})),
    st.builds(e.Read, stage=STAGES),
    st.just(CHECKED),
    st.just(e.Consented()),
    st.just(e.Declined()),
    st.builds(e.Chose, goal=st.integers(-1, 2)),
    st.builds(e.Allocated, condition=st.sampled_from(["mutual_adaptation", "none"])),
    st.builds(e.Began, stage=STAGES, attempt=st.integers(0, 3), start=st.just(0)),
    st.just(e.Pressed(input=None, device="touch", sequence=1, page_time=0.0)),
    st.builds(
        e.Stepped,
        step=st.integers(0, 3),
        state=st.just(0),
        input=st.none(),
        action=st.just(0),
        reached=st.just(0),
    ),
    st.builds(e.Finished, stage=STAGES, goal=st.none(), wanted=st.integers(0, 1)),
    st.builds(e.Answered, stage=STAGES, answers=st.just({})),
    st.just(e.Withdrew()),
    st.just(e.Excluded(reason="r")),
    st.just(e.Readmitted()),
    st.just(e.Noted(what="w")),
)


@given(st.lists(st.one_of(st.just("next"), EVENTS), max_size=60))
def test_whatever_is_sent_a_session_only_goes_forward(sent: list[Any]) -> None:
    events: list[Event] = []
    session = BEGINNING
    for choice in sent:
        ahead = session.opened and session.end is None
        wished = fitting(STUDY, session) if choice == "next" and ahead else [choice]
        for event in wished:
            if event == "next":
                continue
            try:
                after = advance(STUDY, session, event)
            except NotNow:
                continue
            assert after.position >= session.position
            assert len(after.results) >= len(session.results)
            assert set(after.answers) >= set(session.answers)
            assert len(after.results) <= STUDY.trials
            session = after
            events.append(decode_event(encode_event(event)))
    assert replayed(STUDY, events) == session
    assert msgspec.json.decode(msgspec.json.encode(session), type=Session) == session
