"""The site over HTTP: from the link to the debrief, and what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest
from starlette.testclient import TestClient

from coadapt.study.server import app as module
from coadapt.study.server.limits import Buckets
from coadapt.study.server.requests import LARGEST_FORM
from coadapt.study.server.security import HEADERS, csrf_of
from coadapt.study.server.service import Service
from coadapt.study.session import Stage
from coadapt.study.session.events import Finished
from coadapt.study.store import StoreError
from tests.study.server.services import study_with
from tests.study.server.sites import bring_to_practice, client_of, enter, hidden, post


@pytest.fixture
def url(tmp_path: Path) -> str:
    return f"sqlite:///{tmp_path / 'study.db'}"


def key_of(path: str) -> str:
    return path.rpartition("/")[2]


def stored(service: Service, path: str) -> list[str]:
    row = service.store.find(key=key_of(path))
    assert row is not None
    return [type(kept.event).__name__ for kept in service.store.events(row.id)]


def test_from_the_link_to_the_debrief(url: str) -> None:
    study = study_with(practice=0, trials=1)
    with client_of(url, study) as (client, service):
        path = enter(client, "/?PROLIFIC_PID=P1&STUDY_ID=S&nonsense=x")
        bring_to_practice(client, path)
        assert post(client, path, goal="1") == 303
        client.get(path)  # allocates
        row = service.store.find(participant="P1")
        assert row is not None and row.place == 1
        condition = study.condition(row.digest.condition or "")
        if condition.briefing:
            assert post(client, path) == 303
        # Without a websocket: what a trial leaves behind.
        with client.websocket_connect(f"{path}/steer") as socket:
            socket.receive_text()
            socket.send_text('{"type":"ready"}')
            socket.receive_text()
        portal = client.portal
        assert portal is not None
        portal.call(service.record, key_of(path), Finished(stage=Stage("trial", 1), goal=0))
        for scale in study.scales:
            answers = {item.name: "4" for item in scale.items}
            assert post(client, path, **answers) == 303
        assert post(client, path, comments="ⓒ 𝕊 <b>") == 303
        page = client.get(path)
        assert "You worked with one of three robots" in page.text
        row = service.store.find(participant="P1")
        assert row is not None and row.digest.end == "finished"


def test_who_comes_again_is_where_they_were(url: str) -> None:
    with client_of(url) as (client, _):
        path = enter(client)
        assert post(client, path) == 303
        assert enter(client) == path  # by the cookie
        client.cookies.clear()
        assert enter(client) != path
        client.cookies.clear()
        named = enter(client, "/?PROLIFIC_PID=P1")
        client.cookies.clear()
        assert enter(client, "/?PROLIFIC_PID=P1") == named


def test_a_form_counts_once(url: str) -> None:
    with client_of(url) as (client, service):
        path = enter(client)
        form = hidden(client, path)
        for _ in range(3):
            answer = client.post(path, data=form)
            assert (answer.status_code, answer.headers["location"]) == (303, path)
        assert stored(service, path) == ["Opened", "Read"]


def test_a_form_with_a_mistake_is_shown_again(url: str) -> None:
    with client_of(url) as (client, service):
        path = enter(client)
        post(client, path)
        form = {**hidden(client, path), "device": "telepathy", "browser": "<script>"}
        answer = client.post(path, data=form)
        assert answer.status_code == 422
        assert "<script>" not in answer.text
        assert stored(service, path) == ["Opened", "Read"]


def test_a_form_without_its_token_is_refused(url: str) -> None:
    with client_of(url) as (client, service):
        path, other = enter(client), csrf_of("another key")
        for csrf in ("", "x", other, "é"):
            form = {"stage": "welcome 1", "csrf": csrf}
            assert client.post(path, data=form).status_code == 403
            assert client.post(f"{path}/withdraw", data=form).status_code == 403
        assert stored(service, path) == ["Opened"]


def test_withdrawing(url: str) -> None:
    with client_of(url) as (client, service):
        path = enter(client)
        form = hidden(client, path)
        for _ in range(2):
            assert client.post(f"{path}/withdraw", data=form).status_code == 303
        assert stored(service, path) == ["Opened", "Withdrew"]
        assert "You have withdrawn" in client.get(path).text
        assert client.post(path, data=form).status_code == 303  # late


def test_closed_paused_and_full(url: str) -> None:
    import msgspec

    study = study_with(practice=0)
    conditions = (msgspec.structs.replace(study.conditions[0], quota=1),)
    with client_of(url, msgspec.structs.replace(study, conditions=conditions)) as (client, service):
        portal = client.portal
        assert portal is not None
        paths: list[str] = []
        for _ in range(2):
            client.cookies.clear()
            paths.append(enter(client))
            bring_to_practice(client, paths[-1])
            assert post(client, paths[-1], goal="0") == 303
        assert "takes no participants" not in client.get(paths[0]).text
        assert "takes no participants" in client.get(paths[1]).text  # the quota is met
        portal.call(service.set_status, "paused")
        assert "Everything you did is safe" in client.get(paths[0]).text
        portal.call(service.set_status, "closed")
        assert "Everything you did is safe" not in client.get(paths[0]).text
        client.cookies.clear()
        assert "takes no participants" in client.get("/").text
        assert len(service.store.rows()) == 2


def test_headers_and_cookies(url: str) -> None:
    with client_of(url) as (client, _):
        answers = [client.get("/"), client.get("/nothing"), client.get("/static/pages.css")]
        answers.append(client.get(answers[0].headers["location"]))
        for answer in answers:
            for name, value in HEADERS.items():
                assert answer.headers[name] == value
        assert answers[3].headers["cache-control"] == "no-store"
        cookie = answers[0].headers["set-cookie"]
        assert all(part in cookie for part in ("HttpOnly", "SameSite=lax", "Path=/"))
        assert "Secure" not in cookie
    with client_of(url, secure=True) as (client, _):
        assert "Secure" in client.get("/").headers["set-cookie"]


def test_what_is_not_there(url: str) -> None:
    with client_of(url) as (client, _):
        for path in ("/s/unknown", "/s/", "/s/a/b", "/nothing", "/static/../app.py", "/static/no"):
            answer = client.get(path)
            assert answer.status_code == 404
            assert "text/html" in answer.headers["content-type"]
        assert client.post("/").status_code == 405
        assert client.put("/s/a").status_code == 405
        form = {"csrf": csrf_of("unknown")}
        assert client.post("/s/unknown", data=form).status_code == 404
        assert client.post("/s/unknown/withdraw", data=form).status_code == 404
        assert client.get("/health").text == "ok"


def test_looking_at_a_link_opens_nothing(url: str) -> None:
    with client_of(url) as (client, service):
        assert client.head("/").status_code == 200
        assert service.store.rows() == []


def test_large_and_strange_forms(url: str) -> None:
    with client_of(url) as (client, service):
        path = enter(client)
        form = hidden(client, path)
        kind = {"content-type": "application/x-www-form-urlencoded"}
        large = "x=" + "a" * LARGEST_FORM
        assert client.post(path, content=large, headers=kind).status_code == 413
        many = "&".join(f"a{i}=1" for i in range(2000))
        assert client.post(path, content=many, headers=kind).status_code == 400
        assert client.post(path, json=form).status_code == 415
        assert client.post(path, content=b"\xff\x00%zz%ff=&&==", headers=kind).status_code == 403
        assert stored(service, path) == ["Opened"]


def test_too_many_requests(url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "OPENING_BURST", 3)
    monkeypatch.setattr(module, "POSTING_BURST", 3)
    monkeypatch.setattr(module, "POSTING_RATE", 0.001)
    monkeypatch.setattr(module, "OPENING_RATE", 0.001)
    with client_of(url) as (client, _):
        assert [client.get("/").status_code for _ in range(5)] == [303] * 3 + [429] * 2
        path = client.get("/health")
        path = "/s/unknown"
        codes = [client.post(path, data={"csrf": ""}).status_code for _ in range(5)]
        assert codes == [403] * 3 + [429] * 2


def test_errors_tell_nothing(
    url: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    with client_of(url) as (client, service):
        path = enter(client)
        form = hidden(client, path)

        async def full(*_: object, **__: object) -> None:
            raise StoreError("the disk is full")

        with monkeypatch.context() as patch:
            patch.setattr(service, "record", full)
            answer = client.post(path, data=form)
            assert answer.status_code == 503
            assert "could not be stored" in answer.text
            assert "disk" not in answer.text
        assert stored(service, path) == ["Opened"]
        assert "the disk is full" in caplog.text
        assert client.post(path, data=form).status_code == 303
        assert all(key not in caplog.text for key in (key_of(path), csrf_of(key_of(path))))


def test_a_database_that_is_away_gives_a_page(url: str, tmp_path: Path) -> None:
    with client_of(url) as (client, service):
        path = enter(client)
        service.store.close()
        for file in tmp_path.glob("study.db*"):
            file.rename(tmp_path / f"away-{file.name}")
        (tmp_path / "study.db").mkdir()  # which nobody can open as a file
        for answer in (client.get(path), client.get("/"), client.get("/health")):
            assert answer.status_code == 503
            assert answer.headers["retry-after"]
        (tmp_path / "study.db").rmdir()
        for file in tmp_path.glob("away-*"):
            file.rename(tmp_path / file.name.removeprefix("away-"))
        assert client.get(path).status_code == 200


def test_a_bug_gives_a_page(url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    async def broken(*_: object) -> None:
        raise ZeroDivisionError("secret detail")

    with client_of(url) as (client, service):
        path = enter(client)
        monkeypatch.setattr(service, "session", broken)
        quiet = TestClient(client.app, raise_server_exceptions=False)
        answer = quiet.get(path)
        assert answer.status_code == 500
        assert "secret detail" not in answer.text
        assert "Everything up to your last step is safe" in answer.text
        assert answer.headers["content-security-policy"]


def test_every_problem_has_words() -> None:
    assert all(heading and text for heading, text in module.PROBLEMS.values())
    assert {400, 403, 404, 405, 408, 413, 415, 429, 500, 503} <= set(module.PROBLEMS)


def test_buckets_are_bounded() -> None:
    now = [0.0]
    buckets = Buckets(1.0, 2.0, most=100, clock=lambda: now[0])
    assert [buckets.take("a") for _ in range(3)] == [True, True, False]
    assert sum(buckets.take(f"{i}") for i in range(200)) == 99
    assert len(buckets._buckets) == 100
    now[0] = 10.0
    assert buckets.take("new")
    assert len(buckets._buckets) == 1
    assert [buckets.take("a") for _ in range(3)] == [True, True, False]
