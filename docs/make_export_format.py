"""Write docs/reference/export-format.md from the tables of `coadapt.study.export`.

python docs/make_export_format.py
"""

from __future__ import annotations

from pathlib import Path

from coadapt.study.export import FORMAT
from coadapt.study.export.codebook import markdown

PAGE = Path(__file__).parent / "reference" / "export-format.md"

CONTENTS = {
    "`README.md`": "what to read first",
    "`dataset_description.json`": "description for [Psych-DS](https://psych-ds.github.io/)",
    "`data/description-TABLE_data.csv`": "the tables below",
    "`data/description-TABLE_data.json`": "their columns",
    "`data/parquet/TABLE.parquet`": "the same tables with types",
    "`data/raw/sessions.jsonl`": "each session with its events, a JSON object a line",
    "`logs/CONDITION-CHOICE.csv`": "the finished trials of those to be analysed, in the "
    "[log format](log-format.md), for `coadapt fit` and, where beliefs are not carried from trial "
    "to trial, `coadapt replay`",
    "`documentation/codebook.md`, `.json`": "what every column means",
    "`materials/study.toml`": "the protocol",
    "`materials/model.json`": "names of states, goals, inputs and actions, and the values of "
    "adaptability, each in the order of its numbers; `disagreement_cost`, the C of Eq. 8 that "
    "robots planned with",
    "`materials/robots.json`": "for each condition and chosen goal, what the robot was built from "
    "(`coadapt.robots.task_setup.TaskSetup`)",
    "`export.json`": "for programs: `format`, version of coadapt, hash of the protocol, numbers "
    "of sessions and rows; `protocol_changes`, accepted since the first participant came, and "
    "`protocol_edited`, what differs from what participants were last served",
}

FILES = "\n".join(
    ["| path | contents |", "| --- | --- |", *(f"| {p} | {text} |" for p, text in CONTENTS.items())]
)

HEAD = f"""# Export of a study

What `coadapt study export` writes, format {FORMAT}. Columns keep their names, types and meanings
within a format; new ones may be added. This page is made from `coadapt.study.export.tables` by
`docs/make_export_format.py`, and so is the codebook of every export.

{FILES}

CSV files are UTF-8 with a header; lines end in LF. An empty cell is a missing value, `true` and
`false` are booleans, lists are JSON. Numbers are written with as many digits as are needed to read
back the same 64-bit number.

Nothing in an export names a person: pseudonyms are derived from the sessions' secret keys,
parameters of links are left out, and times count from the opening of the session.
`--identities FILE` writes who is who to a file of its own.

All sessions are in the table of participants, whatever became of them, but for those that were
deleted, of which only their number is left, in `export.json`. Of those who declined or withdrew the
other tables hold nothing, unless `--private` is given. `included` says which to analyse.

"""


def page() -> str:
    """The text of the page."""
    return HEAD + markdown()


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
