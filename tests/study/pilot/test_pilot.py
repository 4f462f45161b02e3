"""Simulated participants take part as real ones do, and what they do is data like theirs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from coadapt.cli import main
from coadapt.study.pilot.person import Population, people
from coadapt.study.protocol import read_study
from coadapt.study.record import Record, Stored
from coadapt.study.session.events import (
    Answered,
    Began,
    Checked,
    Chose,
    Finished,
    Opened,
    Pressed,
)
from coadapt.study.session.plan import plan_of
from coadapt.study.store import Store
from tests.study.pilot.piloted import (
    PEOPLE,
    SEED,
    TROUBLE,
    copy_of,
    fresh,
    piloted,
    run_pilot,
)
from tests.study.sessions import small_study


@contextmanager
def store_of(directory: Path) -> Iterator[Store]:
    store = Store(Store.url_in(directory))
    try:
        yield store
    finally:
        store.close()


def records_of(directory: Path) -> list[Record]:
    """By the number of the participant, whatever the order in which they came."""
    with store_of(directory) as store:
        records = list(Stored.of(directory, read_study(directory), store).records())
    return sorted(records, key=lambda record: record.row.participant or "")


def test_all_come_and_all_are_marked() -> None:
    records = records_of(piloted())
    assert len(records) == PEOPLE
    assert all(record.is_simulated for record in records)
    assert [r.row.participant for r in records] == [
        f"simulated-{SEED}-{i + 1}" for i in range(PEOPLE)
    ]


def test_things_go_wrong_as_asked_for() -> None:
    """With these probabilities and this seed; else the other tests show less than they should."""
    records = records_of(piloted())
    ends = [record.row.digest.end for record in records]
    assert "finished" in ends and any(end != "finished" for end in ends)
    attempts = [k.event.attempt for r in records for k in r.events if isinstance(k.event, Began)]
    assert max(attempts) > 1
    # Every training session and trial of those who finished came to its end.
    study = read_study(piloted())
    for record in records:
        if record.row.digest.end == "finished":
            finished = [k.event.stage for k in record.events if isinstance(k.event, Finished)]
            assert len(finished) == study.practice + study.trials


def done(record: Record) -> list[object]:
    """What a participant did, without times and keys, and attempts that were broken off in their
    course, for what still reached the server then depends on the moment."""
    doings: list[object] = []
    attempt: list[object] = []
    for kept in record.events:
        event = kept.event
        match event:
            case Opened():
                doings.append(event.parameters)
            case Checked():
                doings.append((event.device, event.pad))
            case Chose() | Answered():
                doings.append(event)
            case Began():
                attempt = [event.stage]
            case Pressed():
                attempt.append((event.input, event.device))
            case Finished():
                doings += [*attempt, event.goal]
            case _:
                pass
    return doings


def test_the_same_seed_gives_the_same_inputs_and_answers() -> None:
    again = fresh("coadapt-again-")
    assert run_pilot(again, *TROUBLE) == 0
    first, second = records_of(piloted()), records_of(again)
    assert [done(record) for record in first] == [done(record) for record in second]
    assert [r.row.digest.condition for r in first] == [r.row.digest.condition for r in second]
    assert {r.key for r in first}.isdisjoint({r.key for r in second})


def test_another_seed_gives_other_people() -> None:
    stages = len(plan_of(small_study()[1]))
    some, others = (people(20, Population(), stages, seed) for seed in (1, 2))
    assert [p.adaptability for p in some] != [p.adaptability for p in others]
    assert [p.mood for p in people(5, Population(), stages, 1)] == [p.mood for p in some[:5]]


@pytest.fixture(autouse=True)
def pilot_is_over(capsys: pytest.CaptureFixture[str]) -> None:
    """What the pilot says is not what the commands after it say."""
    piloted()
    capsys.readouterr()


def test_replay_finds_no_difference(capsys: pytest.CaptureFixture[str]) -> None:
    code = main(["study", "replay", str(piloted()), "--json"])
    found = json.loads(capsys.readouterr().out)
    assert (code, found["differences"]) == (0, [])
    assert found["sessions"] == PEOPLE
    assert found["allocations"] == sum(r.row.place is not None for r in records_of(piloted()))
    assert found["steps"] > 100


def test_replay_finds_what_was_changed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    directory = copy_of(piloted(), tmp_path / "s")
    with store_of(directory) as store, store.database.writing() as connection:
        changed = connection.exec_driver_sql(
            "UPDATE events SET data = replace(data, '\"matched\":true', '\"matched\":false') "
            "WHERE kind = 'stepped' AND data LIKE '%\"matched\":true%'"
        )
        assert changed.rowcount > 0
    assert main(["study", "replay", str(directory)]) == 1
    assert "decision differs" in capsys.readouterr().out


def test_export_of_a_pilot(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "e"
    assert main(["study", "export", str(piloted()), "--out", str(out), "--json"]) == 0
    counts = json.loads(capsys.readouterr().out)["counts"]
    participants = pq.read_table(out / "data/parquet/participants.parquet").to_pylist()
    assert counts["sessions"] == counts["simulated"] == len(participants) == PEOPLE
    assert counts["included"] == sum(p["standing"] == "completed" for p in participants)
    steps = pq.read_table(out / "data/parquet/steps.parquet").to_pylist()
    assert all(step["page_time"] is not None for step in steps if step["input"])


def test_status_tells_no_conditions_unless_asked(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["study", "status", str(piloted())]) == 0
    blind = capsys.readouterr().out
    assert f"{PEOPLE} sessions" in blind and "adaptation" not in blind
    assert main(["study", "status", str(piloted()), "--unblinded", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    allocated = sum(sum(counts.values()) for counts in told["conditions"].values())
    assert allocated == sum(r.row.place is not None for r in records_of(piloted()))
    assert sum(told["standings"].values()) == told["sessions"] == PEOPLE


def test_no_pilot_among_real_people(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    directory = copy_of(piloted(), tmp_path / "s")
    with store_of(directory) as store, store.database.writing() as connection:
        store.add_session(connection, "a-real-one", "somebody", Opened(parameters={}))
    assert run_pilot(directory, n=1) == 2
    assert "real people" in capsys.readouterr().err


def test_simulated_sessions_can_be_removed(tmp_path: Path) -> None:
    directory = copy_of(piloted(), tmp_path / "s")
    with store_of(directory) as store, store.database.writing() as connection:
        store.add_session(connection, "a-real-one", "somebody", Opened(parameters={}))
    assert main(["study", "pilot", str(directory), "--remove"]) == 0
    assert [record.key for record in records_of(directory)] == ["a-real-one"]
    with store_of(directory) as store:
        # They were nobody's, so nothing counts as deleted at a participant's wish.
        assert store.deleted() == ()


def test_a_study_without_data(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    directory = str(tmp_path / "s")
    assert main(["study", "new", directory]) == 0
    for arguments in (["export", directory, "--out", str(tmp_path / "e")], ["replay", directory]):
        assert main(["study", *arguments]) == 2
        assert "found no data" in capsys.readouterr().err
