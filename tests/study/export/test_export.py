"""An export holds what was stored, in tables that other programs can read."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
import pyarrow.parquet as pq
import pytest

from coadapt.cli import main
from coadapt.errors import FileError
from coadapt.robots import Robot
from coadapt.simulation import Episode, Trial
from coadapt.study.export import TABLES, Manifest, export
from coadapt.study.export.files import csv_name
from coadapt.study.export.identities import write_identities
from coadapt.study.record import Record, Stored
from coadapt.study.robots import setup_of
from coadapt.study.session import Stage
from coadapt.study.session.events import (
    Answered,
    Declined,
    Excluded,
    Noted,
    Readmitted,
    Stepped,
    Withdrew,
)
from tests.study.sessions import NOON, Driver, allocated_sessions, changed_study, small_study

LATER = NOON + 1e6
"""By then, 11 days after the first session, one that is not at its end is stale."""

Row = dict[str, Any]


def stored(records: Sequence[Record], *, is_mixed: bool = False, deleted: int = 0) -> Stored:
    directory, study, _ = small_study()
    return Stored(directory, study, lambda: records, is_mixed, (LATER - 1,) * deleted)


def exported(records: Sequence[Record], out: Path, **options: Any) -> dict[str, list[Row]]:
    """The tables of an export of ``records``, as Parquet holds them."""
    export(stored(records), out, LATER, **options)
    return read(out)


def read(out: Path) -> dict[str, list[Row]]:
    return {
        t.name: pq.read_table(out / "data/parquet" / f"{t.name}.parquet").to_pylist()
        for t in TABLES
    }


def driver(key: str, seed: int, number: int, condition: str = "mutual_adaptation") -> Driver:
    _, study, robots = small_study()
    someone = Driver(study, robots, key, seed, allotted=condition, number=number)
    someone.open({"PROLIFIC_PID": f"person-{number}"})
    return someone


def unfinished_sessions() -> list[Record]:
    """One of each standing but "completed": stale, declined, withdrawn, excluded."""
    stale = driver("stale", 1, 1)
    stale.go(until=Stage("trial", 2))
    stale.steer(Stage("trial", 2), stop_after=2)
    declined = driver("declined", 2, 2)
    declined.go(until=Stage("consent"))
    declined.record_event(Declined())
    withdrawn = driver("withdrawn", 3, 3)
    withdrawn.go(until=Stage("scale", 1))
    withdrawn.record_event(Withdrew())
    excluded = driver("excluded", 4, 4)
    excluded.go()
    excluded.record_event(Excluded(reason="fell asleep"))
    return [someone.record for someone in (stale, declined, withdrawn, excluded)]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, list[Row]]]:
    """An export of six whole sessions."""
    out = tmp_path_factory.mktemp("export") / "e"
    return out, exported(allocated_sessions(6), out)


# What the rows say


def test_every_session_event_and_answer_is_there(
    whole: tuple[Path, dict[str, list[Row]]],
) -> None:
    records, (_, tables) = allocated_sessions(6), whole
    assert [p["participant"] for p in tables["participants"]] == [r.alias for r in records]
    assert len(tables["events"]) == sum(len(record.events) for record in records)
    events = [kept.event for record in records for kept in record.events]
    assert len(tables["steps"]) == sum(isinstance(event, Stepped) for event in events)
    answers = [len(event.answers) for event in events if isinstance(event, Answered)]
    assert len(tables["answers"]) == sum(answers)
    assert len(tables["trials"]) == 6 * 3
    assert all(p["included"] and p["standing"] == "completed" for p in tables["participants"])


def test_trials_are_what_the_robots_of_the_study_do(
    whole: tuple[Path, dict[str, list[Row]]],
) -> None:
    """The oracle is a trial of `coadapt.simulation` with the exported inputs."""
    _, study, robots = small_study()
    _, tables = whole
    for row in tables["trials"]:
        choice = ["left", "right"].index(row["choice"])
        robot = robots[row["condition"], choice]
        steps = [
            s
            for s in tables["steps"]
            if (s["participant"], s["stage"], s["number"], s["counts"])
            == (row["participant"], "trial", row["trial"], True)
        ]
        inputs = [s["input"] for s in steps]
        episode, beliefs = again(robot, inputs)
        assert row["steps"] == episode.steps == len(steps)
        assert row["goal"] == robot.model.mode_names[episode.goal]  # type: ignore[index]
        assert row["reward"] == episode.reward
        assert row["disagreements"] == episode.overridden
        assert row["optimal"] != row["choice"]
        assert row["at_optimal"] == (row["goal"] == row["optimal"])
        assert row["inputs"] == sum(i is not None for i in inputs)
        assert [s["belief"] for s in steps] == [d.belief.tolist() for d in episode.decisions]
        assert row["matched"] == sum(d.matched for d in episode.decisions)
        assert row["belief_alpha"] == pytest.approx(beliefs, abs=1e-12)
        assert row["finished"] and row["attempts"] == 1
        assert row["robot"] == study.condition(row["condition"]).robot


def again(robot: Robot, inputs: Sequence[str | None]) -> tuple[Episode, list[float]]:
    """The trial with these inputs, and the last belief over adaptability."""
    trial = Trial(robot)
    for name in inputs:
        trial.step(None if name is None else robot.model.input_names.index(name))
    episode = trial.episode()
    return episode, episode.decisions[-1].forecast.sum(axis=1).tolist()


def test_rewards_are_those_the_robots_planned_for() -> None:
    directory, study, _ = small_study()
    from coadapt.study.protocol.reader import study_task

    task = study_task(study, directory)
    for choice in (0, 1):
        setup = setup_of(study, task, study.conditions[0], choice)
        assert setup.task.goals[choice].reward == study.rewards.other
        assert setup.task.goals[1 - choice].reward == study.rewards.optimal


def test_times_count_from_the_opening(whole: tuple[Path, dict[str, list[Row]]]) -> None:
    _, tables = whole
    first = tables["participants"][0]["participant"]
    times = [e["time"] for e in tables["events"] if e["participant"] == first]
    assert times[0] == 0 and times == sorted(times)
    step = next(s for s in tables["steps"] if s["participant"] == first)
    # The driver presses 0.15 s before the step; page times count from its own zero.
    assert step["time"] - step["input_time"] == pytest.approx(0.15)


def test_reversed_items_checks_and_choices(tmp_path: Path) -> None:
    directory, _, robots = small_study()
    toml = (directory / "study.toml").read_text()
    changed = toml.replace(
        'name = "trust_trustworthy"', 'name = "trust_trustworthy"\nreversed = true', 1
    ).replace('name = "comments"', 'name = "comments"\nchoices = ["yes", "no"]\nrequired = true', 1)
    folder = tmp_path / "s"
    folder.mkdir()
    (folder / "study.toml").write_text(changed)
    from coadapt.study.protocol import read_study

    study = read_study(folder)
    someone = Driver(study, robots, "key", 1)
    someone.open()
    record = someone.go()
    export(Stored(folder, study, lambda: [record]), tmp_path / "e", LATER)
    answers = {a["item"]: a for a in read(tmp_path / "e")["answers"]}
    reverse = answers["trust_trustworthy"]
    assert reverse["score"] == 6 - reverse["value"]  # five points
    assert answers["trust_right_thing"]["score"] == answers["trust_right_thing"]["value"]
    check = answers["attention_agree"]
    assert (check["kind"], check["score"]) == ("check", None)
    assert check["correct"] == (check["value"] == 4)
    assert (answers["comments"]["kind"], answers["comments"]["label"]) == ("choice", "yes")
    assert answers["comments"]["points"] == 2


# Who is in it


def test_nobody_is_dropped_in_silence(tmp_path: Path) -> None:
    tables = exported(unfinished_sessions(), tmp_path / "e")
    people = {p["standing"]: p for p in tables["participants"]}
    assert set(people) == {"stale", "declined", "withdrawn", "excluded"}
    assert not any(p["included"] for p in people.values())
    assert people["excluded"]["reason"] == "fell asleep"
    assert people["withdrawn"]["condition"] == "mutual_adaptation"
    assert people["withdrawn"]["device"] is None
    in_trials = {t["participant"] for t in tables["trials"]}
    assert in_trials == {people["stale"]["participant"], people["excluded"]["participant"]}
    broken = next(t for t in tables["trials"] if not t["finished"])
    assert (broken["trial"], broken["steps"], broken["goal"], broken["reward"]) == (
        2,
        2,
        None,
        None,
    )


def test_those_who_withdrew_are_exported_if_asked_for(tmp_path: Path) -> None:
    tables = exported(unfinished_sessions(), tmp_path / "e", private=True)
    withdrawn = next(p for p in tables["participants"] if p["standing"] == "withdrawn")
    assert withdrawn["device"] == "keyboard"
    assert withdrawn["participant"] in {t["participant"] for t in tables["trials"]}


def test_readmitted_sessions_count_again(tmp_path: Path) -> None:
    someone = driver("back", 5, 1)
    someone.go()
    someone.record_event(Excluded(reason="a mistake"), Readmitted())
    (participant,) = exported([someone.record], tmp_path / "e")["participants"]
    assert participant["included"] and participant["reason"] is None


def test_simulated_sessions_do_not_count_beside_real_ones(tmp_path: Path) -> None:
    real, robot = driver("real", 6, 1), driver("simulated", 7, 2)
    robot.record_event(Noted(what="simulated"))
    records = [real.go(), robot.go()]
    export(stored(records, is_mixed=True), tmp_path / "both", LATER)
    both = read(tmp_path / "both")["participants"]
    assert [(p["simulated"], p["included"]) for p in both] == [(False, True), (True, False)]
    alone = exported(records[1:], tmp_path / "alone")["participants"]
    assert [(p["simulated"], p["included"]) for p in alone] == [(True, True)]


def test_counts_of_the_manifest(tmp_path: Path) -> None:
    records = [*unfinished_sessions(), *allocated_sessions(2)]
    manifest = export(stored(records, deleted=3), tmp_path / "e", LATER)
    counts = manifest.counts
    assert (counts.sessions, counts.included, counts.deleted) == (6, 2, 3)
    assert sum(counts.standing.values()) == 6
    written = (tmp_path / "e/export.json").read_bytes()
    assert msgspec.json.decode(written, type=Manifest) == manifest
    assert isinstance(manifest, Manifest)
    assert "3 sessions were deleted" in (tmp_path / "e/README.md").read_text()


# Privacy


def test_nothing_names_a_person(tmp_path: Path) -> None:
    records = [driver("secret-key", 8, 1).go()]
    exported(records, tmp_path / "e", private=True)
    for path in (tmp_path / "e").rglob("*.*"):
        if path.is_file() and path.suffix != ".parquet":
            text = path.read_text()
            assert "person-1" not in text and "secret-key" not in text, path
    everything = str(read(tmp_path / "e"))
    assert "person-1" not in everything and "secret-key" not in everything


def test_identities_are_a_file_of_their_own(tmp_path: Path) -> None:
    records = [driver("secret-key", 8, 1).go()]
    write_identities(stored(records), tmp_path / "who.csv")
    rows = list(csv.DictReader((tmp_path / "who.csv").read_text().splitlines()))
    assert [(r["participant"], r["PROLIFIC_PID"]) for r in rows] == [(records[0].alias, "person-1")]


# Files


def test_csv_and_parquet_hold_the_same(whole: tuple[Path, dict[str, list[Row]]]) -> None:
    out, tables = whole
    for table in TABLES:
        with (out / "data" / csv_name(table)).open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        assert list(rows[0]) == [column.name for column in table.columns]
        for row, expected in zip(rows, tables[table.name], strict=True):
            for column in table.columns:
                value = expected[column.name]
                cell = row[column.name]
                if value is None:
                    assert cell == ""
                elif column.kind == "text":
                    assert cell == value
                else:
                    assert json.loads(cell) == value, column


def test_keys_tell_rows_apart(whole: tuple[Path, dict[str, list[Row]]]) -> None:
    _, tables = whole
    for table in TABLES:
        keys = [tuple(row[name] for name in table.key) for row in tables[table.name]]
        assert len(set(keys)) == len(keys)


def test_what_must_not_be_missing_is_not(whole: tuple[Path, dict[str, list[Row]]]) -> None:
    out, _ = whole
    for table in TABLES:
        schema = pq.read_schema(out / "data/parquet" / f"{table.name}.parquet")
        assert {f.name: f.nullable for f in schema} == {c.name: c.optional for c in table.columns}


def test_psych_ds(whole: tuple[Path, dict[str, list[Row]]]) -> None:
    """The rules of https://psychds-docs.readthedocs.io/en/latest/reference/rules_and_conventions/."""
    out, _ = whole
    description = json.loads((out / "dataset_description.json").read_text())
    assert description["@type"] == "Dataset"
    assert description["@context"] == "https://schema.org"
    assert description["name"] and description["description"]
    measured = {variable["name"] for variable in description["variableMeasured"]}
    files = sorted((out / "data").rglob("*.csv"))
    assert len(files) == len(TABLES)
    columns: set[str] = set()
    for path in files:
        assert re.fullmatch(r"([a-z]+-[a-zA-Z0-9]+)(_[a-z]+-[a-zA-Z0-9]+)*_data\.csv", path.name)
        with path.open(newline="", encoding="utf-8") as file:
            header, *rows = csv.reader(file)
        assert all(len(row) == len(header) for row in rows)
        columns |= set(header)
        sidecar = json.loads(path.with_suffix(".json").read_text())
        assert [v["name"] for v in sidecar["variableMeasured"]] == header
    assert measured == columns


