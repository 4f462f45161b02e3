"""The parts of the benchmarks that can go wrong unseen."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import coadapt as ca
from coadapt.human.features import action_counts

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"

# Shaped like what the reference prints; the numbers are made up.
PRINTED = """
Loading the model ...
  input file   : Tiger.pomdp
  loading time : 0.25s

SARSOP initializing ...
  initialization time : 0.04s

-------------------------------------------------------------------------------
 Time   |#Trial |#Backup |LBound    |UBound    |Precision  |#Alphas |#Beliefs
-------------------------------------------------------------------------------
 0.04    0       0        -20        92.8205    112.821     4        1
 0.5     5       101      10         2.5e+01    15          9        16
 2       9       155      12         20         8           8        21
 4.5     10      202      12         14         2           8        21
-------------------------------------------------------------------------------

SARSOP finishing ...
  Preset timeout reached
"""


@pytest.fixture(scope="module")
def modules() -> Any:
    sys.path.insert(0, str(BENCHMARKS))
    try:
        import agreement
        import comparison
        import features
        import growth
        import solve_report
        import solvers
    finally:
        sys.path.remove(str(BENCHMARKS))
    return SimpleNamespace(
        agreement=agreement,
        comparison=comparison,
        features=features,
        growth=growth,
        solvers=solvers,
        report=solve_report,
    )


def ended(modules: Any, printed: str) -> Any:
    return modules.solvers.Ended(
        code=0, out=printed, err="", cpu_seconds=5.0, wall_seconds=10.0, memory_mb=7.0
    )


def run(modules: Any, *points: tuple[float, float, float], finished: bool = False) -> Any:
    trace = tuple(modules.comparison.Point(*point) for point in points)
    return modules.comparison.Run(
        trace=trace,
        finished=finished,
        seconds=trace[-1].seconds,
        load_seconds=0.0,
        vectors=1,
        backups=1,
        memory_mb=None,
        status="gap" if finished else "time",
        cpu_seconds=0.004,
        wall_seconds=0.008,
    )


def test_the_printed_table_is_read(modules: Any) -> None:
    found = modules.solvers.parse_reference(ended(modules, PRINTED))
    assert [(p.seconds, p.lower, p.upper) for p in found.trace] == [
        (0.04, -20, 92.8205),
        (0.5, 10, 25),
        (2, 12, 20),
        (4.5, 12, 14),
    ]
    assert not found.finished
    assert (found.seconds, found.load_seconds, found.vectors, found.backups) == (4.5, 0.25, 8, 202)
    assert found.share == 0.5
    done = modules.solvers.parse_reference(ended(modules, PRINTED + "target precision reached"))
    assert done.finished


def test_a_reference_without_bounds_has_failed(modules: Any) -> None:
    with pytest.raises(modules.solvers.Failed, match="Syntax error"):
        modules.solvers.parse_reference(ended(modules, "Loading\nSyntax error\n\n"))


@pytest.mark.parametrize(
    ("value", "half"), [(19.3711, 5e-5), (-5.96714, 5e-6), (1000.0, 5e-3), (0.0, 0.0)]
)
def test_half_of_the_last_printed_digit(modules: Any, value: float, half: float) -> None:
    assert modules.comparison.rounding(value) == pytest.approx(half)


def test_times_to_the_bounds_of_an_unfinished_reference(modules: Any) -> None:
    reference = modules.solvers.parse_reference(ended(modules, PRINTED))
    # 11.999996 prints as 12; 14.1 and 11.9 miss.
    ours = run(modules, (0.1, 0, 50), (0.2, 11.999996, 14.1), (0.4, 11.999996, 13.9))
    found = modules.comparison.compare(reference, ours, 4.0, 3.0)
    # Within 4 s: the line of 2 s, 12 and 20. It has the whole limit to its account.
    assert (found.lower, found.upper) == (12, 20)
    assert str(found.reference) == "4"
    assert (found.reference_lower.seconds, found.reference_upper.seconds) == (2, 2)
    assert [t.seconds for t in (found.ours_lower, found.ours_upper, found.ours)] == [0.2, 0.2, 0.2]
    assert found.ratio.value == pytest.approx(4 / 0.2)
    assert found.ratio_upper.value == pytest.approx(2 / 0.2)
    assert found.agree
    later = modules.comparison.compare(reference, ours, 5.0, 3.0)
    assert (later.upper, later.reference_lower.seconds, later.ours.seconds) == (14, 2, 0.4)


def test_what_is_not_reached_is_a_limit(modules: Any) -> None:
    reference = run(modules, (1, 5, 6))
    ours = run(modules, (0.1, 4, 5.5), (2.9, 4.9, 5.5))
    found = modules.comparison.compare(reference, ours, 10.0, 3.0)
    assert (str(found.ours_lower), str(found.ours_upper), str(found.ours)) == (">3", "0.1", ">3")
    assert str(found.ratio) == "<3.33"  # 10 / 3
    assert str(found.ratio_lower) == "<0.333"
    assert str(found.ratio_upper) == "10"


def test_a_finished_reference_is_raced_to_the_end(modules: Any) -> None:
    reference = run(modules, (0.5, 1, 3), (0.8, 2, 2.001), finished=True)
    # Ours ends with another interval of the same width.
    ours = run(modules, (0.1, 1, 3), (0.2, 1.9995, 2.0005), finished=True)
    found = modules.comparison.compare(reference, ours, 60.0, 60.0)
    assert (found.reference.seconds, found.ours.seconds) == (0.8, 0.2)
    assert (found.ours_lower.seconds, found.ours_upper.seconds) == (0.2, 0.2)
    assert found.ratio.value == pytest.approx(4)


def test_times_below_the_clock_are_limits(modules: Any) -> None:
    reference = run(modules, (0.0, 2, 2.001), finished=True)
    ours = run(modules, (0.002, 2, 2.001), finished=True)
    found = modules.comparison.compare(reference, ours, 60.0, 60.0)
    # Its whole process took 0.004 s, less than the clock's step.
    assert str(found.reference) == "<0.004"
    assert str(found.ratio) == "<2"


def test_contradicting_bounds_are_seen(modules: Any) -> None:
    found = modules.comparison.compare(
        run(modules, (1, 5, 6)), run(modules, (1, 6.1, 7)), 10.0, 10.0
    )
    assert not found.agree


def test_the_geometric_mean(modules: Any) -> None:
    ratio = modules.comparison.Ratio
    assert str(modules.comparison.geometric_mean([ratio(2), ratio(8)])) == "4"
    assert str(modules.comparison.geometric_mean([ratio(2), ratio(8, "<")])) == "<4"


def test_the_report_has_every_problem(modules: Any, tmp_path: Path) -> None:
    reference, ours = run(modules, (1, 5, 6)), run(modules, (0.5, 5, 6))
    both = modules.report.Result("both", reference, ours)
    both.comparison = modules.comparison.compare(reference, ours, 10.0, 10.0)
    both.confirmation = {"mean": 4.8, "standard_error": 0.05, "truncation": 0.06, "episodes": 100}
    neither = modules.report.Result("neither", notes=["not there"])
    text = modules.report.markdown([both, neither], [], (10.0, 10.0))
    assert "| both | 10 | 5 | 6 | 1 | 1 | 0.5 | 0.5 | 0.5 | 2 | 2 | 20 |" in text
    assert "over 1 problems: 2 to the lower bound, 2 to the upper, 20 to both" in text
    # 4.8 + 3 * 0.05 is 4.95; episodes cut off might make it 5.01.
    assert both.confirmed == "open"
    both.confirmation["mean"] = 4.9
    assert both.confirmed == "yes"
    both.confirmation["mean"] = 4.7
    assert both.confirmed == "NO"
    modules.report.write_csv([both, neither], tmp_path / "solve.csv")
    assert len((tmp_path / "solve.csv").read_text().splitlines()) == 3


def test_plans_by_features_come_close(modules: Any) -> None:
    # The table in docs/explanation/histories.md; each plan's value is certified by its bounds in
    # its own model, and what it earns with a person who remembers everything by `evaluate_all`.
    model = ca.SharedAutonomy(ca.worlds.table_clearing(11, 3), memory=4, step_cost=1.2)
    windows, lower, upper, earned = modules.features.follow(model, None)
    assert windows == 778
    assert lower - 1e-3 <= earned <= upper + 1e-3
    fewer, _, _, counted = modules.features.follow(model, action_counts)
    assert fewer == 192
    assert upper - 2e-3 <= counted <= upper + 1e-3
    # Looking at the present state alone costs ten times as much, and says otherwise.
    least, promised, _, blind = modules.features.follow(model, lambda states, actions: 0)
    assert least == 33
    assert blind < upper - 5e-3 < promised


def test_problems_grow_as_predicted(modules: Any) -> None:
    # Sec. 7: linear in 1/dt and in modes; the bound for memory counts what lies beyond goals too.
    for row in modules.growth.rows():
        if row.series == "memory":
            assert 0.94 * row.predicted <= row.size <= row.predicted
        else:
            assert row.size == row.predicted


def test_a_penalty_for_other_actions_overrides_fewer_inputs(modules: Any) -> None:
    # The table in docs/explanation/match-rule-or-penalty.md.
    model = ca.SharedAutonomy(ca.worlds.table_clearing())
    plain = modules.agreement.evaluate(model, 0.0, rule=False)
    priced = modules.agreement.evaluate(model, -0.1, rule=False)
    for without, with_penalty in zip(plain, priced, strict=True):
        assert with_penalty.overridden < without.overridden - 0.5
        assert with_penalty.disagreement < without.disagreement + 0.05
