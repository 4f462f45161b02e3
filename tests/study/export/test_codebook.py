"""Every column is explained, and the explanations are those of the documentation."""

from __future__ import annotations

import json
import runpy
from pathlib import Path

from coadapt.study.export import FORMAT, TABLES
from coadapt.study.export.codebook import as_data, markdown

ROOT = Path(__file__).parents[3]

COLUMNS = {
    "participants": "participant number included standing reason simulated opened duration stage "
    "device pad browser width height latency choice condition robot allocation trials changed "
    "checks checks_failed restarts",
    "trials": "participant trial condition robot device choice optimal finished goal at_optimal "
    "reward steps attempts wanted changed inputs disagreements matched belief_alpha began duration "
    "first_input",
    "steps": "participant stage number attempt counts step time state window input action planned "
    "agreement matched reached belief device input_time page_time device_time",
    "answers": "participant item scale position kind value score points label text correct time",
    "events": "participant sequence time stage event data",
}
"""The columns of format 1. Who takes one away or renames it makes a new format."""


def test_the_format_is_kept() -> None:
    assert FORMAT == 1
    for table in TABLES:
        names = [column.name for column in table.columns]
        assert names[: len(COLUMNS[table.name].split())] == COLUMNS[table.name].split()


def test_every_column_is_explained() -> None:
    for table in TABLES:
        for column in table.columns:
            assert column.meaning.text.endswith("."), column.name
            assert f"| `{column.name}` |" in markdown([table])
        assert set(table.key) <= {column.name for column in table.columns}


def test_the_page_of_the_documentation_is_made_from_the_tables() -> None:
    made = runpy.run_path(str(ROOT / "docs" / "make_export_format.py"))
    assert made["PAGE"].read_text(encoding="utf-8") == made["page"]()


def test_the_codebook_is_plain_data() -> None:
    data = json.loads(json.dumps(as_data()))
    assert list(data) == [table.name for table in TABLES]
    assert data["trials"][0]["type"] == "text"
