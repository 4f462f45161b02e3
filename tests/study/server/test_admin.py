"""The researcher's side: who gets in, what is shown, what can be done."""

from __future__ import annotations

import io
import json
import re
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from coadapt.study.record import Stored, alias_of
from coadapt.study.server.security import new_admin_token
from coadapt.study.server.service import Service
from coadapt.study.session.events import Noted
from coadapt.study.store import Store
from tests.study.pilot.piloted import PEOPLE, SEED, copy_of, piloted
from tests.study.server.sites import client_of, enter

CSRF = re.compile(r'name="csrf" value="([^"]*)"')

CONDITIONS = ("no_adaptation", "mutual_adaptation", "one_way_adaptation")


class Researcher:
    """Somebody with the token, in a study after a pilot."""

    def __init__(self, client: TestClient, service: Service) -> None:
        self.client, self.service = client, service
        self.token = new_admin_token(service.store)
        assert client.get(f"/admin?token={self.token}").status_code == 303

    def page(self, path: str = "/admin") -> str:
        answer = self.client.get(path)
        assert answer.status_code == 200, answer.text
        return answer.text

    def do(self, path: str, **fields: str) -> int:
        csrf = CSRF.findall(self.page())[0]
        return self.client.post(path, data={"csrf": csrf, **fields}).status_code

    def session(self, end: str = "finished") -> tuple[int, str]:
        """Number and key of a session that ended so."""
        rows = self.service.store.rows()
        return next((row.id, row.key) for row in rows if row.digest.end == end)


@pytest.fixture
def site(tmp_path: Path) -> Iterator[tuple[TestClient, Service]]:
    directory = copy_of(piloted(), tmp_path / "s")
    with client_of(Store.url_in(directory)) as (client, service):
        yield client, service


@pytest.fixture
def researcher(site: tuple[TestClient, Service]) -> Researcher:
    return Researcher(*site)


# Getting in


@pytest.mark.parametrize(
    "path", ["/admin", "/admin/sessions/1", "/admin/sessions/1/attempts/0/recording", "/admin/find"]
)
def test_nobody_gets_in_without_the_token(site: tuple[TestClient, Service], path: str) -> None:
    client, service = site
    new_admin_token(service.store)
    for token in ("", "a guess"):
        answer = client.get(path, headers={"cookie": f"coadapt_admin={token}"})
        assert answer.status_code == 403
        assert "simulated-" not in answer.text


def test_the_token_leaves_the_address_and_is_kept_out_of_scripts(
    site: tuple[TestClient, Service],
) -> None:
    client, service = site
    token = new_admin_token(service.store)
    answer = client.get(f"/admin?token={token}")
    assert (answer.status_code, answer.headers["location"]) == (303, "/admin")
    cookie = answer.headers["set-cookie"]
    assert "HttpOnly" in cookie and "Path=/admin" in cookie and "SameSite=lax" in cookie
    # Only a hash is stored.
    assert token not in str(service.store.settings())


def test_a_wrong_token_and_too_many_of_them(site: tuple[TestClient, Service]) -> None:
    client, service = site
    new_admin_token(service.store)
    codes = [client.post("/admin", data={"token": f"guess {i}"}).status_code for i in range(12)]
    assert codes[0] == 403 and codes[-1] == 429


def test_a_new_token_ends_the_old_one(researcher: Researcher) -> None:
    new_admin_token(researcher.service.store)
    assert researcher.client.get("/admin").status_code == 403


def test_participants_are_no_researchers(site: tuple[TestClient, Service]) -> None:
    client, _ = site
    path = enter(client)
    assert client.get(path).status_code == 200
    assert client.get("/admin").status_code == 403


@pytest.mark.parametrize(
    ("path", "fields"),
    [
        ("/admin/status", {"do": "close"}),
        ("/admin/blinding", {"sure": "yes"}),
        ("/admin/export", {}),
        ("/admin/sessions/1", {"do": "exclude", "reason": "why not"}),
    ],
)
def test_forms_of_other_pages_do_nothing(
    researcher: Researcher, path: str, fields: dict[str, str]
) -> None:
    before = researcher.service.store.settings()
    answer = researcher.client.post(path, data={"csrf": "0" * 64, **fields})
    assert answer.status_code == 409
    assert researcher.service.store.settings() == before


