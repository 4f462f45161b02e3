"""From a sweep to its cells: the product, its order, keys and random streams."""

from __future__ import annotations

from itertools import pairwise, product
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.errors import FileError, InputError
from coadapt.requirements import FieldError
from coadapt.robots.setup import RobotSetup
from coadapt.simulation.sweep import Cell, Grid, Range, Sweep, lay_out, parse_sweep
from coadapt.tasks import load_task

PARTNER = {"adaptability": 0.5}


def cells(*grids: Grid, **values: object) -> tuple[Cell, ...]:
    return lay_out(Sweep(name="test", grid=grids, **values)).cells  # pyright: ignore


def test_all_combinations_in_order() -> None:
    costs, gaps, alphas, seeds = (-0.4, -0.2), (0.5, 1.0), (0.0, 1.0), (1, 2)
    grid = Grid(disagreement_cost=costs, reward_gap=gaps, partner={"adaptability": list(alphas)})
    found = [
        (
            cell.setup.right_reward - cell.setup.left_reward,
            cell.setup.disagreement_cost,
            cell.partner["adaptability"],
            cell.seed,
        )
        for cell in cells(grid, seed=seeds)
        if isinstance(cell.setup, RobotSetup)
    ]
    # The order of the parameters in `Grid`, not that in which they were given.
    assert found == list(product(gaps, costs, alphas, seeds))


def test_a_range_is_what_one_would_write() -> None:
    assert Range(-0.4, 0.0, 5).values == (-0.4, -0.3, -0.2, -0.1, 0.0)
    written = cells(Grid(disagreement_cost=(-0.4, -0.3, -0.2, -0.1, 0.0), partner=PARTNER))
    ranged = cells(Grid(disagreement_cost=Range(-0.4, 0.0, 5), partner=PARTNER))
    assert [c.key for c in written] == [c.key for c in ranged]


@given(
    st.floats(-1000, 1000, allow_subnormal=False),
    st.floats(0.1, 1000),
    st.integers(2, 200),
)
def test_ranges_have_their_ends_and_rise(first: float, width: float, count: int) -> None:
    values = Range(first, first + width, count).values
    assert len(values) == count
    assert values[0] == pytest.approx(first, abs=1e-8)
    assert values[-1] == pytest.approx(first + width, abs=1e-8)
    assert all(a < b for a, b in pairwise(values))


def test_what_comes_to_the_same_is_one_cell() -> None:
    grid = Grid(robot="no_adaptation", match_rule=(True, False), partner=PARTNER)
    assert len(cells(grid)) == 1
    assert cells(grid)[0].match_rule is None
    off = Grid(match_rule=False, match_threshold=(0.5, 0.9), partner=PARTNER)
    assert len(cells(off)) == 1
    assert len(cells(grid, grid)) == 1
    # Without episodes neither the seed nor the trials matter.
    assert len(cells(Grid(partner=PARTNER), seed=(1, 2, 3), episodes=0, exact=True)) == 1


def test_equal_values_have_equal_keys() -> None:
    keys = {
        cells(Grid(disagreement_cost=-1, partner={"adaptability": 1}))[0].key,
        cells(Grid(disagreement_cost=(-1.0,), partner={"adaptability": 1.0}))[0].key,
        cells(Grid(disagreement_cost=-1.0, partner={"kind": "follower", "adaptability": [1]}))[
            0
        ].key,
    }
    assert len(keys) == 1


def test_a_change_of_anything_changes_the_key() -> None:
    grids = [
        Grid(partner=PARTNER),
        Grid(partner={"adaptability": 0.25}),
        Grid(partner=PARTNER | {"mode": "left"}),
        Grid(partner=PARTNER | {"kind": "noisy"}),
        Grid(partner=PARTNER, disagreement_cost=-0.3),
        Grid(partner=PARTNER, robot="one_way_adaptation"),
        Grid(partner=PARTNER, match_rule=False),
        Grid(partner=PARTNER, adaptability=(0.0, 1.0)),
        Grid(partner=PARTNER, task="table_clearing"),
        Grid(partner=PARTNER, episodes=7),
    ]
    found = [cells(grid)[0] for grid in grids]
    found += cells(grids[0], seed=1) + cells(grids[0], exact=True) + cells(grids[0], trials=2)
    assert len({cell.key for cell in found}) == len(found)
    assert len({cell.rng().integers(2**63) for cell in found}) == len(found)


def test_the_stream_depends_on_the_content_alone() -> None:
    few = cells(Grid(partner={"adaptability": 0.5}))
    many = cells(Grid(partner={"adaptability": [0.0, 0.25, 0.5]}, disagreement_cost=(-0.5, -0.32)))
    (same,) = [cell for cell in many if cell.key == few[0].key]
    assert same.rng().integers(2**63) == few[0].rng().integers(2**63)


