"""What became of the protocol under way: noted in the database, told in the export."""

from __future__ import annotations

import json
from pathlib import Path

import msgspec

from coadapt.study.changes import Change, add_change, changes_in
from coadapt.study.export import Manifest, export
from coadapt.study.protocol.reader import study_task
from coadapt.study.record import SERVED, Stored
from coadapt.study.server.unchanged import keep_protocol
from coadapt.study.store import Store
from coadapt.study.store.store import set_setting
from tests.study.sessions import NOON, small_study


def new_store(folder: Path) -> Store:
    return Store(f"sqlite:///{folder / 'study.db'}")


def test_changes_are_kept_in_their_order(tmp_path: Path) -> None:
    store = new_store(tmp_path)
    assert changes_in(store) == ()
    with store.database.writing() as connection:
        add_change(connection, ["trials", "clock.most_steps"], 0.0)
        add_change(connection, ["title"], 86_400.5)
    assert changes_in(store) == (
        Change("1970-01-01T00:00:00+00:00", ("trials", "clock.most_steps")),
        Change("1970-01-02T00:00:00+00:00", ("title",)),
    )
    store.close()


def test_the_export_tells_them_and_what_was_edited_since(tmp_path: Path) -> None:
    directory, study, _ = small_study()
    store = new_store(tmp_path)
    assert Stored.of(directory, study, store).served is None
    manifest = export(Stored.of(directory, study, store), tmp_path / "never", NOON)
    assert (manifest.protocol_changes, manifest.protocol_edited) == ((), ())
    keep_protocol(store, study, study_task(study, directory), directory, accept=False)
    assert export(Stored.of(directory, study, store), tmp_path / "as", NOON).protocol_edited == ()
    served = json.loads(store.setting(SERVED) or "")
    served["study"]["title"] = "Another title"
    with store.database.writing() as connection:
        set_setting(connection, SERVED, json.dumps(served))
        add_change(connection, ["trials"], NOON)
    manifest = export(Stored.of(directory, study, store), tmp_path / "edited", NOON)
    assert manifest.protocol_edited == ("title",)
    (change,) = manifest.protocol_changes
    assert change.values == ("trials",)
    written = (tmp_path / "edited/export.json").read_bytes()
    assert msgspec.json.decode(written, type=Manifest) == manifest
    store.close()


def test_the_export_tells_the_cost_the_robots_planned_with(tmp_path: Path) -> None:
    directory, study, robots = small_study()
    store = new_store(tmp_path)
    export(Stored.of(directory, study, store), tmp_path / "e", NOON)
    model = json.loads((tmp_path / "e/materials/model.json").read_text())
    (cost,) = {robot.model.disagreement_cost for robot in robots.values()}
    assert model["disagreement_cost"] == cost
    store.close()
