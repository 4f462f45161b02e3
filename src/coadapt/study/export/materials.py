"""What an export holds beside its tables: protocol, model, robots, codebook, a page to read."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec

from coadapt import __version__
from coadapt.study.changes import Change
from coadapt.study.export import codebook
from coadapt.study.export.files import csv_name
from coadapt.study.export.names import Names
from coadapt.study.export.tables import FORMAT, TABLES
from coadapt.study.protocol import Study
from coadapt.study.robots import setup_of
from coadapt.tasks import Task

MANIFEST = "export.json"

MODEL, ROBOTS, PROTOCOL = "model.json", "robots.json", "study.toml"
"""Files of the folder ``materials``."""


class Counts(msgspec.Struct, frozen=True, kw_only=True):
    """How many sessions there are.

    Attributes:
        sessions: in the tables.
        included: those that are to be analysed.
        simulated: those of programs.
        standing: how many of each standing.
        deleted: sessions that were deleted at the participant's wish; nothing else is left of them.
    """

    sessions: int
    included: int
    simulated: int
    standing: dict[str, int]
    deleted: int


class Manifest(msgspec.Struct, frozen=True, kw_only=True):
    """What an export is.

    Attributes:
        format: version of the format.
        coadapt: version of the program that wrote it.
        protocol_sha256: of ``materials/study.toml``.
        protocol_changes: those accepted since the first participant came: when, and which values.
        protocol_edited: names of the values of protocol and task that differ now from what
            participants were last served.
        exported: when, UTC, ISO 8601.
        counts: of the sessions.
        rows: of each table.
    """

    format: int
    coadapt: str
    protocol_sha256: str
    protocol_changes: tuple[Change, ...] = ()
    protocol_edited: tuple[str, ...] = ()
    exported: str
    counts: Counts
    rows: dict[str, int]


def write_metadata(folder: Path, study: Study) -> None:
    """Write what describes the tables: Psych-DS metadata and the codebook."""
    _write_json(
        folder / "dataset_description.json", codebook.dataset_description(study, __version__)
    )
    for table in TABLES:
        path = folder / "data" / Path(csv_name(table)).with_suffix(".json")
        _write_json(path, codebook.sidecar(table))
    documentation = folder / "documentation"
    documentation.mkdir()
    _write_json(documentation / "codebook.json", codebook.as_data())
    text = f"# Codebook\n\n{codebook.markdown()}"
    (documentation / "codebook.md").write_text(text, encoding="utf-8")


def write_materials(folder: Path, study: Study, protocol: bytes, task: Task, names: Names) -> None:
    """Write what the study was: the protocol, the model, and what each robot was built from."""
    materials = folder / "materials"
    materials.mkdir()
    (materials / PROTOCOL).write_bytes(protocol)
    _write_json(materials / MODEL, _model(names))
    _write_json(
        materials / ROBOTS,
        [
            {
                "condition": condition.name,
                "choice": names.goals[choice],
                "setup": msgspec.to_builtins(setup_of(study, task, condition, choice)),
            }
            for condition in study.conditions
            for choice in range(len(names.goals))
        ],
    )


def _model(names: Names) -> Mapping[str, Any]:
    model = names.model
    return {
        "states": list(model.world.state_names),
        "positions": model.world.positions.tolist(),
        "goals": list(names.goals),
        "inputs": list(names.inputs),
        "actions": list(names.actions),
        "adaptability": model.alpha.values.tolist(),
        "disagreement_cost": model.disagreement_cost,
    }


def write_readme(folder: Path, study: Study, manifest: Manifest) -> None:
    """Write the page to read first."""
    counts = manifest.counts
    standing = ", ".join(f"{n} {name}" for name, n in sorted(counts.standing.items())) or "none"
    tables = "\n".join(
        f"| `data/{csv_name(table)}` | {manifest.rows[table.name]:,} | {table.text} |"
        for table in TABLES
    )
    (folder / "README.md").write_text(
        _README.format(
            title=study.title,
            version=manifest.coadapt,
            format=FORMAT,
            exported=manifest.exported,
            sessions=counts.sessions,
            included=counts.included,
            standing=standing,
            simulated=counts.simulated,
            deleted=counts.deleted,
            tables=tables,
        ),
        encoding="utf-8",
    )


def write_manifest(folder: Path, manifest: Manifest) -> None:
    """Write the export's own description."""
    _write_json(folder / MANIFEST, msgspec.to_builtins(manifest))


def _write_json(path: Path, data: object) -> None:
    path.write_bytes(msgspec.json.format(msgspec.json.encode(data), indent=2) + b"\n")


_README = """# {title}

The data of a study, exported by coadapt {version} on {exported}, format {format} of
coadapt's exports. The folder follows Psych-DS.

There are {sessions} sessions: {standing}. Of these {simulated} are simulated. Analyse those where
`included` is true in the table of participants: {included}.

Sessions that did not come to their end stay in the tables and are marked by `standing`. Of those
who did not consent or who withdrew there is only the row in the table of participants, and nothing
of what they did, unless the export was asked for it. {deleted} sessions were deleted at the
participant's wish; nothing is left of them.

| file | rows | contents |
| --- | --- | --- |
{tables}

The same tables are in `data/parquet` with their types. CSV files are UTF-8 with a header; an empty
cell is a missing value, lists are JSON. Every column is explained in `documentation/codebook.md`.
`data/raw/sessions.jsonl` holds each session with its events, a JSON object a line.

`logs` holds the trials of those to be analysed once more, a log for each condition and chosen goal,
as `coadapt fit` and `coadapt replay` read them.

`materials/study.toml` is the protocol. `materials/model.json` names states, goals, inputs, actions
and the values of adaptability, in the order of their numbers in the tables, and holds the cost C of
a disagreement (Eq. 8) that the robots planned with.
`materials/robots.json` holds what the robots were built from. `export.json` describes this export
for programs.
"""
