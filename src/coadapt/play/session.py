"""A person's session with a robot: trials one after the other, every step saved at once."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic

from coadapt.robots import Decision, Robot
from coadapt.simulation import Trial
from coadapt.simulation.log_writer import LiveLog

CLOCK_DECIMALS = 3
"""Times are saved in milliseconds."""


class Session:
    """Trials one after the other; it knows nothing of screens and keys.

    Args:
        robot: decides.
        log: where the steps are saved.
        clock: seconds from any start; the log's time is 0 when the session begins.

    Attributes:
        robot: the robot.
        trial_number: number of the trial under way, from 1.
        decisions: those of the trial under way.
    """

    def __init__(self, robot: Robot, log: LiveLog, clock: Callable[[], float] = monotonic) -> None:
        self.robot = robot
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
        decision = self._trial.step(human_input)
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
        self._trial = Trial(self.robot)
        self.decisions: list[Decision] = []
