"""From a sweep to its cells: every combination, in the grid's order, each once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path

import msgspec

from coadapt.errors import FileError, InputError
from coadapt.requirements import FieldError
from coadapt.robots.setup import RobotSetup, SetupError
from coadapt.robots.task_setup import AnySetup, TaskSetup, changed
from coadapt.simulation.evaluation import TOLERANCE
from coadapt.simulation.sweep.cell import Cell, rewards_of, tidy
from coadapt.simulation.sweep.grid import SETUP_PARAMETERS, Figure, Grid, Sweep
from coadapt.simulation.sweep.people import Person, settled
from coadapt.simulation.sweep.values import alternatives, combinations
from coadapt.tasks import BuiltTask, Task, load_task

MOST_CELLS = 1_000_000

TABLE_CLEARING = RobotSetup()
"""The task of a grid that names none, and what a setup has by default."""


@dataclass(frozen=True)
class Layout:
    """A sweep and its cells.

    Attributes:
        sweep: the sweep.
        grids: the cells of each of its grids.
    """

    sweep: Sweep
    grids: tuple[tuple[Cell, ...], ...]

    @cached_property
    def cells(self) -> tuple[Cell, ...]:
        """All cells in the order of the grids, each once."""
        return tuple({cell.key: cell for grid in self.grids for cell in grid}.values())

    def of_figure(self, figure: Figure) -> tuple[Cell, ...]:
        """The cells of the grids that ``figure`` shows."""
        pairs = zip(self.sweep.grid, self.grids, strict=True)
        return tuple(cell for grid, cells in pairs if grid.figure == figure for cell in cells)


def lay_out(sweep: Sweep, directory: Path | None = None) -> Layout:
    """The cells of a sweep.

    The order is that of the grids, and within a grid that of the parameters in `Grid`: the seed
    varies fastest, then the partner. Combinations that come to the same, as those of the match rule
    for a robot that has none, are one cell.

    Args:
        sweep: the sweep.
        directory: where files of tasks are looked for; the current one if None.

    Raises:
        FieldError: if a value cannot be used, with its place in the sweep.
        FileError: if the file of a task cannot be used.
        InputError: if there are too many cells.
    """
    grids: list[tuple[Cell, ...]] = []
    count = 0
    for number, grid in enumerate(sweep.grid):
        found: dict[str, Cell] = {}
        try:
            for cell in _cells(sweep, grid, directory):
                found.setdefault(cell.key, cell)
                if count + len(found) > MOST_CELLS:
                    raise InputError(f"found more than {MOST_CELLS:,} cells, expected fewer")
        except FieldError as error:
            raise FieldError(("grid", number, *error.key), error.problem) from error
        count += len(found)
        grids.append(tuple(found.values()))
    return Layout(sweep, tuple(grids))


def _cells(sweep: Sweep, grid: Grid, directory: Path | None) -> Iterator[Cell]:
    people = _people(grid)
    for name in alternatives(grid.task):
        base = base_setup(name, directory)
        changes = combinations(_axes(grid, base))
        for robot, rule, change in product(
            alternatives(grid.robot), alternatives(grid.match_rule), changes
        ):
            setup = tidy(_changed(base, {"robot": robot, **change}))
            follows = None if robot == "no_adaptation" else bool(rule)
            if not follows:
                default = TABLE_CLEARING.match_threshold
                setup = msgspec.structs.replace(setup, match_threshold=default)
            rewards = rewards_of(setup)
            for (i, person), seed in product(people, alternatives(sweep.seed)):
                try:
                    partner = settled(person, rewards)
                except FieldError as error:
                    raise FieldError((*i, *error.key), error.problem) from error
                yield _cell(sweep, grid, setup, follows, partner, int(str(seed)))


def _cell(
    sweep: Sweep, grid: Grid, setup: AnySetup, match_rule: bool | None, partner: Person, seed: int
) -> Cell:
    """One cell; what makes no difference to it has its default."""
    episodes = sweep.episodes if grid.episodes is None else grid.episodes
    exact = sweep.exact if grid.exact is None else grid.exact
    tolerance = sweep.tolerance if grid.tolerance is None else grid.tolerance
    if episodes == 0 and not exact:
        raise FieldError(("episodes",), "is 0 and exact is off: there is nothing to find out")
    trials = sweep.trials if episodes else 1
    return Cell(
        setup=setup,
        match_rule=match_rule,
        partner=partner,
        seed=seed if episodes else 0,
        episodes=episodes,
        trials=trials,
        carry_belief=sweep.carry_belief if trials > 1 else True,
        exact=exact,
        tolerance=tolerance if exact else TOLERANCE,
        max_steps=sweep.max_steps,
    )


def base_setup(task: object, directory: Path | None) -> AnySetup:
    """The setup of a grid's task before anything is changed.

    Args:
        task: as in `Grid`.
        directory: where files of tasks are looked for.

    Raises:
        FieldError: if there is no such task, or it is for no sweep.
        FileError: if its file cannot be used.
    """
    if task is None:
        return TABLE_CLEARING
    found = task if isinstance(task, Task) else _load(str(task), directory)
    if isinstance(found, BuiltTask):
        raise FieldError(
            ("task",), f"is {found.name}, in which the person moves the world; sweeps take others"
        )
    return TaskSetup(task=found)


def _load(name: str, directory: Path | None) -> Task | BuiltTask:
    path = Path(name)
    is_file = bool(path.suffix) or name != path.name
    try:
        return load_task(str(directory / path) if is_file and directory is not None else name)
    except FileError:
        raise
    except InputError as error:
        raise FieldError(("task",), f"is {error}") from error


def _axes(grid: Grid, base: AnySetup) -> dict[str, object]:
    """The values of each parameter of the setup that the grid gives, each found usable."""
    axes: dict[str, object] = {}
    for name in SETUP_PARAMETERS:
        given: object = getattr(grid, name)
        if given is None:
            continue
        if name == "adaptability" and not _is_rows(given):
            given = (given,)
        axes[name] = given
        for value in combinations({name: given}):
            _ = _changed(base, value)
    if "reward_gap" in axes and "right_reward" in axes:
        raise FieldError(("right_reward",), "is given beside reward_gap, expected one of them")
    return axes


def _is_rows(given: object) -> bool:
    return isinstance(given, tuple) and all(isinstance(row, tuple) for row in given)  # pyright: ignore


def _changed(base: AnySetup, changes: Mapping[str, object]) -> AnySetup:
    """``base`` with other values; ``reward_gap`` moves the better goal's reward."""
    plain = {name: value for name, value in changes.items() if name != "reward_gap"}
    try:
        setup = changed(base, plain)
    except SetupError as error:
        raise FieldError((error.field,), error.problem) from error
    if "reward_gap" not in changes:
        return setup
    gap = float(str(changes["reward_gap"]))
    if not gap > 0:
        raise FieldError(("reward_gap",), f"must be above 0, not {gap}")
    return _with_gap(setup, gap)