def test_cells_of_one_plan() -> None:
    found = cells(
        Grid(match_threshold=(0.8, 0.9), partner={"adaptability": [0, 1]}), seed=(1, 2)
    ) + cells(Grid(match_rule=False, partner=PARTNER))
    assert len({cell.key for cell in found}) == 9
    assert len({cell.plan_key for cell in found}) == 1
    other = cells(Grid(disagreement_cost=-0.3, partner=PARTNER))
    assert other[0].plan_key != found[0].plan_key


def test_the_gap_moves_the_better_goal() -> None:
    task = load_task("table_clearing_small")
    (cell,) = cells(Grid(task="table_clearing_small", reward_gap=2.5, partner=PARTNER))
    before = sorted(goal.reward for goal in task.goals)  # pyright: ignore
    assert sorted(cell.rewards.values()) == [before[0], before[0] + 2.5]


def test_the_other_goal() -> None:
    grid = Grid(partner={"adaptability": 0, "mode": "other"}, left_reward=(9.0, 12.0))
    assert [cell.partner["mode"] for cell in cells(grid)] == ["left", "right"]


BAD = {
    "[[grid]]\npartner = {}\ncolour = 1": (5, "grid[0]: object contains unknown field `colour`"),
    "[[grid]]\ndisagreement_cost = [-0.1, 0.5]\npartner = {}": (
        4,
        "grid[0].disagreement_cost must be a number of at most 0, not 0.5",
    ),
    "[[grid]]\npartner = {}\n[[grid]]\npartner = {}\nmemory = 0": (
        7,
        "grid[1].memory must be from 1 to 100, not 0",
    ),
    "[[grid]]\n[[grid.partner]]\n[[grid.partner]]\nmode = 'up'": (
        6,
        "grid[0].partner[1].mode is 'up', expected one of left, right, other",
    ),
    "[[grid]]\npartner = { kind = 'ghost' }": (4, "grid[0].partner.kind must be one of"),
    "[[grid]]\npartner = {}\nreward_gap = 0": (5, "grid[0].reward_gap must be above 0, not 0"),
    "[[grid]]\npartner = {}\nreward_gap = 1\nright_reward = 11": (
        6,
        "grid[0].right_reward is given beside reward_gap, expected one of them",
    ),
    "[[grid]]\ntask = 'nowhere'\npartner = {}": (4, "grid[0].task is nowhere: found no such task"),
    "[[grid]]\ntask = 'hallway'\npartner = {}": (4, "grid[0].task is hallway, in which"),
    "[[grid]]\ntask = 'wheelchair'\ncolumns = 5\npartner = {}": (5, "grid[0].columns is for table"),
    "[[grid]]\ngap = { from = 1, to = 2, count = 1 }\npartner = {}": (
        4,
        "grid[0].gap.count must be from 2 to 100,000, not 1",
    ),
    "[[grid]]\ndiscount = []\npartner = {}": (4, "grid[0].discount is an empty list"),
    "[[grid]]\npartner = { adaptability = [] }": (4, "grid[0].partner.adaptability is an empty"),
    "[[grid]]\npartner = { adaptability = 2 }": (4, "grid[0].partner"),
    "episodes = -1\n[[grid]]\npartner = {}": (3, "episodes must be from 0 to"),
    "episodes = 0\n[[grid]]\npartner = {}": (4, "grid[0].episodes is 0 and exact is off"),
}


@pytest.mark.parametrize(("text", "where", "problem"), [(t, *w) for t, w in BAD.items()])
def test_what_is_wrong_is_named_with_its_line(text: str, where: int, problem: str) -> None:
    with pytest.raises(FileError) as caught:
        parse_sweep(f'format = 1\nname = "x"\n{text}\n'.encode(), "a.toml")
    assert str(caught.value).startswith(f"a.toml:{where}: {problem}"), str(caught.value)


def test_newer_formats_are_refused() -> None:
    with pytest.raises(FileError, match=r"a.toml:1: format is 2, newer than this coadapt reads"):
        parse_sweep(b'format = 2\nname = "x"\n[[grid]]\npartner = {}\n', "a.toml")


def test_files_of_tasks_are_beside_the_sweep(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"elsewhere/own\.toml"):
        parse_sweep(
            b'format = 1\nname = "x"\n[[grid]]\ntask = "own.toml"\npartner = {}\n',
            tmp_path / "elsewhere" / "sweep.toml",
        )


def test_too_many_cells_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("coadapt.simulation.sweep.cells.MOST_CELLS", 5)
    grid = Grid(disagreement_cost=(-0.1, -0.2), partner={"adaptability": [0, 0.5, 1]})
    with pytest.raises(InputError, match="more than 5 cells"):
        cells(grid)


def test_a_value_problem_names_its_place() -> None:
    with pytest.raises(FieldError) as caught:
        cells(Grid(partner=PARTNER), Grid(partner=(PARTNER, PARTNER | {"rate": 3})))
    assert caught.value.key == ("grid", 1, "partner", 1, "rate")
