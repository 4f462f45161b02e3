"""Trials: their course, and the record that remains of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.formalism import Model
from coadapt.robots import NO_INPUT, Decider, Decision, Decisions
from coadapt.robots.robot import require_situation

UNKNOWN_MODE = -1
"""Mode of a real person, who does not tell."""

Outcome = Callable[[Decisions], IntArray]
"""Says which of its outcomes each decided action has, ``[K]``, where moves are uncertain."""


def only_outcome(model: Model, decisions: Decisions) -> IntArray:
    """``[K]`` the outcome of actions that have but one."""
    chances = model.outcome_chances(decisions.state, decisions.action, decisions.human_input)
    return chances.argmax(axis=1)


@dataclass(frozen=True)
class Episode:
    """Everything that happened in one trial, enough to replay it.

    Attributes:
        robot: name of the robot.
        world: name of the world.
        decisions: one a step, with the state, the input and the beliefs behind it.
        modes: the partner's mode at each input, `UNKNOWN_MODE` where it is not known.
        final_state: the state after the last action.
        goal: index of the goal reached, or None.
        reward: reward of that goal, in the paper's units; 0 without a goal.
        disagreement: expected number of steps in which the person saw the robot in another mode
            than their own, ``sum_t P(m_r != m_h^t | w^t, a_r^t)`` with what
            they remember, ``w^t``; NaN where modes are unknown.
    """

    robot: str
    world: str
    decisions: tuple[Decision, ...]
    modes: tuple[int, ...]
    final_state: int
    goal: int | None
    reward: float
    disagreement: float

    @property
    def steps(self) -> int:
        """Number of robot actions."""
        return len(self.decisions)

    @property
    def states(self) -> tuple[int, ...]:
        """The robot states, from the first to the last: one more than there are steps."""
        return (*(d.state for d in self.decisions), self.final_state)

    @property
    def inputs(self) -> tuple[int | None, ...]:
        """The person's inputs."""
        return tuple(d.human_input for d in self.decisions)

    @property
    def actions(self) -> tuple[int, ...]:
        """The robot's actions."""
        return tuple(d.action for d in self.decisions)

    @property
    def overridden(self) -> int:
        """Number of steps in which the robot did something else than the input asked for."""
        return sum(d.asked not in (None, d.action) for d in self.decisions)