def _with_gap(setup: AnySetup, gap: float) -> AnySetup:
    if isinstance(setup, RobotSetup):
        return msgspec.structs.replace(setup, right_reward=setup.left_reward + gap)
    goals = setup.task.goals
    if len(goals) != 2:
        raise FieldError(
            ("reward_gap",), f"is for tasks with two goals, and {setup.task.name} has {len(goals)}"
        )
    other, better = sorted(range(2), key=lambda i: goals[i].reward)
    moved = list(goals)
    moved[better] = msgspec.structs.replace(goals[better], reward=goals[other].reward + gap)
    task = msgspec.structs.replace(setup.task, goals=tuple(moved))
    return msgspec.structs.replace(setup, task=task)


def _people(grid: Grid) -> list[tuple[tuple[str | int, ...], dict[str, object]]]:
    """Every simulated person of a grid, and where they stand in it."""
    several = isinstance(grid.partner, tuple)
    listed = grid.partner if isinstance(grid.partner, tuple) else (grid.partner,)
    found: list[tuple[tuple[str | int, ...], dict[str, object]]] = []
    for i, given in enumerate(listed):
        key = ("partner", i) if several else ("partner",)
        try:
            found += [(key, person) for person in combinations(given)]
        except FieldError as error:
            raise FieldError((*key, *error.key), error.problem) from error
    return found
