"""Simulated episodes, reproducible from a seed whatever the number of processes."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context

import numpy as np

from coadapt.arrays import IntArray
from coadapt.formalism import Model
from coadapt.robots import NO_INPUT, Decider, Decisions
from coadapt.simulation.episode import Episode, Trials
from coadapt.simulation.partner import Partner, draw

MAX_STEPS = 1000
"""An episode that reaches no goal ends here."""

BATCHES_PER_PROCESS = 4


def simulate(
    robot: Decider,
    partner: Partner,
    n: int,
    rng: np.random.Generator,
    *,
    max_steps: int = MAX_STEPS,
    processes: int = 1,
) -> list[Episode]:
    """Run ``n`` episodes.

    Every episode draws from a generator of its own, spawned from ``rng`` in order, so the result
    depends on the seed alone and not on how the episodes are spread over processes.

    Args:
        robot: the robot; its belief starts from its prior in every episode.
        partner: the simulated person.
        n: number of episodes, at least 0.
        rng: source of the episodes' generators.
        max_steps: number of robot actions after which an episode is given up.
        processes: number of worker processes; 1 runs in this one.

    Raises:
        ValueError: if ``n`` is negative or ``processes`` is not positive.
    """
    if n < 0:
        raise ValueError(f"number of episodes must be at least 0, not {n}")
    if processes < 1:
        raise ValueError(f"number of processes must be at least 1, not {processes}")
    generators = rng.spawn(n)
    if processes == 1:
        return _run(robot, partner, generators, max_steps)
    # Workers are started afresh, the one way that behaves alike on all systems.
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as executor:
        return _spread(executor, robot, partner, generators, max_steps, processes)


def _run(
    robot: Decider, partner: Partner, generators: Sequence[np.random.Generator], max_steps: int
) -> list[Episode]:
    model, world = robot.model, robot.model.world
    starts = np.array([draw_start(model, rng) for rng in generators], dtype=np.int64)
    trials = Trials(robot, len(generators), starts=starts)
    modes = np.array([partner.first_mode(model, rng) for rng in generators], dtype=np.int64)
    for _ in range(max_steps):
        running = trials.running
        if len(running) == 0:
            break
        windows, states = trials.window[running], trials.state[running]
        inputs = np.array(
            [
                _as_number(partner.act(model, x, int(modes[i]), generators[i]))
                for i, x in zip(map(int, running), map(int, states), strict=True)
            ]
        )
        outcome = None
        if not world.is_deterministic:
            outcome = partial(draw_outcomes, model, [generators[i] for i in running])
        actions = trials.step(running, inputs, modes[running], outcome).action
        modes[running] = [
            partner.next_mode(model, w, int(modes[i]), a, generators[i])
            for i, w, a in zip(map(int, running), map(int, windows), map(int, actions), strict=True)
        ]
    return [trials.episode(i) for i in range(len(generators))]


def draw_start(model: Model, rng: np.random.Generator) -> int:
    """The first state of an episode; nothing is drawn where there is but one."""
    starts = model.world.start_chances
    if len(starts) == 1:
        return model.world.start
    return list(starts)[draw(np.array(list(starts.values())), rng)]


def draw_outcomes(
    model: Model, generators: Sequence[np.random.Generator], decisions: Decisions
) -> IntArray:
    """``[K]`` an outcome for each decided action, each drawn from its own generator."""
    chances = model.outcome_chances(decisions.state, decisions.action, decisions.human_input)
    return np.array([draw(row, rng) for row, rng in zip(chances, generators, strict=True)])


def _as_number(human_input: int | None) -> int:
    return NO_INPUT if human_input is None else human_input


def _spread(
    executor: Executor,
    robot: Decider,
    partner: Partner,
    generators: Sequence[np.random.Generator],
    max_steps: int,
    processes: int,
) -> list[Episode]:
    size = max(1, -(-len(generators) // (processes * BATCHES_PER_PROCESS)))
    batches = [generators[i : i + size] for i in range(0, len(generators), size)]
    running = [executor.submit(_run, robot, partner, batch, max_steps) for batch in batches]
    return [episode for future in running for episode in future.result()]