# Looking


def test_the_dashboard_shows_everybody(researcher: Researcher) -> None:
    page = researcher.page()
    for row in researcher.service.store.rows():
        assert alias_of(row.key) in page
        assert row.key not in page
    assert page.count('class="tag">simulated') == PEOPLE
    only = researcher.page("/admin?standing=completed")
    ended = [r for r in researcher.service.store.rows() if r.digest.end == "finished"]
    assert only.count('class="tag">simulated') == len(ended)


@pytest.mark.parametrize("query", ["page=0", "page=-1", "page=99999999", "page=x", "standing=odd"])
def test_odd_questions_are_answered(researcher: Researcher, query: str) -> None:
    assert "Dashboard" in researcher.page(f"/admin?{query}")


def test_conditions_are_hidden_until_asked_for_and_that_is_kept(researcher: Researcher) -> None:
    number, _ = researcher.session()
    paths = ("/admin", f"/admin/sessions/{number}", f"/admin/sessions/{number}/attempts/2")
    for path in paths:
        page = researcher.page(path)
        assert not any(name in page for name in CONDITIONS)
        assert "briefing" not in page  # only some conditions have one
    assert researcher.do("/admin/blinding") == 303  # not sure
    assert "unblindings" not in researcher.service.store.settings()
    assert researcher.do("/admin/blinding", sure="yes") == 303
    assert all(name in researcher.page() for name in CONDITIONS)
    condition = next(
        row.digest.condition for row in researcher.service.store.rows() if row.id == number
    )
    assert str(condition) in researcher.page(f"/admin/sessions/{number}")
    assert researcher.do("/admin/blinding", do="hide") == 303
    assert not any(name in researcher.page() for name in CONDITIONS)
    kept = json.loads(researcher.service.store.settings()["unblindings"])
    assert [act for _, act in ((k["time"], k["act"]) for k in kept)] == ["unblinded", "blinded"]


def test_a_session_with_its_answers_and_course(researcher: Researcher) -> None:
    number, key = researcher.session()
    page = researcher.page(f"/admin/sessions/{number}")
    assert "trust_right_thing" in page and "Passed the preflight" in page
    assert key not in page
    assert researcher.client.get("/admin/sessions/999").status_code == 404
    assert researcher.client.get(f"/admin/sessions/{number}/attempts/99").status_code == 404


def test_errors_of_pages_are_seen(researcher: Researcher) -> None:
    number, key = researcher.session()
    row = next(row for row in researcher.service.store.rows() if row.key == key)
    from coadapt.study.store import Addition

    last = researcher.service.store.events(row.id)[-1].sequence
    with researcher.service.store.database.writing() as connection:
        noted = Noted(what="error", text="<script>alert(1)</script> of undefined")
        researcher.service.store.append(connection, [Addition(row.id, last + 1, 1.0, [noted])])
    page = researcher.page(f"/admin/sessions/{number}")
    assert 'class="error"' in page
    assert "<script>alert" not in page and "&lt;script&gt;alert" in page


def test_a_session_that_does_not_fit_the_protocol_hides_no_other(researcher: Researcher) -> None:
    number, key = researcher.session()
    with researcher.service.store.database.writing() as connection:
        connection.exec_driver_sql(
            f"DELETE FROM events WHERE session = {number} AND kind = 'consented'"
        )
    page = researcher.page()
    assert f"The events of {alias_of(key)} do not fit" in page
    assert page.count('class="tag">simulated') == PEOPLE - 1
    assert researcher.client.get(f"/admin/sessions/{number}").status_code == 409


