"""`coadapt evaluate`: what it prints and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from coadapt.cli import evaluate as command
from coadapt.cli import main
from coadapt.cli.evaluate import exact_value_of
from coadapt.momdp.exact import evaluate_policy, exact_value
from coadapt.momdp.files import write_policy, write_pomdpx
from tests.momdp.problems import corridor, tiger

POLICY = exact_value(tiger(), 1e-3).policy
EXACT = evaluate_policy(tiger(), POLICY).lower[0]


@pytest.fixture(autouse=True)
def directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_pomdpx(tiger(), "tiger.pomdpx")
    write_policy(POLICY, "tiger.policyx")
    return tmp_path


def test_what_it_prints(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["evaluate", "tiger.pomdpx", "tiger.policyx", "--episodes", "1000"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    lines = out.splitlines()
    assert lines[0] == "tiger.pomdpx under tiger.policyx"
    assert [line.split()[0] for line in lines[1:]] == ["claimed", "simulated", "1,000", "exact"]
    assert lines[-1].split()[1] == f"{EXACT:.6g},"


def test_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["evaluate", "tiger.pomdpx", "tiger.policyx", "--seed", "7", "--json"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    found = json.loads(out)
    assert (found["problem"], found["policy"]) == ("tiger.pomdpx", "tiger.policyx")
    assert (found["episodes"], found["seed"], found["horizon"]) == (10_000, 7, 180)
    assert found["claimed"] == POLICY.value(0, np.array([0.5, 0.5]))
    assert abs(found["mean"] - EXACT) <= 4 * found["standard_error"] + found["truncation"]
    low, high = found["interval_95"]
    # 1.96 standard errors to either side
    assert high - low == pytest.approx(3.92 * found["standard_error"], rel=1e-4)
    assert found["exact"]["obstacle"] is None
    assert found["exact"]["lower"] <= EXACT <= found["exact"]["upper"] + 1e-9


def test_the_seed_changes_the_episodes(capsys: pytest.CaptureFixture[str]) -> None:
    means: list[float] = []
    for seed in ("1", "1", "2"):
        some = ["--episodes", "50", "--no-exact", "--json", "--seed", seed]
        assert main(["evaluate", "tiger.pomdpx", "tiger.policyx", *some]) == 0
        found = json.loads(capsys.readouterr().out)
        assert found["exact"]["lower"] is None
        assert found["exact"]["obstacle"] == "not asked for"
        means.append(found["mean"])
    assert means[0] == means[1] != means[2]


def test_where_the_exact_value_is_not_feasible(monkeypatch: pytest.MonkeyPatch) -> None:
    # One edge for each of three actions, of 2 x 2 numbers.
    monkeypatch.setattr(command, "MOST_ENTRIES", 11)
    large = exact_value_of(tiger(), POLICY)
    assert large.lower is None
    assert large.obstacle == "the transitions written out are 12 numbers, above 11"
    monkeypatch.setattr(command, "MOST_ENTRIES", 12)
    monkeypatch.setattr(command, "MOST_BELIEFS", 1)
    few = exact_value_of(tiger(), POLICY)
    assert few.obstacle == "1 beliefs are too few"
    assert few.lower is not None
    assert few.upper is not None
    assert few.lower < EXACT < few.upper


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "PROBLEM"),
        (["tiger.pomdpx"], "POLICY"),
        (["tigre", "tiger.policyx"], "expected a file or one of: grasp_selection, "),
        (["no.pomdpx", "tiger.policyx"], "no.pomdpx: cannot be read"),
        (["tiger.pomdpx", "no.policyx"], "no.policyx: cannot be read"),
        (["tiger.pomdpx", "tiger.pomdpx"], "expected .policy, .policyx or .coadapt"),
        (["tiger.pomdpx", "bad.policyx"], "bad.policyx:2: "),
        (["corridor.pomdpx", "tiger.policyx"], "tiger.policyx: found a policy for 1 observed and"),
        (["tiger.pomdpx", "tiger.policyx", "--episodes", "1"], "--episodes"),
        (["tiger.pomdpx", "tiger.policyx", "--horizon", "0"], "--horizon"),
        (["tiger.pomdpx", "tiger.policyx", "--seed", "-1"], "--seed"),
    ],
)
def test_an_error_is_one_line(
    capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    Path("bad.policyx").write_text("<Policy>\n")
    write_pomdpx(corridor(), "corridor.pomdpx")
    assert main(["evaluate", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("coadapt: error: ")
    assert err.count("\n") == 1
    assert words in err
