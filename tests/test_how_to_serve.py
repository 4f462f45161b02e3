"""What the page on serving a study says is so."""

from __future__ import annotations

import re
from pathlib import Path

import click
import pytest

from coadapt.cli import main
from coadapt.cli.study.new import command as new
from coadapt.cli.study.serve import command as serve
from coadapt.study.protocol import read_study
from coadapt.study.server import app, socket
from coadapt.study.server.messages import LONGEST_MESSAGE
from coadapt.study.server.requests import LARGEST_FORM
from coadapt.study.store.writer import DELAY

PAGE = (Path(__file__).parents[1] / "docs" / "how-to" / "serve-a-study.md").read_text("utf-8")


def flat(text: str) -> str:
    return " ".join(text.split())


def test_its_options_exist() -> None:
    known = {name for option in serve.params for name in option.opts}
    assert set(re.findall(r"(?<![\w-])--[a-z-]+", PAGE)) <= known
    variables = {o.envvar for o in serve.params if isinstance(o, click.Option)}
    assert "COADAPT_DATABASE" in variables


def test_the_limits_are_those_of_the_server() -> None:
    assert (app.OPENING_BURST, app.OPENING_RATE) == (200, 1)
    assert (app.POSTING_BURST, app.POSTING_RATE) == (30, 2)
    assert (socket.BURST, socket.RATE) == (100, 50)
    assert (LARGEST_FORM, LONGEST_MESSAGE) == (1_000_000, 2048)
    for words in (
        "200 sessions at once and one a second",
        "30 forms at once and two a second",
        "50 messages a second steered (100 at once)",
        "a million bytes at most, messages 2,048",
        f"{DELAY * 1000:.0f} ms longer",
    ):
        assert words in flat(PAGE)


def test_new_makes_a_study_and_never_replaces_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert new.name == "new"
    assert main(["study", "new", "trust"]) == 0
    assert capsys.readouterr().out.startswith("Wrote trust/study.toml. Next:\n")
    assert read_study("trust").trials == 3
    Path("trust/study.toml").write_text("mine", encoding="utf-8")
    assert main(["study", "new", "trust"]) == 2
    assert "found a protocol already" in capsys.readouterr().err
    assert Path("trust/study.toml").read_text() == "mine"
    assert main(["study", "new", "trust/study.toml"]) == 2
    assert "found a file, expected a directory" in capsys.readouterr().err
