"""A sweep written down: grids of parameters, conditions and simulated people."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import msgspec

from coadapt.requirements import NAME, FieldError
from coadapt.robots.setup import RobotName
from coadapt.simulation.evaluation import MAX_STEPS, SMALLEST_TOLERANCE, TOLERANCE
from coadapt.simulation.sweep.values import Counts, Numbers
from coadapt.tasks import Task

FORMAT = 1
"""Version of the sweep format and of the files of cells."""

MOST_EPISODES = 100_000_000

MOST_TRIALS = 1000

MOST_GRIDS = 1000

SETUP_PARAMETERS = (
    "columns",
    "rows",
    "left_reward",
    "right_reward",
    "reward_gap",
    "memory",
    "adaptability",
    "disagreement_cost",
    "discount",
    "step_cost",
    "match_threshold",
    "gap",
)
"""Parameters of a grid that a robot's setup has, in their order, with the gap between rewards."""

Figure = Literal["phases", "outcomes", "trade_off"]
"""Figures that can be drawn of a grid, see `coadapt.report.maps`."""

PartnerValues = dict[str, object]
"""A simulated person: names as for `coadapt.simulation.partners.partner_from`, each with one value
or several."""


class Grid(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """All combinations of the values given for each parameter.

    A parameter that is left out has its default: that of `coadapt.robots.setup.RobotSetup`, or the
    task's own.

    Attributes:
        task: name of a task that comes with the package, a file, or a `Task`; the paper's table
            clearing if None.
        robot: the conditions of Sec. 6.1.
        match_rule: whether the robot follows the match rule of Sec. 5.3.
        columns, rows, left_reward, right_reward: of table clearing alone.
        reward_gap: ``R_opt - R_sub``, above 0, for tasks with two goals: the better goal's reward
            is moved.
        memory, disagreement_cost, discount, step_cost, match_threshold, gap: as for a setup.
        adaptability: the values of alpha that the robot considers, or rows of them.
        partner: the simulated people.
        episodes, exact, tolerance: as in the sweep, and in its place.
        figure: the figure that shows the cells; several grids may share one.

    Raises:
        FieldError: if a value is out of its range.
    """

    task: str | Task | tuple[str | Task, ...] | None = None
    robot: RobotName | tuple[RobotName, ...] = "mutual_adaptation"
    match_rule: bool | tuple[bool, ...] = True
    columns: Counts | None = None
    rows: Counts | None = None
    left_reward: Numbers | None = None
    right_reward: Numbers | None = None
    reward_gap: Numbers | None = None
    memory: Counts | None = None
    adaptability: tuple[float | tuple[float, ...], ...] | None = None
    disagreement_cost: Numbers | None = None
    discount: Numbers | None = None
    step_cost: Numbers | None = None
    match_threshold: Numbers | None = None
    gap: Numbers | None = None
    partner: PartnerValues | tuple[PartnerValues, ...]
    episodes: int | None = None
    exact: bool | None = None
    tolerance: float | None = None
    figure: Figure | None = None

    def __post_init__(self) -> None:
        if self.episodes is not None:
            _require_episodes(self.episodes)
        if self.tolerance is not None:
            _require_tolerance(self.tolerance)


class Sweep(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A sweep.

    Attributes:
        name: short identifier.
        grid: the grids, one after the other.
        format: version of the format, `FORMAT`.
        seed: one or several; each is a cell of its own with random streams of its own.
        episodes: simulated people in each cell; 0 for none.
        trials: trials of each.
        carry_belief: whether the robot's belief goes from one trial to the next.
        exact: whether each cell is evaluated exactly too, where its partner allows it.
        tolerance: of the exact evaluation, see `coadapt.simulation.evaluate`.
        max_steps: episodes without a goal end here.

    Raises:
        FieldError: if a value is out of its range.
    """

    name: str
    grid: tuple[Grid, ...]
    format: int = FORMAT
    seed: Counts = 0
    episodes: int = 1000
    trials: int = 1
    carry_belief: bool = True
    exact: bool = False
    tolerance: float = TOLERANCE
    max_steps: int = MAX_STEPS

    def __post_init__(self) -> None:
        if self.format > FORMAT:
            raise FieldError(
                ("format",), f"is {self.format}, newer than this coadapt reads; expected {FORMAT}"
            )
        _require("format", self.format == FORMAT, f"{FORMAT}", self.format)
        signs = "1 to 60 letters, digits, blanks or . ' ( ) + / - _"
        _require("name", NAME.fullmatch(self.name) is not None, signs, repr(self.name))
        _require("grid", 1 <= len(self.grid) <= MOST_GRIDS, f"1 to {MOST_GRIDS}", len(self.grid))
        _require_episodes(self.episodes)
        _require_tolerance(self.tolerance)
        few = f"from 1 to {MOST_TRIALS:,}"
        _require("trials", 1 <= self.trials <= MOST_TRIALS, few, self.trials)
        _require("max_steps", 1 <= self.max_steps <= 100_000, "from 1 to 100,000", self.max_steps)
        seeds = self.seed if isinstance(self.seed, Sequence) else (self.seed,)
        _require("seed", bool(seeds) and min(seeds) >= 0, "numbers of at least 0", self.seed)


def _require_episodes(episodes: int) -> None:
    wanted = f"from 0 to {MOST_EPISODES:,}"
    _require("episodes", 0 <= episodes <= MOST_EPISODES, wanted, episodes)


def _require_tolerance(tolerance: float) -> None:
    wanted = f"from {SMALLEST_TOLERANCE} to 1"
    _require("tolerance", SMALLEST_TOLERANCE <= tolerance <= 1, wanted, tolerance)


def _require(name: str, holds: bool, wanted: str, found: object) -> None:
    if not holds:
        raise FieldError((name,), f"must be {wanted}, not {found}")
