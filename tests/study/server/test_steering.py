"""Steering over the websocket: turns, attempts, tabs, and what is refused."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from coadapt.study.protocol import Clock
from coadapt.study.robots import model_of
from coadapt.study.server import socket as module
from coadapt.study.server.messages import (
    LONGEST_MESSAGE,
    Begun,
    Over,
    Pong,
    Refused,
    Scene,
    Step,
    Stored,
)
from coadapt.study.server.service import Service
from coadapt.study.server.steering import new_attempt
from coadapt.study.session import Session, Stage
from coadapt.study.session.events import Began, Event, Finished, Noted, Pressed, Stepped
from coadapt.study.session.machine import stage_of
from coadapt.study.trial import as_belief
from tests.study.server.services import bring, study_with
from tests.study.server.sites import client_of, enter, hear, press, say

TRIAL = Stage("trial", 1)


@pytest.fixture
def url(tmp_path: Path) -> str:
    return f"sqlite:///{tmp_path / 'study.db'}"


def arrive(client: TestClient, service: Service, stage: Stage) -> tuple[str, str]:
    """A new session in ``stage``: its key, and the address of its websocket."""
    client.cookies.clear()
    path = enter(client)
    key = path.rpartition("/")[2]
    portal = client.portal
    assert portal is not None
    portal.call(bring, service, key, stage)
    return key, f"{path}/steer"


def session_of(client: TestClient, service: Service, key: str) -> Session:
    assert client.portal is not None
    session: Session = client.portal.call(service.session, key)
    return session


def events_of(service: Service, key: str) -> list[Event]:
    row = service.store.find(key=key)
    assert row is not None
    return [kept.event for kept in service.store.events(row.id)]


def assert_refused(websocket, words: str) -> None:
    while not isinstance(message := hear(websocket), Refused):
        pass
    assert words in message.reason
    with pytest.raises(WebSocketDisconnect) as closed:
        websocket.receive_text()
    assert closed.value.code == 1008


def test_a_trial_from_ready_to_over(url: str) -> None:
    with client_of(url) as (client, service):
        key, address = arrive(client, service, TRIAL)
        with client.websocket_connect(address) as socket:
            scene = hear(socket)
            assert isinstance(scene, Scene)
            assert (scene.kind, scene.number, scene.of) == ("trial", 1, 3)
            say(socket, type="ready")
            begun = hear(socket)
            assert isinstance(begun, Begun)
            state, step = begun.state, 0
            while True:
                press(socket, 0, 2 * step)
                assert hear(socket) == Stored(sequence=2 * step)
                moved = hear(socket)
                assert isinstance(moved, Step)
                assert (moved.step, moved.state, moved.input) == (step, state, 0)
                state, step = moved.reached, step + 1
                if any(state in goal.states for goal in scene.goals):
                    break
                press(socket, None, 2 * step - 1)  # let go: stored, but the robot waits
                assert hear(socket) == Stored(sequence=2 * step - 1)
            over = hear(socket)
            assert isinstance(over, Over)
            assert state in scene.goals[over.goal or 0].states
        session = session_of(client, service, key)
        assert stage_of(service.study, session) == Stage("trial", 2)
        assert session.results[0].steps == step
        events = events_of(service, key)
        assert sum(isinstance(event, Pressed) for event in events) == 2 * step - 1
        assert isinstance(events[-1], Finished)


def test_what_is_stored_can_be_computed_again(url: str) -> None:
    with client_of(url) as (client, service):
        key, address = arrive(client, service, TRIAL)
        before = session_of(client, service, key)
        with client.websocket_connect(address) as socket:
            hear(socket)
            say(socket, type="ready")
            hear(socket)
            for i, given in enumerate((1, 0, 2, 0)):
                press(socket, given, i)
                hear(socket), hear(socket)
        again = new_attempt(service, key, before, TRIAL)
        stored = [e for e in events_of(service, key) if isinstance(e, Began | Stepped)]
        events = [again.began, *(again.step(given) for given in (1, 0, 2, 0))]
        assert stored[-5:] == events  # every belief and decision, to the bit


def test_sessions_side_by_side_do_not_disturb_each_other(url: str) -> None:
    # Both have the same robot object. Each must get what it gets alone.
    study = study_with(conditions=study_with().conditions[1:2])
    inputs = ((0, 0, 1, 0, 0), (2, 2, 2, 1, 2))

    def steps(service: Service, key: str) -> list[Stepped]:
        return [e for e in events_of(service, key) if isinstance(e, Stepped)]

    with client_of(url, study) as (client, service):
        pairs = [arrive(client, service, TRIAL) for _ in inputs]
        before = [session_of(client, service, key) for key, _ in pairs]
        with (
            client.websocket_connect(pairs[0][1]) as first,
            client.websocket_connect(pairs[1][1]) as second,
        ):
            sockets = (first, second)
            for socket in sockets:
                hear(socket)
                say(socket, type="ready")
                hear(socket)
            for i in range(len(inputs[0])):
                for socket, given in zip(sockets, inputs, strict=True):
                    press(socket, given[i], i)
                    hear(socket), hear(socket)
        for (key, _), session, given in zip(pairs, before, inputs, strict=True):
            alone = new_attempt(service, key, session, TRIAL)
            assert steps(service, key) == [alone.step(g) for g in given]


def test_the_clock_decides_with_the_input_that_is_held(url: str) -> None:
    study = study_with(clock=Clock(turns="fixed", step=0.1))
    with client_of(url, study) as (client, service):
        _, address = arrive(client, service, TRIAL)
        with client.websocket_connect(address) as socket:
            hear(socket)
            say(socket, type="ready")
            hear(socket)
            press(socket, None, 0)
            assert hear(socket) == Stored(sequence=0)
            time.sleep(0.25)  # the clock runs from the first input on, not before
            press(socket, 0, 1)
            assert hear(socket) == Stored(sequence=1)
            began = time.monotonic()
            held = [hear(socket), hear(socket)]
            press(socket, None, 2)
            rest = [message for message in (hear(socket) for _ in range(4))]
            seconds = time.monotonic() - began
        assert [m.input for m in held if isinstance(m, Step)] == [0, 0]
        assert Stored(sequence=2) in rest
        steps = [m for m in rest if isinstance(m, Step)]
        assert steps[-1].input is None
        assert [m.step for m in steps] == [2, 3, 4]
        assert seconds > 0.35  # five decisions: four steps of 0.1 s, less the first's delay


def test_the_clock_ends_with_the_steps(url: str) -> None:
    study = study_with(clock=Clock(turns="fixed", step=0.05, most_steps=3))
    with client_of(url, study) as (client, service):
        key, address = arrive(client, service, Stage("practice", 1))
        with client.websocket_connect(address) as socket:
            hear(socket)
            say(socket, type="ready")
            hear(socket)
            press(socket, 1, 0)
            messages = [hear(socket) for _ in range(5)]
            assert [type(m) for m in messages] == [Stored, Step, Step, Step, Over]
            assert messages[-1] == Over(goal=None)
        assert stage_of(study, session_of(client, service, key)) == Stage("practice", 2)


def test_an_interrupted_trial_begins_again_and_both_are_kept(url: str) -> None:
    with client_of(url) as (client, service):
        key, address = arrive(client, service, TRIAL)
        starts: list[int] = []
        for attempt in (1, 2, 3):
            with client.websocket_connect(address) as socket:
                hear(socket)
                say(socket, type="ready")
                begun = hear(socket)
                assert isinstance(begun, Begun) and begun.attempt == attempt
                starts.append(begun.state)
                press(socket, 1, 0)
                hear(socket), hear(socket)
        assert len(set(starts)) == 1
        events = events_of(service, key)
        began = [e.attempt for e in events if isinstance(e, Began) and e.stage == TRIAL]
        assert began == [1, 2, 3]
        assert session_of(client, service, key).steps == 1


def test_the_newer_of_two_tabs_goes_on(url: str) -> None:
    with client_of(url) as (client, service):
        _, address = arrive(client, service, TRIAL)
        with client.websocket_connect(address) as old:
            hear(old)
            say(old, type="ready")
            hear(old)
            with client.websocket_connect(address) as new:
                assert_refused(old, "another window")
                assert isinstance(hear(new), Scene)
                say(new, type="ready")
                begun = hear(new)
                assert isinstance(begun, Begun) and begun.attempt == 2
                press(new, 1, 0)
                assert hear(new) == Stored(sequence=0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no message"),
        ("nonsense", "no message"),
        ("[]", "no message"),
        ('{"type":"allocated","condition":"mutual_adaptation"}', "no message"),
        ('{"type":"ready","more":1}', "no message"),
        ('{"type":"ping","page_time":1e999}', "no message"),
        ('{"type":"note","what":"' + "a" * LONGEST_MESSAGE + '"}', "no message"),
        (
            '{"type":"input","input":3,"device":"keyboard","sequence":1,"page_time":1}',
            "input 3 is not one of 0 to 2",
        ),
        (
            '{"type":"input","input":-1,"device":"keyboard","sequence":1,"page_time":1}',
            "input -1 is not one",
        ),
        (
            '{"type":"input","input":1,"device":"mouse","sequence":1,"page_time":1}',
            "no message",
        ),
        (
            '{"type":"input","input":1,"device":"touch","sequence":-1,"page_time":1}',
            "out of range",
        ),
        (
            '{"type":"input","input":1,"device":"touch","sequence":1,"page_time":1e300}',
            "out of range",
        ),
    ],
)
def test_what_is_no_message_ends_the_connection(url: str, text: str, words: str) -> None:
    with client_of(url) as (client, service):
        key, address = arrive(client, service, TRIAL)
        with client.websocket_connect(address) as socket:
            hear(socket)
            say(socket, type="ready")
            hear(socket)
            count = len(events_of(service, key))
            socket.send_text(text)
            assert_refused(socket, words)
        assert len(events_of(service, key)) == count


def test_bytes_are_no_message(url: str) -> None:
    with client_of(url) as (client, service):
        _, address = arrive(client, service, TRIAL)
        with client.websocket_connect(address) as socket:
            socket.send_bytes(b'{"type":"ready"}')
            assert_refused(socket, "no message")


def test_a_flood_ends_the_connection(url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "BURST", 20.0)
    monkeypatch.setattr(module, "RATE", 1.0)
    with client_of(url) as (client, service):
        key, address = arrive(client, service, TRIAL)
        with client.websocket_connect(address) as socket:
            hear(socket)
            for i in range(40):
                say(socket, type="ping", page_time=float(i))
            assert [hear(socket) for _ in range(20)] == [
                Pong(page_time=float(i)) for i in range(20)
            ]
            assert_refused(socket, "Too many messages")
        with client.websocket_connect(address) as socket:  # later they may go on
            assert isinstance(hear(socket), Scene)
        assert session_of(client, service, key).end is None


def test_where_there_is_nothing_to_steer(url: str) -> None:
    with client_of(url) as (client, service):
        key, address = arrive(client, service, Stage("preflight"))
        with client.websocket_connect(address) as socket:
            say(socket, type="ping", page_time=1.5)  # the preflight measures the way
            assert hear(socket) == Pong(page_time=1.5)
            press(socket, 1, 0)  # no part of anything: not stored, not acknowledged
            say(socket, type="note", what="a note", value=2.0, text="ⓒ\x00")
            say(socket, type="ready")
            assert_refused(socket, "nothing to steer")
        events = events_of(service, key)
        assert events[-1] == Noted(what="a note", value=2.0, text="ⓒ\x00")
        assert not any(isinstance(event, Pressed) for event in events)


def test_sessions_that_are_over_unknown_paused_or_deleted(url: str) -> None:
    with client_of(url) as (client, service):
        portal = client.portal
        assert portal is not None
        with (
            pytest.raises(WebSocketDisconnect) as closed,
            client.websocket_connect("/s/unknown/steer"),
        ):
            pass
        assert closed.value.code == 4404
        key, address = arrive(client, service, TRIAL)
        portal.call(service.set_status, "paused")
        with client.websocket_connect(address) as socket:
            hear(socket)
            say(socket, type="ready")
            assert_refused(socket, "paused")
        portal.call(service.set_status, "open")
        with client.websocket_connect(address) as socket:
            hear(socket)
            say(socket, type="ready")
            hear(socket)
            portal.call(service.exclude, key, "a test")
            press(socket, 1, 0)
            assert_refused(socket, "ended: excluded")
        with client.websocket_connect(address) as socket:
            portal.call(service.delete, key)
            say(socket, type="ready")
            assert_refused(socket, "deleted")


def test_pages_of_others_cannot_connect(url: str) -> None:
    with client_of(url) as (client, service):
        _, address = arrive(client, service, TRIAL)
        for origin in ("https://evil.example", "null"):
            with (
                pytest.raises(WebSocketDisconnect) as closed,
                client.websocket_connect(address, headers={"origin": origin}),
            ):
                pass
            assert closed.value.code == 4403
        own = {"origin": "http://testserver"}
        with client.websocket_connect(address, headers=own) as socket:
            assert isinstance(hear(socket), Scene)


def test_an_idle_connection_is_a_sign_of_life(url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "ALIVE", 0.05)
    with client_of(url) as (client, service):
        key, address = arrive(client, service, TRIAL)
        with client.websocket_connect(address) as socket:
            hear(socket)
            time.sleep(0.3)
        notes = [e for e in events_of(service, key) if e == Noted(what="alive")]
        assert 2 <= len(notes) <= 6


def test_what_could_not_be_stored_is_not_acknowledged(
    url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    from coadapt.study.store import StoreError

    def fail(*_: object) -> None:
        raise StoreError("the disk is full")

    with client_of(url) as (client, service):
        key, address = arrive(client, service, TRIAL)
        with client.websocket_connect(address) as socket:
            hear(socket)
            say(socket, type="ready")
            hear(socket)
            count = len(events_of(service, key))
            with monkeypatch.context() as patch:
                patch.setattr(service.store, "append", fail)
                press(socket, 1, 0)
                message = hear(socket)
                assert isinstance(message, Refused)
                assert "could not be stored" in message.reason
        assert len(events_of(service, key)) == count


def test_carried_beliefs(url: str) -> None:
    study = study_with(belief="carried", conditions=study_with().conditions[1:2])
    with client_of(url, study) as (client, service):
        key, address = arrive(client, service, TRIAL)
        ends = model_of(service.robots).world.ends
        with client.websocket_connect(address) as socket:
            hear(socket)
            say(socket, type="ready")
            hear(socket)
            press(socket, 0, 0)
            sequence = 0
            while not isinstance(message := hear(socket), Over):
                if isinstance(message, Step) and not ends[message.reached]:
                    sequence += 1
                    press(socket, 0, sequence)
            say(socket, type="ready")
            assert [type(hear(socket)) for _ in range(2)] == [Scene, Begun]
        events = events_of(service, key)
        (finished,) = (e for e in events if isinstance(e, Finished) and e.stage == TRIAL)
        began = events[-1]
        assert isinstance(began, Began) and began.stage == Stage("trial", 2)
        assert began.belief == finished.forecast
        prior = as_belief(model_of(service.robots).prior)
        assert began.belief != prior
