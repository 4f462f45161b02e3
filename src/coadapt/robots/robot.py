"""What runs online: one protocol for the robots of all conditions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.formalism import Model, SharedAutonomy
from coadapt.human.history import NO_ACTION
from coadapt.human.remembered import locate

NO_INPUT = -1
"""Stands for "no input" in arrays of inputs."""


@dataclass(frozen=True)
class Decision:
    """One decision and what led to it.

    Attributes:
        window: index in ``model.windows`` of what the person remembered when it was taken.
        state: robot state in which it was taken, the one in which the window ends.
        human_input: the person's input before it, or None.
        asked: the robot action that the input asks for, or None.
        action: the action to execute.
        planned: the action of the policy, before the match rule.
        agreement: ``sum_m b(m) P(m_r = m | window, planned)``, the confidence that the modes of
            human and robot are the same, in [0, 1].
        matched: whether the match rule replaced the planned action by the input.
        belief: ``[A, M]`` over adaptability and mode, all inputs so far considered.
        forecast: ``[A, M]`` the same carried through the robot's action, before the next input.
    """

    window: int
    state: int
    human_input: int | None
    asked: int | None
    action: int
    planned: int
    agreement: float
    matched: bool
    belief: FloatArray
    forecast: FloatArray

    @property
    def adaptability_belief(self) -> FloatArray:
        """``[A]`` marginal belief over adaptability."""
        return self.belief.sum(axis=1)

    @property
    def mode_belief(self) -> FloatArray:
        """``[M]`` marginal belief over the person's mode."""
        return self.belief.sum(axis=0)


@dataclass(frozen=True)
class Decisions:
    """Many decisions at once; each attribute is that of `Decision` with a leading axis ``[N]``.

    ``human_input`` is `NO_INPUT` where there was none, ``asked`` `NO_ACTION` where nothing was
    asked for.
    """

    window: IntArray
    state: IntArray
    human_input: IntArray
    asked: IntArray
    action: IntArray
    planned: IntArray
    agreement: FloatArray
    matched: BoolArray
    belief: FloatArray
    forecast: FloatArray

    def __len__(self) -> int:
        return len(self.state)

    def __getitem__(self, i: int) -> Decision:
        human_input, asked = int(self.human_input[i]), int(self.asked[i])
        return Decision(
            window=int(self.window[i]),
            state=int(self.state[i]),
            human_input=None if human_input == NO_INPUT else human_input,
            asked=None if asked == NO_ACTION else asked,
            action=int(self.action[i]),
            planned=int(self.planned[i]),
            agreement=float(self.agreement[i]),
            matched=bool(self.matched[i]),
            belief=self.belief[i],
            forecast=self.forecast[i],
        )


class Decider(Protocol):
    """A robot in any setting: what an episode needs of it.

    All a robot remembers from step to step is its belief, and the window of its last steps that
    the person remembers. So an episode can be continued anywhere by ``reset(forecast, window)``.
    """

    @property
    def name(self) -> str:
        """Short identifier of the condition."""
        ...

    @property
    def model(self) -> Model:
        """World and people as they are in all conditions."""
        ...

    @property
    def belief(self) -> FloatArray:
        """``[A, M]`` over adaptability and mode: behind the last decision, or at the start."""
        ...

    def reset(self, belief: FloatArray | None = None, window: int | None = None) -> None:
        """Begin an episode, or continue one.

        Args:
            belief: ``[A, M]`` to begin with; the model's prior if None.
            window: index in ``model.windows`` of what the person remembers; nothing if None.
        """
        ...

    def decide_many(
        self, windows: IntArray, human_inputs: IntArray, beliefs: FloatArray
    ) -> Decisions:
        """Decide in ``N`` situations at once.

        Args:
            windows: ``[N]`` indices in ``model.windows``, none of which ends in a goal.
            human_inputs: ``[N]`` inputs, `NO_INPUT` where there was none.
            beliefs: ``[N, A, M]`` the belief in each before the input.
        """
        ...


class Robot(Decider, Protocol):
    """A robot that decides from its state and the person's input, one step at a time."""

    @property
    def model(self) -> SharedAutonomy:
        """World and people as they are in all conditions."""
        ...

    @property
    def planning_model(self) -> SharedAutonomy:
        """What the robot takes them for; its beliefs are over this model's alpha and modes."""
        ...

    def act(self, state: int, human_input: int | None) -> int:
        """Decide.

        Args:
            state: index of the robot state. Where it is not the one to which the last action led
                the person's memory of earlier steps is taken to be lost.
            human_input: index of the person's input in this state, None where there was none.

        Returns:
            Index of the action to execute.

        Raises:
            ValueError: if state or input are out of range, the state is a goal, or, with a memory
                of several steps, neither the start nor the one to which the last action led.
        """
        ...

    def decide(self, state: int, human_input: int | None) -> Decision:
        """As `act`, with the whole decision."""
        ...

    def action_values(self, decision: Decision) -> FloatArray:
        """``[A_r]`` expected discounted reward of each action in the situation of ``decision``."""
        ...


def require_situation(model: Model, state: int, human_input: int | None) -> None:
    """Raise ValueError unless a decision can be taken in ``state`` after ``human_input``."""
    world = model.world
    if not 0 <= state < world.states:
        raise ValueError(f"state {state} is not one of 0 to {world.states - 1}")
    if world.ends[state]:
        raise ValueError(f"the task has ended: {world.state_names[state]} is a goal")
    inputs = len(model.input_names)
    if human_input is not None and not 0 <= human_input < inputs:
        raise ValueError(f"input {human_input} is not one of 0 to {inputs - 1}")


def one_situation(
    model: Model,
    state: int,
    human_input: int | None,
    belief: FloatArray,
    expected: IntArray | None,
) -> tuple[IntArray, IntArray, FloatArray]:
    """The arguments of `Robot.decide_many` for one situation.

    Args:
        model, state, human_input, belief: as for `Robot.decide`.
        expected: the windows that the last action may have led to, or None before the first.

    Raises:
        ValueError: if no decision can be taken there.
    """
    require_situation(model, state, human_input)
    window = locate(model.windows, expected, state)
    given = NO_INPUT if human_input is None else human_input
    return np.array([window]), np.array([given]), belief[None]
