"""The page on running a study, followed to the letter, with fewer simulated participants."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import click
import pytest

from coadapt.cli import main
from coadapt.cli.fit import command as fit
from coadapt.cli.study import COMMANDS, command
from coadapt.cli.study.serve import example
from coadapt.study.protocol import read_study
from coadapt.study.protocol.reader import template
from tests.study.sessions import small_study

PAGE = (Path(__file__).parents[1] / "docs" / "how-to" / "run-a-study.md").read_text("utf-8")

NUMBER = re.compile(r"\d[\d,]*")

FEWER = ("-n 51", "-n 6")


def shape(text: str) -> set[str]:
    """The lines of ``text`` with every number replaced."""
    return {NUMBER.sub("#", line).strip() for line in text.splitlines() if line.strip()}


def commands() -> list[tuple[str, str]]:
    """The commands of the page that end by themselves, in order, with what they show."""
    sessions = re.findall(r"^```console\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    found: list[tuple[str, str]] = []
    for session in sessions:
        for part in session.split("$ ")[1:]:
            line, _, shown = part.partition("\n")
            if line.startswith("coadapt ") and " serve " not in line:
                found.append((line.removeprefix("coadapt "), shown))
    return found


def use_small_table(directory: Path) -> None:
    """Take the small table, whose robots are planned already: that changes no line shown."""
    text = template().decode().replace('"table_clearing"', '"table_clearing_small"')
    (directory / "study.toml").write_text(text, encoding="utf-8")
    shutil.copytree(small_study()[0] / "policies", directory / "policies")


def test_the_commands_do_what_is_shown(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    todo = commands()
    assert [line.split()[1] for line, _ in todo] == [
        "new",
        "pilot",
        "status",
        "replay",
        "export",
        "pilot",
    ]
    # What can become of participants differs with their number.
    every = shape("".join(shown for _, shown in todo)) | {
        f"# {name}" for name in ("withdrawn", "vanished", "declined", "failed", "active", "stale")
    }
    stages = re.compile(
        r"# (welcome|preflight|consent|instructions|practice|choice|briefing|trial|"
        r"scale|questions|debrief) #"
    )
    for line, shown in todo:
        assert main(line.replace(*FEWER).split()) == 0
        out = capsys.readouterr().out
        extra = {x for x in shape(out) - every if not stages.fullmatch(x)}
        assert extra == set(), line
        assert shape(shown.splitlines()[0]) <= shape(out)
        if line.startswith("study new"):
            use_small_table(tmp_path / "bottles")
    assert (tmp_path / "pilot-data/README.md").is_file()
    # The last block: commands without what they show.
    final = re.findall(r"^coadapt (study (?:replay|export) .*)$", PAGE, re.MULTILINE)
    assert [main(line.split()) for line in final] == [0, 0]
    assert (tmp_path / "who-is-who.csv").is_file()


def test_the_fit_takes_the_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from coadapt.study.export import export
    from coadapt.study.record import Stored
    from tests.study.sessions import NOON, allocated_sessions

    directory, study, _ = small_study()
    out = tmp_path / "data"
    export(Stored(directory, study, lambda: allocated_sessions(6)), out, NOON)
    (line,) = re.findall(r"^coadapt (fit .*)$", PAGE, re.MULTILINE)
    arguments = [str(out) if part == "data" else part for part in line.split()]
    assert main([*arguments, "--json"]) == 0
    fitted = json.loads(capsys.readouterr().out)
    assert len(fitted["participants"]) == 6
    (tmp_path / "empty").mkdir()
    assert main(["fit", str(tmp_path / "empty")]) == 2
    assert "found no logs" in capsys.readouterr().err


def test_the_script_reads_the_tables(tmp_path: Path) -> None:
    """The columns and files that the Python on the page names are there."""
    import pyarrow.parquet as pq

    from coadapt.study.export import export
    from coadapt.study.record import Stored
    from tests.study.sessions import NOON, allocated_sessions

    directory, study, _ = small_study()
    export(Stored(directory, study, lambda: allocated_sessions(2)), tmp_path / "data", NOON)
    script = re.search(r"^```python\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    assert script is not None
    paths = re.findall(r'"(data/[^"]*parquet)"', script[1])
    tables = [pq.read_table(tmp_path / path).column_names for path in paths]
    assert len(tables) == 2
    columns = {name for table in tables for name in table}
    assert set(re.findall(r'"(\w+)"', script[1])) <= columns
    assert "included" in tables[0]


def test_everything_named_exists() -> None:
    context = click.Context(command)
    commands = [fit, *(command.get_command(context, name) for name in COMMANDS)]
    known = {o for c in commands if c is not None for p in c.params for o in p.opts}
    assert set(re.findall(r"(?<![\w-])--[a-z][a-z-]+", PAGE)) <= known | {"--help"}
    for link in re.findall(r"\]\((?!https)([^)]+)\)", PAGE):
        assert (Path(__file__).parents[1] / "docs" / "how-to" / link).is_file(), link
    study = read_study(small_study()[0])
    link = example("http://127.0.0.1:8000", study.recruitment.parameters)
    assert f"with a recruitment service: {link}" in PAGE
