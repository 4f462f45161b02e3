"""A person's session with a robot: trials one after the other, every step saved at once."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from time import monotonic

import numpy as np

from coadapt.robots import Decision, Robot
from coadapt.simulation import Trial
from coadapt.simulation.log_writer import LiveLog
from coadapt.simulation.simulate import draw_outcomes, draw_start

CLOCK_DECIMALS = 3
"""Times are saved in milliseconds."""


class Session:
    """Trials one after the other; it knows nothing of screens and keys.

    Args:
        robot: decides.
        log: where the steps are saved.
        clock: seconds from any start; the log's time is 0 when the session begins.
        rng: draws where a trial begins and where moves lead, in tasks that leave it to chance.

    Attributes:
        robot: the robot.
        trial_number: number of the trial under way, from 1.
        decisions: those of the trial under way.
    """

    def __init__(
        self,
        robot: Robot,
        log: LiveLog,
        clock: Callable[[], float] = monotonic,
        rng: np.random.Generator | None = None,
    ) -> None:
        self.robot = robot
        self._rng = np.random.default_rng() if rng is None else rng
        self._log = log
        self._clock = clock
        self._begin = clock()
        self.trial_number = 1
        self._start_trial()

    @property
    def state(self) -> int:
        """Robot state."""
        return self._trial.state

    @property
    def goal(self) -> int | None:
        """Index of the goal reached, or None."""
        return self.robot.model.world.goal_at(self._trial.state)

    @property
    def last(self) -> Decision | None:
        """The last decision of this trial, or None before the first."""
        return self.decisions[-1] if self.decisions else None

    @property
    def saved_steps(self) -> int:
        """Number of steps in the log, of all trials."""
        return self._log.rows

    def step(self, human_input: int | None) -> Decision:
        """One time step, saved before it is shown.

        Args:
            human_input: index of the input, or None for no input.

        Raises:
            ValueError: if the trial is over or the input is out of range.
            FileError: if the step cannot be saved.
        """
        time = round(self._clock() - self._begin, CLOCK_DECIMALS)
        model = self.robot.model
        drawn = partial(draw_outcomes, model, [self._rng])
        outcome = None if model.world.is_deterministic else drawn
        decision = self._trial.step(human_input, outcome=outcome)
        self.decisions.append(decision)
        self._log.write(time, self.trial_number, decision)
        return decision

    def new_trial(self) -> None:
        """Begin a new trial, unless this one has not begun; the robot's belief starts anew."""
        if self.decisions:
            self.trial_number += 1
            self._start_trial()

    def close(self) -> None:
        """Close the log."""
        self._log.close()

    def _start_trial(self) -> None:
        self._trial = Trial(self.robot, start=draw_start(self.robot.model, self._rng))
        self.decisions: list[Decision] = []
