"""Whole episodes: the compiled twin of `coadapt.simulation.simulate.courses`.

People draw the same numbers in the same order as `coadapt.simulation.partners.ActingPartner`, and
robots decide by the same code, so that both loops give the same episodes to the bit.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.jit import bare, kernel
from coadapt.robots.kernels.belief import copy
from coadapt.robots.kernels.decide import NO_INPUT, decide
from coadapt.robots.tables import RobotTables
from coadapt.simulation.kernels.streams import (
    NOTHING,
    Stream,
    Word,
    begin_stream,
    draw,
    draw_part,
    new_stream,
)
from coadapt.simulation.partners.tables import PartnerTables
from coadapt.simulation.world_tables import WorldTables

NO_GOAL = -1
NO_WINDOW = -1


class Tallies(NamedTuple):
    """What is counted of the trials, see `coadapt.simulation.Batch`."""

    goal: IntArray  # [n, T]
    reward: FloatArray  # [n, T]
    discounted_return: FloatArray  # [n, T]
    steps: IntArray  # [n, T]
    disagreement: FloatArray  # [n, T]
    overridden: IntArray  # [n, T]
    first_mode: IntArray  # [n, T]
    last_mode: IntArray  # [n, T]
    switched: BoolArray  # [n, T]
    first_kind: IntArray  # [n, T]
    last_kind: IntArray  # [n, T]
    taken: IntArray  # [X, A, H * N]
    belief: FloatArray  # [n, T, L, M], or [0, T, L, M] where they are not kept


class Scratch(NamedTuple):
    """What one episode needs."""

    stream: Stream
    belief: FloatArray  # [L, M] behind the last decision
    forecast: FloatArray  # [L, M] before the next input
    decision: FloatArray  # room for a decision
    answers: FloatArray  # [M] chance that each robot mode is seen and answered


def new_scratch(room: int, values: int, modes: int) -> Scratch:
    """Scratch for a robot with `RobotTables.room` and a belief ``[values, modes]``."""
    return Scratch(
        new_stream(),
        np.zeros((values, modes)),
        np.zeros((values, modes)),
        np.zeros(room),
        np.zeros(modes),
    )


class Now(NamedTuple):
    """Where a person is: their mode, their kind, what they remember."""

    mode: int
    kind: int
    window: int


@kernel
def run_people(
    w: WorldTables,
    r: RobotTables,
    p: PartnerTables,
    prior: FloatArray,
    key: Word,
    people: tuple[int, int],
    carry_belief: bool,
    keep_mode: bool,
    max_steps: int,
    scratch: Scratch,
    out: Tallies,
) -> bool:
    """Run the trials of some people.

    Args:
        w, r, p: world, robot and person.
        prior: ``[L, M]`` the robot's belief at the start.
        key: of the streams.
        people: the first of them and the one after the last.
        carry_belief, keep_mode, max_steps: see `coadapt.simulation.schedule.Schedule`.
        scratch: from `new_scratch`.
        out: is written for these people.

    Returns:
        Whether all went well: not if somebody acted in a way that belongs to no mode where modes
        are seen.
    """
    for i in range(people[0], people[1]):
        begin_stream(scratch.stream, key, i)
        mode = 0
        kind = 0
        for t in range(out.goal.shape[1]):
            start = int(w.starts[draw(scratch.stream, w.start_chance)])
            if t == 0:
                kind = draw(scratch.stream, p.first_kind)
            if t == 0 or not keep_mode:
                mode = draw(scratch.stream, p.first_mode)
            if t == 0 or not carry_belief:
                copy(prior, scratch.forecast)
            elif not keep_mode:
                forget_mode(w.mode_prior, scratch.forecast)
            now = Now(mode, kind, int(p.beginning[start]))
            window = int(w.beginning[start])
            now = run_trial(w, r, p, now, window, max_steps, scratch, out, i, t)
            if now.window == NO_WINDOW:
                return False
            mode = now.mode
            kind = now.kind
    return True


@bare
def forget_mode(mode_prior: FloatArray, belief: FloatArray) -> None:
    """Keep of ``belief`` ``[L, M]`` what it says of adaptability, in place."""
    values, modes = belief.shape
    for i in range(values):
        mass = 0.0
        for m in range(modes):
            mass += belief[i, m]
        for m in range(modes):
            belief[i, m] = mass * mode_prior[m]


@bare
def run_trial(
    w: WorldTables,
    r: RobotTables,
    p: PartnerTables,
    now: Now,
    window: int,
    max_steps: int,
    s: Scratch,
    out: Tallies,
    i: int,
    t: int,
) -> Now:
    """One trial, written to ``out`` at ``[i, t]``.

    Returns:
        The person at its end, their window NO_WINDOW if they acted in no mode.
    """
    out.first_mode[i, t] = now.mode
    out.first_kind[i, t] = now.kind
    none = p.inputs.shape[3] - 1
    human_actions, branching = w.chance.shape[2:]
    steps = 0
    overridden = 0
    apart = 0.0
    total = 0.0
    scale = 1.0
    switched = False
    goal = NO_GOAL
    while steps < max_steps:
        x = w.state[window]
        human_input = draw(s.stream, p.inputs[p.uses[now.kind], x, now.mode])
        if human_input == none:
            human_input = NO_INPUT
        copy(s.forecast, s.belief)
        _, asked, action, _, _ = decide(r, window, human_input, s.belief, s.forecast, s.decision)
        first = human_input if human_actions > 1 else 0
        outcome = first * branching + draw(s.stream, w.chance[x, action, first])
        out.taken[x, action, outcome] += 1
        apart += 1.0 - p.perceived[now.window, action, now.mode]
        total += scale * w.reward[window, action, now.mode]
        scale *= w.discount
        if asked >= 0 and asked != action:
            overridden += 1
        steps += 1
        before = now.mode
        now = react(p, now, action, outcome, s)
        switched = switched or now.mode != before
        window = w.next[window, action, outcome]
        if window == NO_WINDOW:
            return Now(now.mode, now.kind, NO_WINDOW)
        goal = w.goal[w.state[window]]
        if goal != NO_GOAL:
            break
    reward = 0.0 if goal == NO_GOAL else w.worth[goal]
    out.goal[i, t] = goal
    out.reward[i, t] = reward
    out.discounted_return[i, t] = total + scale * reward
    out.steps[i, t] = steps
    out.disagreement[i, t] = apart
    out.overridden[i, t] = overridden
    out.last_mode[i, t] = now.mode
    out.last_kind[i, t] = now.kind
    out.switched[i, t] = switched
    if out.belief.shape[0] > 0:
        copy(s.belief, out.belief[i, t])
    return now


@bare
def react(p: PartnerTables, now: Now, action: int, outcome: int, s: Scratch) -> Now:
    """The person after the robot acted, see `ActingPartner.react`."""
    mode = now.mode
    for m in range(s.answers.shape[0]):
        s.answers[m] = p.rate[now.kind, m] * p.perceived[now.window, action, m]
    answered = draw_part(s.stream, s.answers)
    if answered != NOTHING:
        mode = draw(s.stream, p.answer[answered])
    elif p.kept.shape[0] > 0:
        mode = draw(s.stream, p.kept[now.window, action, mode])
    mode = draw(s.stream, p.wander[mode])
    kind = draw(s.stream, p.change[now.kind])
    return Now(mode, kind, p.next[now.window, action, outcome])
