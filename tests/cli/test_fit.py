"""`coadapt fit` and `coadapt power`: tables, JSON, figures, one line for what cannot be used."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from coadapt.cli import main

SMALL = ["--columns", "5", "--rows", "3"]


@pytest.fixture
def log(tmp_path: Path) -> Path:
    path = tmp_path / "log.csv"
    episodes = ["--episodes", "12", "--mode", "left", "--robot", "no_adaptation"]
    assert main(["simulate", *SMALL, *episodes, "--log", str(path)]) == 0
    return path


def test_a_simulated_log_is_fitted(log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    capsys.readouterr()
    modes, figure = log.with_name("modes.csv"), log.with_name("fit.svg")
    options = ["--first-mode", "left", "--modes", str(modes), "--figure", str(figure)]
    assert main(["fit", str(log), *options]) == 0
    out = capsys.readouterr().out
    assert "12 participants, 12 trials" in out
    assert main(["fit", str(log), "--first-mode", "left", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert len(found["participants"]) == 12
    mean = found["population"]["mean"]
    assert mean["low"] <= mean["estimate"] <= mean["high"]
    assert f"{mean['estimate']:.3f}" in out
    assert sum(w["estimate"] for w in found["weights"]["weights"]) == pytest.approx(1)
    rows = list(csv.DictReader(modes.read_text().splitlines()))
    assert len(rows) == sum(p["steps"] for p in found["participants"])
    for row in rows:
        assert float(row["P(left)"]) + float(row["P(right)"]) == pytest.approx(1)
    assert figure.read_text().startswith("<?xml")


def test_the_population_can_be_the_prior(log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    capsys.readouterr()
    widths = []
    for prior in ("uniform", "population"):
        assert main(["fit", str(log), "--prior", prior, "--json"]) == 0
        people = json.loads(capsys.readouterr().out)["participants"]
        widths.append(sum(p["high"] - p["low"] for p in people))
    assert widths[1] < widths[0]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--first-mode", "up"], "--first-mode must be one of left, right"),
        (["--values", "0.5,0.2"], "--values must increase"),
        (["--lapse", "1"], "lapse"),
        (["--figure", "fit.txt"], "--figure must end in .png"),
        (["--memory", "200"], "--memory cannot be used"),
    ],
)
def test_bad_options_are_refused(
    log: Path, options: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    assert main(["fit", str(log), *options]) == 2
    err = capsys.readouterr().err
    assert message in err
    assert err.count("\n") == 1


POWER = ["power", *SMALL, "--sizes", "4,12", "--experiments", "100", "--mean", "0.6"]


def test_power(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    figure = tmp_path / "power.svg"
    assert main([*POWER, "--figure", str(figure)]) == 0
    out = capsys.readouterr().out
    assert "H1: 80%" in out
    assert figure.read_text().startswith("<?xml")
    assert main([*POWER, "--json"]) == 0
    first = capsys.readouterr().out
    assert main([*POWER, "--json"]) == 0
    assert capsys.readouterr().out == first
    found = json.loads(first)
    assert [point["n"] for point in found["points"]] == [4, 12]
    assert found["first_mode"] == "left"  # of less reward


def test_power_for_people_who_slip_and_lapse(capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--noise", "0.1", "--noise-sd", "0.05", "--lapses", "0.2", "--lapse-steps", "2"]
    assert main([*POWER, *options]) == 0
    assert "noise: mean 0.1, SD 0.05; lapses: mean 0.2, SD 0" in capsys.readouterr().out
    assert main([*POWER, *options, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["population"] == {
        "mean": 0.6,
        "sd": 0.25,
        "noise": {"mean": 0.1, "sd": 0.05},
        "lapses": {"mean": 0.2, "sd": 0.0},
        "lapse_steps": 2.0,
    }
    assert main([*POWER, "--json"]) == 0
    without = json.loads(capsys.readouterr().out)
    assert found["points"] != without["points"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--sd", "0.5", "--mean", "0.2"], "--sd cannot be used"),
        (["--noise", "0.1", "--noise-sd", "0.4"], "--noise-sd cannot be used"),
        (["--lapses-sd", "0.1"], "--lapses-sd cannot be used"),
        (["--lapse-steps", "0.5"], "--lapse-steps"),
        (["--sizes", "9:3:1"], "does not lie from 2"),
        (["--sizes", "four"], "is not like 4,8,12"),
        (["--sizes", "4:9:0"], "is not like 4,8,12"),
        (["--robot", "no_adaptation"], "--robot is not for power"),
        (["--first-mode", "up"], "--first-mode must be one of left, right"),
        (["--columns", "2"], "--columns must be at least 3"),
    ],
)
def test_bad_options_of_power_are_refused(
    options: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["power", *options]) == 2
    assert message in capsys.readouterr().err
