"""`coadapt solve`: what it prints, what it writes, what it refuses."""

from __future__ import annotations

import csv
import json
import signal
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import coadapt as ca
from coadapt.cli import main
from coadapt.cli.problems import load_problem
from coadapt.cli.process import peak_memory_mb, seconds_since_launch
from coadapt.cli.solve import ENDS, TRACE
from coadapt.momdp import MOMDP, Root, check_momdp
from coadapt.momdp.exact import exact_value
from coadapt.momdp.files import read_policy, write_pomdpx
from coadapt.momdp.sarsop import Status, compile_kernels, solver
from coadapt.tasks import task_names
from tests.momdp.problems import tiger

OPTIMUM = exact_value(tiger(), 1e-4)


@pytest.fixture(autouse=True)
def directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_pomdpx(tiger(), "tiger.pomdpx")
    compile_kernels()  # or the first test would be told of it
    return tmp_path


def test_the_policy_and_its_bounds(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "tiger.pomdpx"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    lines = out.splitlines()
    assert lines[0] == "tiger.pomdpx"
    assert "1 observed x 2 hidden states, 3 actions, 2 observations, discount 0.95" in lines[1]
    assert "(gap reached)" in lines[3]
    assert lines[-1] == "Policy written to tiger.policyx"
    policy = read_policy("tiger.policyx")
    value = policy.value(0, np.array([0.5, 0.5]))
    assert OPTIMUM.upper[0] - 2e-3 <= value <= OPTIMUM.upper[0]


def test_json_and_trace(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["solve", "tiger.pomdpx", "--json", "--trace", "t.csv", "--out", "p.coadapt"]
    assert main(arguments) == 0
    out, err = capsys.readouterr()
    assert err == ""
    found = json.loads(out)
    assert found["problem"] == "tiger.pomdpx"
    assert found["shape"] == {"observed": 1, "hidden": 2, "actions": 3, "observations": 2}
    assert found["status"] == "gap"
    assert found["lower"] <= OPTIMUM.upper[0]
    assert found["upper"] >= OPTIMUM.lower[0]
    assert found["gap"] == found["upper"] - found["lower"] <= 1e-3
    assert found["policy"] == "p.coadapt"
    assert found["vectors"] == len(read_policy("p.coadapt").vectors)
    for name in ("seconds", "load_seconds", "compile_seconds"):
        assert found[name] >= 0
    with Path("t.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == TRACE
    seconds = [float(row["seconds"]) for row in rows]
    assert seconds == sorted(seconds)
    assert seconds[-1] <= found["seconds"]
    assert int(rows[-1]["backups"]) == found["backups"]
    assert float(rows[-1]["upper"]) == found["upper"]


@pytest.mark.parametrize(
    ("limit", "status"),
    [
        (["--max-backups", "5"], "backups"),
        (["--time-limit", "0"], "time"),
        (["--gap", "30"], "gap"),
    ],
)
def test_limits(capsys: pytest.CaptureFixture[str], limit: list[str], status: str) -> None:
    assert main(["solve", "tiger.pomdpx", "--json", *limit]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["status"] == status
    assert found["gap"] > 1e-3


def test_a_start_policy_is_used(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "tiger.pomdpx"]) == 0
    arguments = ["--start-policy", "tiger.policyx", "--max-backups", "0", "--json"]
    capsys.readouterr()
    assert main(["solve", "tiger.pomdpx", *arguments]) == 0  # and replaced
    found = json.loads(capsys.readouterr().out)
    assert found["backups"] == 0
    assert found["lower"] >= OPTIMUM.upper[0] - 2e-3


def test_a_condensed_policy_is_written(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["solve", "table_clearing_small", "--condense", "--out", "c.coadapt"]
    assert main([*arguments, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    policy = read_policy("c.coadapt")
    assert found["policy_vectors"] == len(policy.vectors) < found["vectors"]
    assert found["lower"] - found["gap"] <= found["policy_lower"] <= found["upper"]
    assert main(arguments) == 0
    assert f"{len(policy.vectors):,} alpha vectors, value at least" in capsys.readouterr().out


def test_every_status_has_words() -> None:
    assert {status.value for status in Status} == set(ENDS)


# The published numbers of states of the collaborations include states that nobody comes to.
@pytest.mark.filterwarnings("ignore:no root leads to:coadapt.MOMDPWarning")
@pytest.mark.parametrize("name", task_names())
def test_a_task(name: str) -> None:
    check_momdp(load_problem(name))


def test_the_paper_task(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "table_clearing", "--json", "--quiet"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["shape"] == {"observed": 52, "hidden": 10, "actions": 3, "observations": 3}
    assert Path("table_clearing.policyx").exists()
    assert found["gap"] <= 1e-3


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "PROBLEM"),
        (["tigre"], "tigre: found no such task, expected a file or one of: grasp_selection, "),
        (["no.pomdp"], "no.pomdp: cannot be read"),
        ([".", "--out", "p.policyx"], "expected .pomdp or .pomdpx"),
        (["./tiger", "--out", "p.policyx"], "expected .pomdp or .pomdpx"),
        (["bad.pomdp"], "bad.pomdp:1: "),
        (["tiger.pomdpx", "--gap", "0"], "--gap must be positive"),
        (["tiger.pomdpx", "--gap", "nan"], "--gap must be positive"),
        (["tiger.pomdpx", "--relative-gap", "-1"], "--relative-gap must lie in [0, 1), not -1.0"),
        (["tiger.pomdpx", "--time-limit", "-1"], "--time-limit must be at least 0"),
        (["tiger.pomdpx", "--max-backups", "-1"], "--max-backups must be at least 0"),
        (["tiger.pomdpx", "--memory-limit", "0"], "--memory-limit"),
        (["tiger.pomdpx", "--memory-limit", "1"], "--memory-limit 1: the first bounds take"),
        (["tiger.pomdpx", "--out", "p.txt"], "p.txt: found a name that ends in '.txt', expected"),
        (["tiger.pomdpx", "--out", "no/p.policyx"], "no/p.policyx: cannot be written: No such"),
        (["tiger.pomdpx", "--out", "dir.policyx"], "dir.policyx: found something else than a file"),
        (["tiger.pomdpx", "--trace", "tiger.pomdpx"], "tiger.pomdpx: found a file that is in use"),
        (["tiger.pomdpx", "--trace", "tiger.policyx"], "found a file that is in use, expected"),
        (["tiger.pomdpx", "--start-policy", "no.policyx"], "no.policyx: cannot be read"),
        (["table_clearing", "--start-policy", "tiger.policy"], "tiger.policy: cannot be the star"),
        (["tiger.pomdpx", "--trace", "no/t.csv"], "no/t.csv: cannot be written: No such"),
    ],
)
def test_an_error_is_one_line_and_writes_nothing(
    capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    Path("bad.pomdp").write_text("states: x\n")
    Path("dir.policyx").mkdir()
    main(["solve", "tiger.pomdpx", "--out", "tiger.policy", "--max-backups", "0"])
    capsys.readouterr()
    before = {path: path.stat().st_mtime_ns for path in Path().iterdir()}
    assert main(["solve", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("coadapt: error: ")
    assert err.count("\n") == 1
    assert words in err
    assert {path: path.stat().st_mtime_ns for path in Path().iterdir()} == before


def endless() -> MOMDP:
    """A problem whose bounds do not meet within a test."""
    rng = np.random.default_rng(0)
    return MOMDP.from_arrays(
        transition_x=rng.dirichlet(np.ones(3), (3, 3, 8)),
        transition_y=rng.dirichlet(np.ones(8), (3, 3, 8)),
        observation=rng.dirichlet(np.ones(4), (3, 3, 8)),
        reward=rng.uniform(-1, 1, (3, 3, 8)),
        discount=0.99,
        roots=[Root(0, np.full(8, 1 / 8))],
    )


def test_an_interrupt_writes_the_policy_so_far(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    write_pomdpx(endless(), "endless.pomdpx")
    begin = solver.SARSOP._search

    def interrupted(*arguments: object) -> Status:
        timer = threading.Timer(0.2, signal.raise_signal, [signal.SIGINT])
        timer.start()
        return begin(*arguments)

    monkeypatch.setattr(solver.SARSOP, "_search", interrupted)
    # A process that was started in the background does not heed it by itself.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        assert main(["solve", "endless.pomdpx", "--gap", "1e-9", "--time-limit", "60"]) == 130
    finally:
        signal.signal(signal.SIGINT, before)
    assert "(interrupted)" in capsys.readouterr().out
    assert len(read_policy("endless.policyx").vectors) > 0


def test_what_the_process_used() -> None:
    memory, seconds = peak_memory_mb(), seconds_since_launch()
    assert memory is None or 10 < memory < 1e5  # Python and numpy take more than 10 MB
    assert seconds is None or seconds > 0
    if sys.platform == "linux":
        assert memory is not None
        assert seconds is not None


def test_the_same_from_python() -> None:
    solution = ca.SARSOP(gap=1e-3).solve(tiger())
    assert main(["solve", "tiger.pomdpx", "--quiet"]) == 0
    assert np.array_equal(read_policy("tiger.policyx").vectors, solution.policy.vectors)


def test_compiling_is_announced(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("coadapt.momdp.sarsop.kernels_are_compiled", lambda: False)
    assert main(["solve", "tiger.pomdpx"]) == 0
    assert capsys.readouterr().err.startswith("compiling the solver once for this machine")
    assert main(["solve", "tiger.pomdpx", "--quiet"]) == 0
    assert capsys.readouterr().err == ""
