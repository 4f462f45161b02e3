"""The figures of sweeps: what they need, and that they show the numbers of the table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from coadapt.errors import InputError
from coadapt.report.maps import points
from coadapt.report.maps.draw import draw, figures_of
from coadapt.report.maps.phase_map import edges
from coadapt.simulation.sweep import Grid, Layout, Sweep, lay_out, run_sweep
from tests.simulation.sweep.inline import InlineWorkers

COSTS, GAPS, ALPHAS = (-0.4, -0.1), (0.5, 1.5, 2.0), (0.0, 1.0)
OTHER = {"adaptability": 0, "mode": "other"}
ALL = {"adaptability": list(ALPHAS), "mode": "other"}
AXES = {"task": "table_clearing_small", "disagreement_cost": COSTS, "reward_gap": GAPS, "gap": 0.01}
ENDS = ("one_way_adaptation", "no_adaptation")

Drawn = tuple[Layout, Path, dict[str, points.Record]]

PHASES = Grid(partner=OTHER, exact=True, tolerance=0.01, episodes=0, figure="phases", **AXES)
OUTCOMES = Grid(
    partner={"adaptability": 1, "mode": "other"}, episodes=20, figure="outcomes", **AXES
)
TRADE = Grid(partner=ALL, figure="trade_off", **AXES | {"reward_gap": 1.0})
TRADE_ENDS = Grid(
    partner=ALL, robot=ENDS, figure="trade_off", task="table_clearing_small", reward_gap=1.0
)


def layout(*grids: Grid) -> Layout:
    return lay_out(Sweep(name="maps", grid=grids, episodes=20))


@pytest.fixture(scope="module")
def drawn(
    tmp_path_factory: pytest.TempPathFactory,
) -> Drawn:
    """A sweep that was run and drawn, with its rows."""
    found, out = layout(PHASES, OUTCOMES, TRADE, TRADE_ENDS), tmp_path_factory.mktemp("maps")
    table = run_sweep(found.cells, out, InlineWorkers).table
    written = draw(figures_of(found), table, out)
    assert [p.name for p in written] == [
        f"{name}.{kind}" for name in ("phase_map", "trade_off") for kind in ("svg", "png")
    ]
    return found, out, {str(row["cell"]): row for row in table.rows()}


def test_maps_hold_the_numbers_of_the_table(
    drawn: Drawn,
) -> None:
    found, _, rows = drawn
    figures = figures_of(found)
    for figure, name in ((figures.phases, "exact_optimal"), (figures.outcomes[0], "optimal")):
        assert figure is not None
        assert (tuple(figure.costs), tuple(figure.gaps)) == (COSTS, GAPS)
        values = figure.values(rows, name)
        for (i, j), value in np.ndenumerate(values):
            row = rows[figure.keys[i][j]]
            assert (row["reward_gap"], row["disagreement_cost"]) == (GAPS[i], COSTS[j])
            assert value == row[name]
    curve = figures.trade_off
    assert curve is not None
    assert (curve.costs, curve.alphas, curve.gap) == (COSTS, ALPHAS, 1.0)
    for j, i in np.ndindex(2, 2):
        row = rows[curve.keys[j][i]]
        assert (row["disagreement_cost"], row["partner_adaptability"]) == (COSTS[j], ALPHAS[i])
        assert curve.curve(rows, "reward")[j, i] == row["reward"]
    for robot in ENDS:
        assert [rows[key]["robot"] for key in curve.ends[robot]] == [robot] * 2


def test_figures_say_what_they_show(drawn: Drawn) -> None:
    _, out, _ = drawn
    trade = (out / "trade_off.svg").read_text()
    for text in ("No adaptation", "One-way adaptation", "Mutual adaptation", "C = −0.4"):
        assert text in trade
    assert (
        "What the robot does with somebody who never adapts" in (out / "phase_map.svg").read_text()
    )
    assert (out / "phase_map.png").read_bytes().startswith(b"\x89PNG")


def test_the_mark_is_the_task_s_own_setting() -> None:
    mark = figures_of(layout(PHASES)).mark
    assert mark is not None
    assert (mark.label, mark.cost) == ("table_clearing_small", -0.32)
    assert mark.gap == pytest.approx(1.0)


def test_the_edges_of_cells() -> None:
    assert edges(np.array([0.0, 1.0, 3.0])).tolist() == [-0.5, 0.5, 2.0, 4.0]


@pytest.mark.parametrize(
    ("grid", "problem"),
    [
        ({"exact": False, "episodes": 5}, "phases needs exact evaluation, found none"),
        ({"partner": ALL}, "phases needs people with alpha 0, found alpha 1"),
        ({"partner": {"adaptability": 0}}, 'phases needs people with mode = "other"'),
        ({"robot": "no_adaptation"}, "phases needs mutual_adaptation alone, found no_adaptation"),
        ({"reward_gap": 1.0}, "phases needs a grid over disagreement_cost and reward_gap"),
        ({"memory": (1, 2)}, "phases needs one value of memory, found several"),
    ],
)
def test_what_a_map_needs(grid: dict[str, object], problem: str) -> None:
    values = {n: getattr(PHASES, n) for n in Grid.__struct_fields__} | grid
    with pytest.raises(InputError, match=problem):
        figures_of(layout(Grid(**values)))


def test_what_a_trade_off_needs() -> None:
    with pytest.raises(InputError, match="has no cell of one_way_adaptation at C = 0, alpha = 0"):
        figures_of(layout(TRADE))
