"""One attempt at a training session or a trial: inputs in, events out. It knows no clock."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from coadapt.arrays import FloatArray
from coadapt.formalism import SharedAutonomy
from coadapt.human.history import NO_ACTION
from coadapt.robots import NO_INPUT
from coadapt.robots.decide import DecisionsInTurn
from coadapt.robots.robot import require_situation
from coadapt.robots.setup import ConditionRobot
from coadapt.simulation.draw import draw
from coadapt.simulation.simulate import draw_start
from coadapt.study.session.events import Began, Belief, Finished, Stepped
from coadapt.study.session.plan import Stage


class Attempt:
    """A trial with a robot.

    Args:
        robot: decides.
        stage: of the session.
        attempt: how often it has begun, from 1.
        belief: ``[A][M]`` the robot's at the start; its prior if None.
        rng: draws where it begins and where moves lead, in tasks that leave it to chance.
        most_steps: it ends after so many decisions.
    """

    def __init__(
        self,
        robot: ConditionRobot,
        stage: Stage,
        attempt: int,
        belief: Belief | None,
        rng: np.random.Generator,
        most_steps: int,
    ) -> None:
        model = robot.model
        start = draw_start(model, rng)
        robot.reset(None if belief is None else np.array(belief))
        self._decisions = DecisionsInTurn(robot.tables, robot.belief)
        self._window = int(model.windows.beginning[start])
        self._steps = 0
        self._rng = rng
        self._most_steps = most_steps
        self._wanted: int | None = None
        self._forecast = as_belief(robot.belief)
        self.state = start
        self.robot = robot
        self.stage = stage
        self.began = Began(stage=stage, attempt=attempt, start=start, belief=self._forecast)

    @property
    def done(self) -> bool:
        """Whether a goal is reached or the steps have run out."""
        return bool(self.robot.model.world.ends[self.state]) or self._steps >= self._most_steps

    def step(self, human_input: int | None) -> Stepped:
        """One time step.

        Raises:
            ValueError: if the input is out of range or the trial is done.
        """
        model, state, window = self.robot.model, self.state, self._window
        require_situation(model, state, human_input)
        given = NO_INPUT if human_input is None else human_input
        planned, _, action, agreement, matched = self._decisions.decide(window, given)
        outcome = draw(model.world.outcome_chances[state, action], self._rng)
        self._window = int(model.windows.next[window, action, outcome])
        self.state = int(model.windows.state[self._window])
        self._steps += 1
        wanted = wanted_goal(model, state, human_input)
        self._wanted = self._wanted if wanted is None else wanted
        self._forecast = as_belief(self._decisions.forecast)
        return Stepped(
            step=self._steps - 1,
            state=state,
            window=window,
            input=human_input,
            action=action,
            planned=planned,
            agreement=agreement,
            matched=matched,
            belief=as_belief(self._decisions.belief),
            reached=self.state,
        )

    def finished(self) -> Finished:
        """What it came to."""
        goal = self.robot.model.world.goal_at(self.state)
        return Finished(stage=self.stage, goal=goal, wanted=self._wanted, forecast=self._forecast)


class Practice:
    """A training session, in which the robot does what each input asks for and nothing else.

    Args:
        model: the world and the inputs.
        stage, attempt, rng, most_steps: as for `Attempt`.
    """

    def __init__(
        self,
        model: SharedAutonomy,
        stage: Stage,
        attempt: int,
        rng: np.random.Generator,
        most_steps: int,
    ) -> None:
        self._model = model
        self._rng = rng
        self._most_steps = most_steps
        self._steps = 0
        self.stage = stage
        self.state = draw_start(model, rng)
        self.began = Began(stage=stage, attempt=attempt, start=self.state)

    @property
    def done(self) -> bool:
        """Whether a goal is reached or the steps have run out."""
        return bool(self._model.world.ends[self.state]) or self._steps >= self._most_steps

    def step(self, human_input: int | None) -> Stepped:
        """One time step; without an input, or one that asks for nothing, the robot stays.

        Raises:
            ValueError: if the input is out of range or the session is done.
        """
        world, inputs = self._model.world, self._model.interface
        if self.done:
            raise ValueError("the training session is done")
        if human_input is not None and not 0 <= human_input < len(inputs):
            raise ValueError(f"input {human_input} is not one of 0 to {len(inputs) - 1}")
        asked = NO_ACTION if human_input is None else int(inputs.asks[human_input])
        before = self.state
        if asked != NO_ACTION:
            chances = world.outcome_chances[before, asked]
            drawn = int(self._rng.choice(len(chances), p=chances)) if len(chances) > 1 else 0
            self.state = int(world.outcomes[before, asked, drawn])
        self._steps += 1
        return Stepped(
            step=self._steps - 1,
            state=before,
            input=human_input,
            action=None if asked == NO_ACTION else asked,
            reached=self.state,
        )

    def finished(self) -> Finished:
        """What it came to."""
        return Finished(stage=self.stage, goal=self._model.world.goal_at(self.state))


def wanted_goal(model: SharedAutonomy, state: int, human_input: int | None) -> int | None:
    """The goal that an input is for: that of the mode under which it is likeliest.

    None where there was no input, or several modes make it as likely as any: in table clearing
    "forward" is for both bottles.
    """
    if human_input is None:
        return None
    likelihood: list[float] = model.input_likelihood[state, human_input].tolist()
    most = max(likelihood)
    best = [mode for mode, value in enumerate(likelihood) if most - value <= 1e-9 * most]
    return best[0] if len(best) == 1 else None


def as_belief(belief: FloatArray) -> Belief:
    """``belief`` ``[A, M]`` in a form that is stored and read back to the same bit."""
    rows: Iterable[list[float]] = belief.tolist()
    return tuple(tuple(row) for row in rows)
