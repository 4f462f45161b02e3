"""What worker processes do: plan, and find out about one cell.

Nothing but the arguments goes in and nothing but the result comes out, so it is all the same where
and in what order cells are worked on. What goes wrong comes back as a `Failure`: an exception might
not survive the way.
"""

from __future__ import annotations

import traceback
from dataclasses import dataclass
from functools import lru_cache
from time import perf_counter

import msgspec

from coadapt import __version__
from coadapt.formalism import SharedAutonomy
from coadapt.momdp.policy import AlphaVectorPolicy
from coadapt.robots import (
    NEVER_MATCH,
    MatchRule,
    MutualAdaptation,
    NoAdaptation,
    OneWayAdaptation,
    Robot,
)
from coadapt.robots.setup import planned_policy
from coadapt.robots.task_setup import AnySetup, read_setup
from coadapt.simulation.sweep.cell import Cell
from coadapt.simulation.sweep.measure import Row, measure

MODELS = 8
"""Models that a worker keeps: cells of one plan follow each other."""


@dataclass(frozen=True)
class Failure:
    """Something went wrong.

    Attributes:
        message: in one line.
        details: where, for whoever mends it.
    """

    message: str
    details: str = ""


@dataclass(frozen=True)
class Plan:
    """What the cells of one plan share.

    Attributes:
        policy: of the robot; None where it needs none.
        seconds: that planning took.
    """

    policy: AlphaVectorPolicy | None
    seconds: float


@dataclass(frozen=True)
class Found:
    """The result of a cell.

    Attributes:
        rows: one for each trial.
        seconds: that it took.
    """

    rows: list[Row]
    seconds: float


def plan(cell: Cell) -> Plan | Failure:
    """Plan for the robot of ``cell``."""
    begin = perf_counter()
    try:
        _require_version(cell)
        setup = cell.setup
        if setup.robot == "no_adaptation":
            return Plan(None, 0.0)
        model = _model_of(setup)
        if setup.robot == "one_way_adaptation":
            model = model.one_way()
        policy = planned_policy(model.to_momdp(), setup.gap)
    except (Exception, KeyboardInterrupt) as error:
        return _failure(error)
    return Plan(policy, perf_counter() - begin)


def run(cell: Cell, policy: AlphaVectorPolicy | None) -> Found | Failure:
    """Find out about ``cell``, whose robot follows ``policy``."""
    begin = perf_counter()
    try:
        _require_version(cell)
        rows = measure(cell, _robot(cell, policy))
    except Exception as error:
        return _failure(error)
    return Found(rows, perf_counter() - begin)


def _robot(cell: Cell, policy: AlphaVectorPolicy | None) -> Robot:
    model = _model_of(cell.setup)
    if policy is None:
        return NoAdaptation(model)
    rule = MatchRule(cell.setup.match_threshold) if cell.match_rule else NEVER_MATCH
    is_mutual = cell.setup.robot == "mutual_adaptation"
    return (MutualAdaptation if is_mutual else OneWayAdaptation)(model, policy, rule)


def _model_of(setup: AnySetup) -> SharedAutonomy:
    """The model of a setup; the last few are kept. Threads may share one, as it never changes."""
    return _model(msgspec.json.encode(msgspec.structs.replace(setup, robot="no_adaptation")))


@lru_cache(maxsize=MODELS)
def _model(setup: bytes) -> SharedAutonomy:
    return read_setup(setup).model()


def _require_version(cell: Cell) -> None:
    if cell.coadapt != __version__:
        raise RuntimeError(
            f"a worker has coadapt {__version__}, expected {cell.coadapt} as where the sweep began"
        )


def _failure(error: BaseException) -> Failure:
    message = " ".join(str(error).split()) or "without a message"
    return Failure(f"{type(error).__name__}: {message}", traceback.format_exc())
