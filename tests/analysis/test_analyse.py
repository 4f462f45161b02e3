"""From data to findings: measures, verdicts, and whether the analysis is the declared one."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from coadapt.analysis.analyse import Analysis, analyse, deviations_of, plan_of
from coadapt.analysis.data import read_data
from coadapt.analysis.measures import (
    PAPER_COST,
    person_measures,
    reliabilities,
    scale_scores,
    trial_measures,
)
from coadapt.analysis.record import to_json
from coadapt.analysis.tests import NotTested, TestResult
from coadapt.analysis.tests.power import smallest_effect
from coadapt.analysis.verdicts import put_to_test
from coadapt.report.study.files import make_study_files
from coadapt.study.protocol.reader import template
from tests.analysis.exported import EACH, Tables, export

COUNTS = """condition,optimal_trials,participants
no_adaptation,3,19
mutual_adaptation,0,4
mutual_adaptation,1,7
mutual_adaptation,2,2
mutual_adaptation,3,3
one_way_adaptation,0,15
one_way_adaptation,1,1
one_way_adaptation,2,1
"""
"""Reconstructed from the statistics of Sec. 7.1, see `tests/test_published.py`."""


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Analysis:
    """The analysis of the study as it is."""
    return analyse(read_data(export(tmp_path_factory.mktemp("study") / "x")))


def test_measures(found: Analysis) -> None:
    people = {person.participant: person for person in found.people}
    # p02: mutual adaptation, the first of three trials at the optimal goal.
    person = people["p02"]
    assert person.performance == pytest.approx((11 + 10 + 10) / 3)
    assert (person.optimal_trials, person.switched, person.switch_trial) == (1, True, 1)
    assert (person.steps, person.seconds, person.inputs, person.disagreements) == (3, 4.5, 3, 1)
    # Three steps with an agreement of .75 each.
    assert person.cost == pytest.approx(PAPER_COST * 0.75)
    # 0 · .25 + .5 · .25 + 1 · .5
    assert person.alpha == pytest.approx(0.625)
    trial = next(t for t in found.trials if t.participant == "p02" and t.trial == 1)
    # The belief goes .2, .5, .8; it is above one half in the third step.
    assert trial.switch_step == 2
    # The belief over α of a robot that infers none never moves.
    assert people["p01"].alpha is None and people["p03"].alpha is None


def test_the_declared_analysis(found: Analysis) -> None:
    assert found.plan.status == "declared"
    assert [(t.hypothesis, t.outcome) for t in found.tested] == [
        ("H1", "performance"),
        ("H2", "trust"),
        ("H2", "collaboration"),
    ]
    assert found.deviations == tuple(
        f"{name}: 17 planned, {EACH} analysed." for name in found.data.conditions
    )


def test_a_changed_protocol_is_told(tmp_path: Path) -> None:
    changed = template().replace(b"correction = ", b'compare = "all"\ncorrection = ')
    data = read_data(export(tmp_path / "x", protocol=changed))
    plan = plan_of(data)
    assert plan.status == "changed"
    (tested,) = put_to_test(plan.hypotheses[0], person_measures(data, trial_measures(data)))
    assert len(tested.pairs) == 3
    assert all(isinstance(p.found, TestResult) and p.found.comparisons == 3 for p in tested.pairs)
    assert plan.text in deviations_of(data, plan, (tested,))


def test_another_plan_is_told(tmp_path: Path) -> None:
    plan = tmp_path / "plan.toml"
    plan.write_bytes(template() + b"\n# changed afterwards\n")
    found = plan_of(read_data(export(tmp_path / "x"), plan))
    assert found.status == "changed"
    assert "plan.toml is another" in found.text


def test_nothing_declared(tmp_path: Path) -> None:
    bare = template().split(b"[[hypotheses]]")[0]
    found = plan_of(read_data(export(tmp_path / "x", protocol=bare)))
    assert found.status == "published"
    assert [h.name for h in found.hypotheses] == ["H1", "H2"]


def test_published_counts(tmp_path: Path) -> None:
    (tmp_path / "counts.csv").write_text(COUNTS)
    found = analyse(read_data(tmp_path / "counts.csv"))
    (tested,) = found.tested
    assert tested.verdict == "supported"
    assert isinstance(tested.overall, TestResult)
    # Sec. 7.1: χ²(2) = 39.84, p < .001; U = 28.5, p < .001; U = 49.5, p = .001
    assert round(tested.overall.statistic, 2) == 39.84 and tested.overall.p < 0.001
    first, second = (pair.found for pair in tested.pairs)
    assert isinstance(first, TestResult) and isinstance(second, TestResult)
    assert (first.statistic, second.statistic) == (28.5, 49.5)
    assert first.adjusted < 0.001 and round(second.adjusted, 3) == 0.001
    assert any("differ from the questionnaire’s" in note for note in found.data.notes)
    assert any("H2 is not tested" in text for text in found.deviations)
    welch = tested.sensitivity[1]
    assert isinstance(welch, NotTested) and "no_adaptation are the same" in welch.reason


def test_other_group_sizes_bring_no_note(tmp_path: Path) -> None:
    (tmp_path / "counts.csv").write_text(COUNTS.replace("3,19", "3,18"))
    data = read_data(tmp_path / "counts.csv")
    assert not any("questionnaire" in note for note in data.notes)


def test_verdicts(found: Analysis) -> None:
    trust = found.tested[1]
    # One-way and mutual are rated alike, both far above no adaptation.
    assert trust.verdict == "partly supported"
    by_pair = {(p.higher, p.lower): p for p in trust.pairs}
    alike = by_pair["one_way_adaptation", "mutual_adaptation"]
    apart = by_pair["mutual_adaptation", "no_adaptation"]
    assert apart.holds and apart.equivalence is None
    assert not alike.holds and alike.equivalence is not None
    assert by_pair["one_way_adaptation", "no_adaptation"].declared is False


def test_against_the_hypothesis_is_not_support(tmp_path: Path) -> None:
    def change(tables: Tables) -> None:
        for answer in tables["answers"]:
            answer["value"] = 6 - answer["value"]

    found = analyse(read_data(export(tmp_path / "x", change)))
    trust = found.tested[1]
    assert isinstance(trust.overall, TestResult) and trust.overall.p < 0.05
    assert trust.verdict == "not supported"
    assert {p.direction for p in trust.pairs if p.declared} <= {"against it", "equal"}


def test_constant_data_are_told_and_do_not_fail(tmp_path: Path) -> None:
    def change(tables: Tables) -> None:
        for answer in tables["answers"]:
            answer["value"] = 4
        for trial in tables["trials"]:
            trial.update({"reward": 11.0, "at_optimal": "true"})

    found = analyse(read_data(export(tmp_path / "x", change)))
    assert {t.verdict for t in found.tested} == {"not tested"}
    assert all(isinstance(t.overall, NotTested) for t in found.tested)
    assert sum("nothing differs" in text for text in found.deviations) >= 3
    assert "NaN" not in to_json(found).decode()
    assert all(scale.alpha is None and scale.notes for scale in found.scales)


def test_json_holds_every_number_and_no_nan(found: Analysis) -> None:
    record = json.loads(to_json(found))
    assert record["format"] == 1
    assert len(record["participants"]) == 3 * EACH and len(record["trials"]) == 9 * EACH
    assert {"python", "numpy", "scipy", "statsmodels", "coadapt"} <= set(record["versions"])
    (pair, _) = record["tested"][0]["pairs"]
    details = pair["found"]["details"]
    assert details["U_min"] == min(details["U1"], details["U2"])


def test_reversed_items_are_turned_once(found: Analysis, tmp_path: Path) -> None:
    turned = template().replace(
        b'name = "trust_trustworthy"', b'name = "trust_trustworthy"\nreversed = true'
    )

    def change(tables: Tables) -> None:
        for answer in tables["answers"]:
            if answer["item"] == "trust_trustworthy":
                answer["value"] = 6 - answer["value"]

    crooked = read_data(export(tmp_path / "y", change, turned))
    assert scale_scores(crooked) == {p.participant: p.scores for p in found.people}
    assert reliabilities(crooked)[0].alpha == found.scales[0].alpha


@pytest.mark.parametrize(("sizes", "expected"), [((17, 17, 17), 0.8), ((10, 30), 0.8)])
def test_smallest_effect_is_found_as_often_as_it_says(
    sizes: tuple[int, ...], expected: float
) -> None:
    # By simulation, from the definition of η² in the population.
    from scipy import stats

    rng, share = np.random.default_rng(3), smallest_effect(sizes)
    n, means = sum(sizes), np.zeros(len(sizes))
    # Only the first group differs; its weight among all gives the variance of the means.
    weight = sizes[0] / n
    means[0] = math.sqrt(share / (1 - share) / (weight * (1 - weight)))
    runs = 2000
    found = stats.f_oneway(
        *(rng.normal(m, 1.0, (runs, k)) for m, k in zip(means, sizes, strict=True)), axis=1
    )
    # Three standard errors of a share of .8 in 2,000 are .027.
    assert (found.pvalue < 0.05).mean() == pytest.approx(expected, abs=0.027)


def test_what_newer_exports_say_of_the_robots_and_the_protocol(tmp_path: Path) -> None:
    folder = export(tmp_path / "x")
    older = analyse(read_data(folder))
    assert older.data.disagreement_cost is None
    assert older.data.notes == ()
    for name, more in (
        ("materials/model.json", {"disagreement_cost": -0.5}),
        (
            "export.json",
            {
                "protocol_changes": [{"at": "2026-05-04T10:00:00+00:00", "values": ["trials"]}],
                "protocol_edited": ["title", "rewards.optimal"],
            },
        ),
    ):
        path = folder / name
        path.write_text(json.dumps({**json.loads(path.read_text()), **more}))
    found = analyse(read_data(folder))
    for trial, before in zip(found.trials, older.trials, strict=True):
        assert before.cost == pytest.approx(PAPER_COST * (before.expected_disagreement or 0))
        assert trial.cost == pytest.approx(-0.5 * (trial.expected_disagreement or 0))
    changed, edited = found.data.notes
    assert "on 2026-05-04T10:00:00+00:00: trials" in changed
    assert "title, rewards.optimal" in edited
    page = make_study_files(found)["report.html"].decode()
    assert "times C = −0.50,\nthat of the robots" in page
    assert changed in page
