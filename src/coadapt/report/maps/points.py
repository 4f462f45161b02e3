"""From the cells of a sweep to what its figures show. What does not fit is found before it runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from coadapt.arrays import FloatArray
from coadapt.errors import InputError
from coadapt.simulation.sweep import Cell
from coadapt.simulation.sweep.table import Record, parameters

PHASES, OUTCOMES, TRADE_OFF = "phases", "outcomes", "trade_off"

MAPPED = ("cell", "disagreement_cost", "reward_gap", "left_reward", "right_reward", "task_sha256")
"""What may differ between the cells of a map; every other column must not."""

Rows = Mapping[str, Record]
"""For each cell by its key the row of its first trial."""


@dataclass(frozen=True)
class Map:
    """Where each cell of a map stands.

    Attributes:
        alpha: adaptability of the simulated people.
        costs: ``[J]`` values of C, increasing.
        gaps: ``[I]`` values of ``R_opt - R_sub``, increasing.
        keys: ``[I][J]`` the keys of the cells.
    """

    alpha: float
    costs: FloatArray
    gaps: FloatArray
    keys: tuple[tuple[str, ...], ...]

    def values(self, rows: Rows, name: str) -> FloatArray:
        """``[I, J]`` values of the column ``name``; NaN where a cell failed."""
        found = [[_number(rows, key, name) for key in line] for line in self.keys]
        return np.array(found, dtype=np.float64)


@dataclass(frozen=True)
class TradeOff:
    """The cells of a trade-off curve.

    Attributes:
        alphas: ``[P]`` adaptability of the simulated people, increasing.
        gap: ``R_opt - R_sub``.
        costs: ``[J]`` values of C of the mutual-adaptation robot, increasing.
        keys: ``[J][P]`` its cells.
        ends: ``[P]`` the cells of each robot that does not trade, by its name.
    """

    alphas: tuple[float, ...]
    gap: float
    costs: tuple[float, ...]
    keys: tuple[tuple[str, ...], ...]
    ends: Mapping[str, tuple[str, ...]]

    def curve(self, rows: Rows, name: str) -> FloatArray:
        """``[J, P]`` values of the column ``name`` for the mutual-adaptation robot."""
        return np.array([[_number(rows, key, name) for key in line] for line in self.keys])

    def end(self, rows: Rows, robot: str, name: str) -> FloatArray:
        """``[P]`` the same for another robot."""
        return np.array([_number(rows, key, name) for key in self.ends[robot]])


def phases(cells: Sequence[Cell]) -> Map:
    """The map of the phases.

    Raises:
        InputError: unless the cells are those of people with alpha 0 who want the goal worth less,
            evaluated exactly, in a grid over C and the gap.
    """
    found = _map(PHASES, cells, 0.0)
    for cell in cells:
        _require(PHASES, cell.exact, "exact evaluation", "none")
    return found


def outcomes(cells: Sequence[Cell]) -> list[Map]:
    """A map for each adaptability.

    Raises:
        InputError: unless the cells are those of people who want the goal worth less, simulated, in
            grids over C and the gap.
    """
    for cell in cells:
        _require(OUTCOMES, cell.episodes > 0, "simulated episodes", "none")
    alphas = sorted({_alpha(OUTCOMES, cell) for cell in cells})
    return [_map(OUTCOMES, [c for c in cells if _alpha(OUTCOMES, c) == a], a) for a in alphas]


def trade_off(cells: Sequence[Cell]) -> TradeOff:
    """The trade-off curve.

    Raises:
        InputError: unless the cells are simulated, with one gap and the same people for every
            robot and cost, and the robots at both ends are among them.
    """
    by_place: dict[tuple[str, float, float], str] = {}
    gaps: set[object] = set()
    for cell in cells:
        _require(TRADE_OFF, cell.episodes > 0, "simulated episodes", "none")
        record = parameters(cell)
        gaps.add(record["reward_gap"])
        cost = float(str(record["disagreement_cost"]))
        is_mutual = cell.setup.robot == "mutual_adaptation"
        place = (cell.setup.robot, cost if is_mutual else 0.0, _alpha(TRADE_OFF, cell))
        _require(TRADE_OFF, place not in by_place, "one cell for each robot, C and alpha", "more")
        by_place[place] = cell.key
    _require(TRADE_OFF, len(gaps) == 1, "one gap of rewards", f"{len(gaps)}")
    alphas = tuple(sorted({alpha for _, _, alpha in by_place}))
    costs = tuple(sorted({cost for robot, cost, _ in by_place if robot == "mutual_adaptation"}))
    _require(TRADE_OFF, len(costs) > 1, "several values of C", f"{len(costs)}")
    try:
        return TradeOff(
            alphas=alphas,
            gap=float(str(gaps.pop())),
            costs=costs,
            keys=tuple(
                tuple(by_place["mutual_adaptation", cost, alpha] for alpha in alphas)
                for cost in costs
            ),
            ends={
                robot: tuple(by_place[robot, 0.0, alpha] for alpha in alphas)
                for robot in ("one_way_adaptation", "no_adaptation")
            },
        )
    except KeyError as error:
        robot, cost, alpha = error.args[0]
        raise InputError(
            f"the figure {TRADE_OFF} has no cell of {robot} at C = {cost:g}, alpha = {alpha:g}, "
            "expected all three robots with the same people"
        ) from error


def _map(figure: str, cells: Sequence[Cell], alpha: float) -> Map:
    places: dict[tuple[float, float], str] = {}
    first = {name: value for name, value in parameters(cells[0]).items() if name not in MAPPED}
    for cell in cells:
        found = _alpha(figure, cell)
        _require(figure, found == alpha, f"people with alpha {alpha:g}", f"alpha {found:g}")
        robot = cell.setup.robot
        _require(figure, robot == "mutual_adaptation", "mutual_adaptation alone", robot)
        record = parameters(cell)
        for name, value in first.items():
            _require(figure, record[name] == value, f"one value of {name}", "several")
        place = (float(str(record["reward_gap"])), float(str(record["disagreement_cost"])))
        _require(figure, place not in places, "one cell for each C and gap", "more")
        places[place] = cell.key
    gaps, costs = (sorted({place[axis] for place in places}) for axis in range(2))
    is_grid = len(gaps) > 1 and len(costs) > 1 and len(places) == len(gaps) * len(costs)
    _require(figure, is_grid, "a grid over disagreement_cost and reward_gap", "none")
    keys = tuple(tuple(places[gap, cost] for cost in costs) for gap in gaps)
    return Map(alpha, np.array(costs), np.array(gaps), keys)


def _alpha(figure: str, cell: Cell) -> float:
    """Adaptability of the cell's person, who has to want the goal worth less."""
    rewards = cell.rewards
    _require(figure, len(rewards) == 2, "a task with two goals", f"{len(rewards)} goals")
    other = min(rewards, key=lambda name: rewards[name])
    mode = cell.partner.get("mode")
    _require(figure, mode == other, 'people with mode = "other"', f"mode {mode!r}")
    alpha = cell.partner.get("adaptability")
    _require(figure, isinstance(alpha, float | int), "people with one adaptability", f"{alpha!r}")
    return float(str(alpha))


def _number(rows: Rows, key: str, name: str) -> float:
    value = rows[key].get(name) if key in rows else None
    return float("nan") if value is None else float(value)


def _require(figure: str, holds: bool, wanted: str, found: str) -> None:
    if not holds:
        raise InputError(f"the figure {figure} needs {wanted}, found {found}")
