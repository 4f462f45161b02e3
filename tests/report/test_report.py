"""The report on the paper's task: what it found, and the files that say so."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

import coadapt as ca
from coadapt.cli import main
from coadapt.errors import InputError
from coadapt.report.performance import distances
from coadapt.report.provenance import parameters
from coadapt.report.reproduce import Reproduction, Settings, reproduce
from coadapt.report.tables import to_json
from coadapt.report.write import make_files, write_files
from tests.report.conftest import small_settings

LEFT, FORWARD, RIGHT = range(3)
R_SUB, R_OPT = 10.0, 11.0  # Sec. 6.5
PICTURES = ("bounds", "conditions", "performance", "sample_user_1", "sample_user_2")


@pytest.fixture(scope="session")
def results(files: dict[str, bytes]) -> dict[str, Any]:
    """What ``results.json`` holds."""
    return json.loads(files["results.json"])


def test_performance_is_as_the_paper_describes_it(results: dict[str, Any]) -> None:
    """Sec. 5.4: the more adaptable the user the better, and above R_sub for alpha = 0."""
    performance = results["performance"]
    assert performance["alpha"] == [0, 0.25, 0.5, 0.75, 1]
    exact = performance["exact"]
    assert exact == sorted(exact)
    assert R_SUB < exact[0] < R_SUB + 0.25
    assert R_OPT - 0.25 < exact[-1] < R_OPT
    assert results["performance_with_match_rule"]["alpha"] == performance["alpha"]


@pytest.mark.parametrize("kind", ["performance", "performance_with_match_rule"])
def test_simulation_agrees_with_the_exact_numbers(results: dict[str, Any], kind: str) -> None:
    p = results[kind]
    for exact, mean, error in zip(p["exact"], p["simulated"], p["standard_error"], strict=True):
        assert 0 < error < 0.02  # at most 0.5 / sqrt(1000) for rewards of 10 or 11
        assert abs(mean - exact) < 4 * error


def test_distances_count_standard_errors(found: Reproduction) -> None:
    robot = found.robot("mutual_policy")
    for apart, exact, simulated in zip(
        distances(robot, R_SUB, R_OPT), robot.exact, robot.simulated, strict=True
    ):
        by_sample = abs(exact.reward - simulated.reward.mean) / simulated.reward.standard_error
        assert apart == pytest.approx(by_sample, rel=0.2, abs=0.1)


def test_bounds_hold_the_value_at_every_first_input(
    results: dict[str, Any], found: Reproduction
) -> None:
    roots = results["roots"]
    assert roots["observation"] == ["left", "forward", "right"]
    gaps = np.subtract(roots["upper"], roots["lower"])
    assert np.all(gaps >= 0)
    assert np.all(gaps <= found.settings.gap)
    # Eq. 6: no return exceeds R_opt after the 9 moves of a shortest path.
    assert max(roots["upper"]) < R_OPT * 0.99**9
    weights = np.array(roots["probability"])
    assert weights.sum() == pytest.approx(1)
    # A user drawn from the prior gets the policy's value; the policy is worth its lower bound.
    model = found.settings.model
    robot = ca.robots.MutualAdaptation(
        model, _policy(found), ca.robots.MatchRule(threshold=float("inf"))
    )
    value = np.mean(
        [ca.evaluate(robot, ca.SimulatedPartner(a)).discounted_return for a in model.alpha.values]
    )
    # Episodes left unfinished, at most 0.001 of them, are left out of the return.
    assert value == pytest.approx(float(weights @ roots["lower"]), abs=0.012)


def _policy(found: Reproduction) -> ca.AlphaVectorPolicy:
    from coadapt.momdp.sarsop import SARSOP

    return SARSOP(gap=found.settings.gap).solve(found.settings.model.to_momdp()).policy


def test_conditions_are_ordered_as_the_paper_expects(found: Reproduction) -> None:
    """H1 for the robots alone, and the disagreement that the paper sets against it (Sec. 7)."""
    none, mutual, one_way = found.conditions
    for a, b, c in zip(none.exact, mutual.exact, one_way.exact, strict=True):
        assert a.reward > b.reward > c.reward
        assert a.disagreement > b.disagreement > c.disagreement
    assert all(p == pytest.approx(1) for p in none.optimal)
    assert [e.steps for e in none.exact] == pytest.approx([9.0] * 5)  # 6 sideways, 3 forward
    assert one_way.optimal[0] < 0.001  # a stubborn user gets their own goal


def test_match_rule_overrides_fewer_inputs(found: Reproduction) -> None:
    policy, rule = found.robot("mutual_policy"), found.robot("mutual_rule")
    for without, with_rule in zip(policy.exact, rule.exact, strict=True):
        assert with_rule.overridden < without.overridden
        assert with_rule.discounted_return < without.discounted_return


def test_stubborn_user_ends_at_their_own_goal(found: Reproduction) -> None:
    run = found.samples[0]
    assert run.adaptability == 0
    assert set(run.episode.modes) == {0}
    assert run.episode.inputs[:3] == (LEFT, LEFT, LEFT)
    assert run.episode.actions[:2] == (FORWARD, FORWARD)
    assert run.episode.goal == 0
    assert run.episode.decisions[-1].adaptability_belief.argmax() == 0


def test_user_who_turns_ends_at_the_optimal_goal(found: Reproduction) -> None:
    run = found.samples[1]
    assert run.adaptability == 0.75
    assert run.episode.inputs[:3] == (LEFT, LEFT, RIGHT)
    assert run.episode.actions[:2] == (FORWARD, FORWARD)
    assert run.episode.goal == 1
    last = run.episode.decisions[-1]
    assert last.mode_belief.argmax() == 1
    assert last.adaptability_belief[0] < 0.01


@pytest.mark.parametrize("name", PICTURES)
def test_figures_are_drawn(files: dict[str, bytes], name: str) -> None:
    assert files[f"figures/{name}.png"].startswith(b"\x89PNG\r\n\x1a\n")
    svg = files[f"figures/{name}.svg"].decode()
    assert ElementTree.fromstring(svg).tag.endswith("svg")
    assert "<text" in svg  # real text, not outlines
    assert "<dc:date>" not in svg


def test_filmstrip_shows_every_step(files: dict[str, bytes], found: Reproduction) -> None:
    for run in found.samples:
        svg = files[f"figures/sample_user_{run.user}.svg"].decode()
        shown = [int(t) for t in re.findall(r">T = (\d+)</text>", svg)]
        assert shown == list(range(1, run.episode.steps + 1))
        assert f"α = {run.adaptability:g}" in svg


@pytest.fixture(scope="session")
def page(files: dict[str, bytes]) -> str:
    return files["report.html"].decode()


def test_page_is_well_formed(page: str) -> None:
    assert page.startswith("<!DOCTYPE html>")
    root = ElementTree.fromstring(page)
    names = [element.get("id") for element in root.iter() if element.get("id")]
    assert len(names) == len(set(names))
    links = re.findall(r'(?:href="|url\()#([^")]+)', page)
    assert links
    assert set(links) <= set(names)
    assert all(table.find("caption") is not None for table in root.iter("table"))
    assert all(figure.find("figcaption") is not None for figure in root.iter("figure"))
    pictures = [element for element in root.iter("div") if element.get("role") == "img"]
    assert len(pictures) == len(PICTURES)
    assert all(picture.get("aria-label") for picture in pictures)


def test_page_needs_nothing_else(page: str) -> None:
    assert not re.search(r"https?:|<script|<link|<img|@import|src=", page)


def test_page_says_who_chose_each_parameter(page: str, results: dict[str, Any]) -> None:
    root = ElementTree.fromstring(page)
    table = next(t for t in root.iter("table") if t.get("id") == "parameter-table")
    rows = ["".join(row.itertext()) for row in table.iter("tr")]
    assert len(rows) == len(results["parameters"]) + 1
    origins = {p["name"]: p["origin"] for p in results["parameters"]}
    assert origins["Cost of disagreement C"] == "paper"
    assert origins["Simulated runs per adaptability"] == "paper"
    for name in ("Discount γ", "Step cost c of the modal policies", "Threshold of the match rule"):
        assert origins[name] == "ours"


def test_a_changed_parameter_of_the_paper_is_ours(found: Reproduction) -> None:
    changed = replace(found, settings=replace(found.settings, runs=999))
    runs = next(p for p in parameters(changed) if p.name == "Simulated runs per adaptability")
    assert (runs.value, runs.origin) == ("999", "ours")
    assert "Sec. 5.4 has 1000" in runs.source


def test_page_colours_are_variables(page: str) -> None:
    style = page[page.index("<style>") : page.index("</style>")]
    used = set(re.findall(r"var\((--[\w-]+)\)", page))
    assert used <= set(re.findall(r"(--[\w-]+):", style))
    assert not re.search(r"#[0-9a-f]{6}", page[page.index("</style>") :])


def test_json_keeps_its_layout(results: dict[str, Any]) -> None:
    assert results["format"] == 1
    assert set(results["performance"]) >= {"alpha", "exact", "simulated", "standard_error"}
    assert set(results["roots"]) >= {"observation", "lower", "upper"}
    assert [i["key"] for i in results["identities"]] == [
        *("one_way", "no_penalty", "fully_adaptable")
    ]
    assert all(identity["holds"] for identity in results["identities"])
    assert len(results["conditions"]) == 5
    assert results["planner"]["mutual_adaptation"]["observed_states"] == 52  # Sec. 6.5
    assert results["planner"]["mutual_adaptation"]["hidden_states"] == 10


def test_tables_hold_the_numbers_of_the_json(
    files: dict[str, bytes], results: dict[str, Any]
) -> None:
    rows = list(csv.DictReader(io.StringIO(files["tables/performance.csv"].decode())))
    exact = [float(row["exact"]) for row in rows if row["match_rule"] == "false"]
    assert exact == results["performance"]["exact"]
    steps = list(csv.DictReader(io.StringIO(files["tables/samples.csv"].decode())))
    for sample in results["samples"]:
        mine = [row for row in steps if int(row["user"]) == sample["user"]]
        assert [row["action"] for row in mine] == sample["actions"]
        assert [float(row["belief_alpha_0"]) for row in mine] == [
            belief[0] for belief in sample["belief_adaptability"]
        ]


def test_same_seed_gives_the_same_bytes() -> None:
    first, again = (make_files(reproduce(small_settings())) for _ in range(2))
    assert first == again
    assert to_json(reproduce(small_settings(seed=1))).encode() != first["results.json"]


def test_only_our_files_are_replaced(tmp_path: Path) -> None:
    (tmp_path / "report.html").write_text("old")
    (tmp_path / "mine.txt").write_text("mine")
    write_files({"report.html": b"new", "figures/a.svg": b"a"}, tmp_path)
    assert (tmp_path / "report.html").read_bytes() == b"new"
    assert (tmp_path / "mine.txt").read_text() == "mine"
    left = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*")}
    assert left == {"report.html", "mine.txt", "figures", "figures/a.svg", "tables"}


@pytest.mark.parametrize(
    ("changed", "message"),
    [({"runs": 1}, "runs"), ({"seed": -1}, "seed"), ({"gap": 0.0}, "gap"), ({"gap": 1.0}, "gap")],
)
def test_settings_out_of_range_are_refused(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Settings(**changed)


def test_equal_goals_are_refused() -> None:
    world = ca.worlds.table_clearing(7, 3, right_reward=10.0)
    with pytest.raises(ValueError, match="two goals of different reward"):
        reproduce(Settings(model=ca.SharedAutonomy(world)))


def test_unwritable_directory_is_found_before_the_work(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    with pytest.raises(InputError, match="cannot write"):
        write_files({}, blocked / "inside")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--runs", "1"], "--runs must be at least 2, not 1"),
        (["--gap", "nan"], "--gap must be a number from 1e-06 to 0.1, not nan"),
        (["--out", "file/inside"], "file/inside: cannot write"),
        (["--out", "file"], "Invalid value for '--out'"),
    ],
)
def test_command_refuses_in_one_line(
    options: list[str],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("file").write_text("")
    assert main(["reproduce", *options]) == 2
    output = capsys.readouterr()
    assert output.out == ""
    assert output.err.count("\n") == 1
    assert message in output.err


@pytest.fixture
def computed(monkeypatch: pytest.MonkeyPatch, found: Reproduction) -> None:
    """The command, its work done already."""

    def instead(settings: Settings, progress: Callable[[str], None]) -> Reproduction:
        assert (settings.runs, settings.seed, settings.gap) == (1000, 0, 1e-3)
        progress("Solving the task")
        return found

    monkeypatch.setattr("coadapt.report.reproduce.reproduce", instead)


@pytest.mark.usefixtures("computed")
def test_command_writes_the_report(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "new" / "reproduction"
    assert main(["reproduce", "--out", str(out)]) == 0
    output = capsys.readouterr()
    assert output.out.splitlines()[-1].endswith(str(out / "report.html"))
    assert "Solving the task" in output.err.splitlines()
    assert {path.suffix for path in (out / "figures").iterdir()} == {".svg", ".png"}
    assert (out / "report.html").stat().st_mode & 0o444


@pytest.mark.usefixtures("computed")
def test_command_prints_one_json_object(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["reproduce", "--out", str(tmp_path), "--json", "--quiet"]) == 0
    output = capsys.readouterr()
    assert output.err == ""
    assert json.loads(output.out) == json.loads((tmp_path / "results.json").read_text())
