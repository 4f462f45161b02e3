"""Recordings of simulated participants by the hundred thousand, for studies of the fit itself.

`coadapt.simulation.simulate` gives every person a random generator of their own and keeps all that
a robot thought. Here many people, each with an adaptability of their own, go through a trial in
step, and only what a fit needs is kept. The events of a time step and their order are the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coadapt.analysis.adaptability.likelihood import PersonModel
from coadapt.analysis.adaptability.recordings import Recordings, starts_of
from coadapt.arrays import FloatArray, IntArray
from coadapt.robots import NO_INPUT, Robot
from coadapt.simulation.schedule import MAX_STEPS
from coadapt.simulation.simulate import anew


@dataclass(frozen=True)
class Design:
    """What the participants of a study do.

    Attributes:
        robot: the robot they work with.
        person: how they behave, but for their adaptability.
        trials: how many trials each does.
        carry_belief: whether the robot keeps its belief from one trial of a person to the next.
    """

    robot: Robot
    person: PersonModel
    trials: int = 3
    carry_belief: bool = True


def draw_recordings(design: Design, alpha: FloatArray, rng: np.random.Generator) -> Recordings:
    """The recordings of one participant for each entry of ``alpha`` ``[P]``.

    A trial that reaches no goal ends after `coadapt.simulation.schedule.MAX_STEPS` steps.
    """
    robot, person = design.robot, design.person
    model, count = robot.model, len(alpha)
    starts = np.array(list(model.world.start_chances))
    chances = np.array(list(model.world.start_chances.values()))
    robot.reset()
    prior = robot.belief
    belief = np.repeat(prior[None], count, axis=0)
    mode = _draw(np.broadcast_to(person.prior, (count, len(person.prior))), rng)
    rows: list[IntArray] = []
    for trial in range(design.trials):
        if trial > 0:
            if not person.mode_lasts:
                mode = _draw(np.broadcast_to(person.prior, (count, len(person.prior))), rng)
            if not design.carry_belief:
                belief = np.repeat(prior[None], count, axis=0)
            elif not person.mode_lasts:
                belief = anew(belief, prior)
        begin = starts[_draw(np.broadcast_to(chances, (count, len(chances))), rng)]
        window = model.windows.beginning[begin]
        for step in range(MAX_STEPS):
            on = np.flatnonzero(~model.world.ends[model.windows.state[window]])
            if len(on) == 0:
                break
            state = model.windows.state[window[on]]
            given = _inputs(person, state, mode[on], rng)
            decisions = robot.decide_many(window[on], given, belief[on])
            belief[on] = decisions.forecast
            perceived = _draw(model.perceived[window[on], decisions.action], rng)
            switches = rng.random(len(on)) < alpha[on]
            mode[on] = np.where(switches, perceived, mode[on])
            outcome = _draw(model.outcome_chances(state, decisions.action, given), rng)
            window[on] = model.windows.next[window[on], decisions.action, outcome]
            order = np.full(len(on), trial * MAX_STEPS + step)
            rows.append(np.column_stack([on, order, state, given, decisions.action]))
    steps = np.concatenate(rows)
    steps = steps[np.lexsort((steps[:, 1], steps[:, 0]))]
    which = steps[:, 0] * design.trials + steps[:, 1] // MAX_STEPS
    return Recordings(
        names=tuple(str(i + 1) for i in range(count)),
        first_trial=np.arange(count + 1) * design.trials,
        first_step=starts_of(np.bincount(which, minlength=count * design.trials)),
        state=np.ascontiguousarray(steps[:, 2]),
        human_input=np.ascontiguousarray(steps[:, 3]),
        action=np.ascontiguousarray(steps[:, 4]),
    )


def _inputs(
    person: PersonModel, state: IntArray, mode: IntArray, rng: np.random.Generator
) -> IntArray:
    """``[K]`` inputs, `NO_INPUT` for none."""
    drawn = _draw(person.input_chances[state, :, mode], rng)
    return np.where(drawn < len(person.model.input_names), drawn, NO_INPUT)


def _draw(distributions: FloatArray, rng: np.random.Generator) -> IntArray:
    """``[K]`` an index drawn from each of ``distributions`` ``[K, I]``."""
    bounds = np.cumsum(distributions, axis=1)
    point = rng.random(len(distributions)) * bounds[:, -1]
    return (point[:, None] >= bounds).sum(axis=1)