class Trials:
    """Trials under way side by side: the one place where inputs, decisions and moves follow each
    other.

    Args:
        robot: decides in all of them.
        n: number of trials.
        belief: ``[A, M]`` belief to begin with, for example carried over from the trial before,
            or ``[n, A, M]`` one for each trial; the robot's prior if None.
        starts: ``[n]`` the first state of each; the world's ``start`` if None.

    Attributes:
        robot: the robot.
        window: ``[n]`` what the person remembers in each, indices in ``robot.model.windows``.
        forecast: ``[n, A, M]`` the robot's belief in each before the next input.
    """

    def __init__(
        self,
        robot: Decider,
        n: int,
        belief: FloatArray | None = None,
        starts: IntArray | None = None,
    ) -> None:
        each = belief is not None and belief.ndim == 3
        robot.reset(None if each else belief)
        self.robot = robot
        model = robot.model
        begin = np.full(n, model.world.start) if starts is None else starts
        self.window = model.windows.beginning[begin]
        self.forecast = np.array(belief) if each else np.repeat(robot.belief[None], n, axis=0)
        self._decisions: list[list[Decision]] = [[] for _ in range(n)]
        self._modes: list[list[int]] = [[] for _ in range(n)]

    @property
    def state(self) -> IntArray:
        """``[n]`` the robot states."""
        return self.robot.model.windows.state[self.window]

    @property
    def running(self) -> IntArray:
        """The trials that have not reached a goal."""
        return np.flatnonzero(~self.robot.model.world.ends[self.state])

    def step(
        self,
        trials: IntArray,
        human_inputs: IntArray,
        modes: IntArray,
        outcome: Outcome | None = None,
    ) -> Decisions:
        """One time step in some of the trials: the input, the decision, the move of the world.

        Args:
            trials: ``[K]`` which trials, all of them running.
            human_inputs: ``[K]`` the input in each, `NO_INPUT` where there was none.
            modes: ``[K]`` the partner's mode behind it, `UNKNOWN_MODE` where it is not known.
            outcome: which outcomes the actions have; not needed where they have but one.
        """
        decisions = self.decide(trials, human_inputs, modes)
        model = self.robot.model
        self.move(trials, decisions, (outcome or partial(only_outcome, model))(decisions))
        return decisions

    def decide(self, trials: IntArray, human_inputs: IntArray, modes: IntArray) -> Decisions:
        """The first half of `step`: the input and the decision."""
        decisions = self.robot.decide_many(self.window[trials], human_inputs, self.forecast[trials])
        for k, i in enumerate(map(int, trials)):
            self._decisions[i].append(decisions[k])
            self._modes[i].append(int(modes[k]))
        self.forecast[trials] = decisions.forecast
        return decisions

    def move(self, trials: IntArray, decisions: Decisions, which: IntArray) -> None:
        """The second half of `step`: the world moves by outcomes ``which`` ``[K]``."""
        following = self.robot.model.windows.next
        self.window[trials] = following[decisions.window, decisions.action, which]

    def episode(self, i: int, seen_apart: float | None = None) -> Episode:
        """The record of trial ``i`` up to here.

        Args:
            i: which.
            seen_apart: `Episode.disagreement`; if None it is that of somebody who remembers what
                the robot's model says.
        """
        model = self.robot.model
        state = int(model.windows.state[self.window[i]])
        goal = model.world.goal_at(state)
        modes = self._modes[i]
        if seen_apart is None:
            seen_apart = self._seen_apart(i)
        return Episode(
            robot=self.robot.name,
            world=model.world.name,
            decisions=tuple(self._decisions[i]),
            modes=tuple(modes),
            final_state=state,
            goal=goal,
            reward=0.0 if goal is None else model.world.goals[goal].reward,
            disagreement=seen_apart,
        )

    def _seen_apart(self, i: int) -> float:
        modes, perceived = self._modes[i], self.robot.model.perceived
        if UNKNOWN_MODE in modes:
            return float("nan")
        return sum(
            1.0 - float(perceived[d.window, d.action, mode])
            for d, mode in zip(self._decisions[i], modes, strict=True)
        )


class Trial:
    """One trial, fed with inputs as they come: for replay and for programs with a real person.

    Args:
        robot, belief: as for `Trials`.
        start: the first state; the world's ``start`` if None.
    """

    def __init__(
        self, robot: Decider, belief: FloatArray | None = None, start: int | None = None
    ) -> None:
        self._trials = Trials(robot, 1, belief, None if start is None else np.array([start]))
        self.robot = robot
        self.steps = 0

    @property
    def state(self) -> int:
        """The robot state."""
        return int(self._trials.state[0])

    @property
    def done(self) -> bool:
        """Whether a goal is reached."""
        return bool(self.robot.model.world.ends[self.state])

    def step(
        self,
        human_input: int | None,
        mode: int = UNKNOWN_MODE,
        outcome: Outcome | None = None,
    ) -> Decision:
        """One time step.

        Args:
            human_input: index of the input, or None.
            mode: the partner's mode behind it, where known, for the record.
            outcome: which outcome the action has; not needed where it has but one.

        Raises:
            ValueError: if the input is out of range or the trial is done.
        """
        require_situation(self.robot.model, self.state, human_input)
        given = NO_INPUT if human_input is None else human_input
        decisions = self._trials.step(np.array([0]), np.array([given]), np.array([mode]), outcome)
        self.steps += 1
        return decisions[0]

    def episode(self) -> Episode:
        """The record up to here."""
        return self._trials.episode(0)