def test_the_protocol_goes_along(whole: tuple[Path, dict[str, list[Row]]]) -> None:
    from hashlib import sha256

    out, _ = whole
    protocol = (out / "materials/study.toml").read_bytes()
    assert protocol == (small_study()[0] / "study.toml").read_bytes()
    manifest = json.loads((out / "export.json").read_text())
    assert manifest["protocol_sha256"] == sha256(protocol).hexdigest()


def test_robots_can_be_built_from_the_materials(
    whole: tuple[Path, dict[str, list[Row]]],
) -> None:
    from coadapt.robots.task_setup import read_setup

    out, _ = whole
    _, _, robots = small_study()
    for entry in json.loads((out / "materials/robots.json").read_text()):
        setup = read_setup(json.dumps(entry["setup"]).encode())
        choice = ["left", "right"].index(entry["choice"])
        robot = robots[entry["condition"], choice]
        assert setup.model().world.goals == robot.model.world.goals


def test_logs_can_be_replayed_by_robots_that_are_planned_anew(
    whole: tuple[Path, dict[str, list[Row]]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, tables = whole
    logs = sorted((out / "logs").iterdir())
    trials = 0
    for log in logs:
        if log.name.startswith("mutual_adaptation"):
            saved = tmp_path / log.name
            # The exit code is 1 where the robot decides otherwise than recorded.
            assert main(["replay", str(log), "--out", str(saved), "--json"]) == 0
            trials += len(json.loads(capsys.readouterr().out)["trials"])
    mutual = [t for t in tables["trials"] if t["condition"] == "mutual_adaptation"]
    assert trials == len(mutual) > 0


def test_logs_are_of_those_to_be_analysed(tmp_path: Path) -> None:
    exported(unfinished_sessions(), tmp_path / "e")
    assert not (tmp_path / "e/logs").exists()


def test_the_same_data_give_the_same_files(tmp_path: Path) -> None:
    records = allocated_sessions(2)
    for name in ("one", "two"):
        export(stored(records), tmp_path / name, LATER)
    for path in sorted((tmp_path / "one").rglob("*")):
        if path.is_file():
            other = tmp_path / "two" / path.relative_to(tmp_path / "one")
            assert path.read_bytes() == other.read_bytes(), path


def test_an_older_export_is_replaced_and_nothing_else_is(tmp_path: Path) -> None:
    records = allocated_sessions(2)
    out = tmp_path / "e"
    export(stored(records[:1]), out, LATER)
    export(stored(records), out, LATER)
    assert len(read(out)["participants"]) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["e"]
    other = tmp_path / "thesis"
    other.mkdir()
    (other / "chapter.txt").write_text("years of work")
    with pytest.raises(FileError, match="no export"):
        export(stored(records), other, LATER)
    assert (other / "chapter.txt").read_text() == "years of work"


def test_an_export_that_fails_leaves_the_older_one(tmp_path: Path) -> None:
    records = allocated_sessions(2)
    out = tmp_path / "e"
    export(stored(records), out, LATER)

    def broken() -> Any:
        yield records[0]
        raise RuntimeError("the database has gone")

    directory, study, _ = small_study()
    with pytest.raises(RuntimeError, match="has gone"):
        export(Stored(directory, study, broken), out, LATER)
    assert len(read(out)["participants"]) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["e"]


def test_no_sessions_at_all(tmp_path: Path) -> None:
    tables = exported([], tmp_path / "e")
    assert all(rows == [] for rows in tables.values())
    assert changed_study().title in (tmp_path / "e/README.md").read_text()
