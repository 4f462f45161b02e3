"""One attempt at a training session or a trial: inputs in, events out. It knows no clock."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

import numpy as np

from coadapt.arrays import FloatArray
from coadapt.formalism import SharedAutonomy
from coadapt.human.history import NO_ACTION
from coadapt.robots import Robot
from coadapt.simulation import Trial
from coadapt.simulation.simulate import draw_outcomes, draw_start
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
        robot: Robot,
        stage: Stage,
        attempt: int,
        belief: Belief | None,
        rng: np.random.Generator,
        most_steps: int,
    ) -> None:
        start = draw_start(robot.model, rng)
        given = None if belief is None else np.array(belief)
        self._trial = Trial(robot, given, start)
        self._rng = rng
        self._most_steps = most_steps
        self._wanted: int | None = None
        self._forecast = as_belief(robot.belief)
        self.robot = robot
        self.stage = stage
        self.began = Began(stage=stage, attempt=attempt, start=start, belief=self._forecast)

    @property
    def state(self) -> int:
        """The robot state."""
        return self._trial.state

    @property
    def done(self) -> bool:
        """Whether a goal is reached or the steps have run out."""
        return self._trial.done or self._trial.steps >= self._most_steps

    def step(self, human_input: int | None) -> Stepped:
        """One time step.

        Raises:
            ValueError: if the input is out of range or the trial is done.
        """
        model = self.robot.model
        outcome = None
        if not model.world.is_deterministic:
            outcome = partial(draw_outcomes, model, [self._rng])
        decision = self._trial.step(human_input, outcome=outcome)
        wanted = wanted_goal(model, decision.state, human_input)
        self._wanted = self._wanted if wanted is None else wanted
        self._forecast = as_belief(decision.forecast)
        return Stepped(
            step=self._trial.steps - 1,
            state=decision.state,
            window=decision.window,
            input=human_input,
            action=decision.action,
            planned=decision.planned,
            agreement=float(decision.agreement),
            matched=decision.matched,
            belief=as_belief(decision.belief),
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
