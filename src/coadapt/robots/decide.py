"""Decisions by the compiled code."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.robots.robot import Decisions
from coadapt.robots.tables import RobotTables


def decide_by(
    tables: RobotTables, windows: IntArray, human_inputs: IntArray, beliefs: FloatArray
) -> Decisions:
    """The decisions of a robot, see `coadapt.robots.Decider.decide_many`."""
    count = len(windows)
    belief = np.array(beliefs, dtype=np.float64, order="C")
    windows = np.array(windows, dtype=np.int64)
    human_inputs = np.array(human_inputs, dtype=np.int64)
    forecast = np.empty_like(belief)
    planned, asked, action = np.empty((3, count), dtype=np.int64)
    agreement, matched = np.empty(count), np.empty(count, dtype=np.bool_)
    decide_all = _kernels()[0]
    decide_all(
        tables,
        windows,
        human_inputs,
        belief,
        forecast,
        planned,
        asked,
        action,
        agreement,
        matched,
        np.empty(tables.room),
    )
    return Decisions(
        window=windows,
        state=tables.state[windows],
        human_input=human_inputs,
        asked=asked,
        action=action,
        planned=planned,
        agreement=agreement,
        matched=matched,
        belief=belief,
        forecast=forecast,
    )


class DecisionsInTurn:
    """The decisions of one episode, one after the other, with nothing around them.

    The same as those of `coadapt.robots.Decider.decide_many`, in a fraction of the time.

    Args:
        tables: the robot.
        belief: ``[A, M]`` before the first input; not changed.

    Attributes:
        belief: ``[A, M]`` behind the last decision, overwritten by the next.
        forecast: ``[A, M]`` the same carried through the robot's action; likewise.
    """

    def __init__(self, tables: RobotTables, belief: FloatArray) -> None:
        self._tables = tables
        self._scratch = np.empty(tables.room)
        self.belief = np.array(belief, dtype=np.float64, order="C")
        self.forecast = self.belief.copy()

    def decide(self, window: int, human_input: int) -> tuple[int, int, int, float, bool]:
        """Decide in ``window`` after ``human_input``, `NO_INPUT` where there was none.

        Returns:
            The planned action, what the input asks for, the action, the agreement, and whether the
            match rule made the difference, see `coadapt.robots.Decision`.
        """
        self.belief[:] = self.forecast
        decide_one = _kernels()[2]
        return decide_one(
            self._tables, window, human_input, self.belief, self.forecast, self._scratch
        )


def plan_by(tables: RobotTables, windows: IntArray, beliefs: FloatArray) -> IntArray:
    """``[N]`` what a robot that does not wait for the person plans."""
    planned = np.empty(len(windows), dtype=np.int64)
    plan_all = _kernels()[1]
    plan_all(
        tables,
        np.array(windows, dtype=np.int64),
        np.array(beliefs, dtype=np.float64, order="C"),
        planned,
        np.empty(tables.room),
    )
    return planned


@cache
def _kernels() -> tuple[
    Callable[..., None], Callable[..., None], Callable[..., tuple[int, int, int, float, bool]]
]:
    # Imported with the first decision: who only reads a robot's setup need not wait for numba.
    from coadapt.robots.kernels.decide import (  # noqa: PLC0415
        decide_all,
        decide_one,
        plan_all,
    )

    return decide_all, plan_all, decide_one
