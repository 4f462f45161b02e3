"""The pages on fits and on planning a study: their commands, options and programs work."""

from __future__ import annotations

import json
import re
from pathlib import Path
from textwrap import dedent

import pytest

from coadapt.analysis.experiment.published import CHI2, RECONSTRUCTED, U_LOWER, U_UPPER
from coadapt.cli import main

DOCS = Path(__file__).parents[1] / "docs"
PAGES = {
    name: (DOCS / "how-to" / f"{name}.md").read_text("utf-8")
    for name in ("fit-adaptability", "plan-a-study")
}


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def commands(page: str) -> list[list[str]]:
    """What stands behind ``$ coadapt``."""
    return [line.split() for line in re.findall(r"^ *\$ coadapt (.*)$", page, re.MULTILINE)]


def test_a_simulated_log_is_fitted_as_shown(capsys: pytest.CaptureFixture[str]) -> None:
    simulate, fit = commands(PAGES["fit-adaptability"])
    assert main(simulate) == 0
    assert json.loads(capsys.readouterr().out)["episodes"] == 30
    assert main([*fit, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    mean = found["population"]["mean"]
    assert mean["low"] <= 0.5 <= mean["high"] + 0.05  # they were simulated with 0.5
    assert Path("fit.png").read_bytes().startswith(b"\x89PNG")
    assert Path("modes.csv").read_text().startswith("participant,trial,step")


def test_the_power_is_computed_as_shown(capsys: pytest.CaptureFixture[str]) -> None:
    (power,) = commands(PAGES["plan-a-study"])
    assert main([*power, "--sizes", "6,24", "--experiments", "200", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["population"]["mean"] == 0.5
    assert found["population"]["noise"] == {"mean": 0.0, "sd": 0.0}
    # The page says 23 for 80 %.
    low, high = found["points"][1]["low"][0], found["points"][1]["high"][0]
    assert low - 0.05 < 0.8 < high + 0.05
    assert Path("power.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("name", "command"), [("fit-adaptability", "fit"), ("plan-a-study", "power")]
)
def test_the_options_exist(name: str, command: str, capsys: pytest.CaptureFixture[str]) -> None:
    options = set(re.findall(r"`(--[a-z-]+)", PAGES[name]))
    assert main([command, "--help"]) == 0
    shown = capsys.readouterr().out
    assert len(options) > 5
    assert [option for option in sorted(options) if option not in shown] == []


@pytest.mark.parametrize("name", PAGES)
def test_the_python_runs(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    code = dedent(PAGES[name].split("```python\n")[1].split("```")[0])
    exec(compile(code, f"{name}.md", "exec"), {})
    assert len(capsys.readouterr().out.splitlines()) >= 2


def test_the_page_on_the_published_study_has_its_numbers() -> None:
    page = (DOCS / "explanation" / "the-published-study.md").read_text("utf-8")
    for number in (CHI2, U_UPPER, U_LOWER):
        assert str(number) in page
    for counts in RECONSTRUCTED.values():
        assert ", ".join(map(str, counts)) in page