def test_the_recording_is_what_happened(researcher: Researcher) -> None:
    number, key = researcher.session()
    service = researcher.service
    record = next(
        r
        for r in Stored.of(service.directory, service.study, service.store).records()
        if r.key == key
    )
    from coadapt.study.attempts import attempts_of

    attempts = attempts_of(record.moments(service.study))
    index = next(
        i for i, a in enumerate(attempts) if a.stage.kind == "trial" and a.finished is not None
    )
    path = f"/admin/sessions/{number}/attempts/{index}/recording"
    blind = json.loads(researcher.page(path))
    attempt = attempts[index]
    assert [s["reached"] for s in blind["steps"]] == [s.stepped.reached for s in attempt.steps]
    assert blind["start"] == attempt.began.start
    assert attempt.finished is not None and blind["goal"] == attempt.finished.goal
    assert all(s["belief"] is None and s["planned"] is None for s in blind["steps"])
    researcher.do("/admin/blinding", sure="yes")
    told = json.loads(researcher.page(path))
    beliefs = [s.stepped.belief for s in attempt.steps]
    assert [tuple(map(tuple, s["belief"])) for s in told["steps"]] == beliefs


def test_finding_a_session(researcher: Researcher) -> None:
    number, key = researcher.session()
    row = next(row for row in researcher.service.store.rows() if row.key == key)
    for text in (f"{number}", alias_of(key), row.participant):
        answer = researcher.client.get("/admin/find", params={"q": f" {text} "})
        assert answer.headers["location"] == f"/admin/sessions/{number}"
    assert researcher.client.get("/admin/find", params={"q": "nobody"}).status_code == 404
    assert row.participant is not None and row.participant.startswith(f"simulated-{SEED}-")


# Doing


def test_pausing_closing_and_opening(researcher: Researcher) -> None:
    client = researcher.client
    path = enter(client)
    assert researcher.do("/admin/status", do="pause") == 303
    assert "A short break" in client.get(path).text
    assert researcher.do("/admin/status", do="close") == 303
    client.cookies.delete("coadapt")
    assert "Not open" in client.get("/").text
    assert "Welcome" in client.get(path).text
    assert researcher.do("/admin/status", do="open") == 303
    assert client.get("/").status_code == 303
    assert researcher.do("/admin/status", do="explode") == 303
    assert "New participants are let in" in researcher.page()


def test_excluding_and_readmitting_need_a_reason_that_stays(researcher: Researcher) -> None:
    number, _ = researcher.session()
    path = f"/admin/sessions/{number}"
    assert researcher.do(path, do="exclude", reason=" ") == 422
    assert researcher.do(path, do="exclude", reason="fell asleep") == 303
    assert "fell asleep" in researcher.page(path)
    assert researcher.do(path, do="exclude", reason="again") == 409
    assert researcher.do(path, do="readmit", reason="did not") == 303
    page = researcher.page(path)
    assert "did not" in page and 'value="exclude"' in page
    digest = next(r.digest for r in researcher.service.store.rows() if r.id == number)
    assert digest.end == "finished"


def test_deleting_leaves_a_time_and_nothing_else(researcher: Researcher) -> None:
    number, key = researcher.session()
    store = researcher.service.store
    name = next(row.participant for row in store.rows() if row.key == key)
    path = f"/admin/sessions/{number}"
    assert researcher.do(path, do="delete", alias="something else") == 422
    assert researcher.do(path, do="delete", alias=alias_of(key)) == 303
    assert len(store.deleted()) == 1
    assert key not in {row.key for row in store.rows()}
    assert store.events(number) == []
    assert researcher.client.get(path).status_code == 404
    assert researcher.client.get(f"/s/{key}").status_code == 404
    stored = store.database.engine.url.database
    assert stored is not None and name is not None
    with store.database.engine.connect() as connection:
        connection.exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")
    assert name.encode() not in Path(stored).read_bytes()


def test_downloading_the_data(researcher: Researcher) -> None:
    csrf = CSRF.findall(researcher.page())[0]
    answer = researcher.client.post("/admin/export", data={"csrf": csrf})
    assert answer.headers["content-type"] == "application/zip"
    with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
        names = archive.namelist()
        table = archive.read("export/data/description-participants_data.csv").decode()
    assert "export/README.md" in names
    assert len(table.splitlines()) == PEOPLE + 1
    kept = json.loads(researcher.service.store.settings()["unblindings"])
    assert [k["act"] for k in kept] == ["exported"]


def test_signing_out(researcher: Researcher) -> None:
    assert researcher.client.post("/admin/leave").status_code == 303
    assert researcher.client.get("/admin").status_code == 403
