"""Simulated episodes one by one, reproducible from a seed whatever the number of processes."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context

import numpy as np

from coadapt.arrays import FloatArray, IntArray
from coadapt.formalism import Model
from coadapt.robots import NO_INPUT, Decider, Decisions
from coadapt.simulation.draw import Streams, draw
from coadapt.simulation.episode import Episode, Trials
from coadapt.simulation.partners import NEW_MODE, ActingPartner, AnyPartner, Person, acting
from coadapt.simulation.schedule import MAX_STEPS, Schedule

BATCHES_PER_PROCESS = 4


@dataclass(frozen=True)
class Course:
    """One trial with what is left of the person.

    Attributes:
        episode: the trial.
        before: the person at its start.
        after: the person at its end.
        outcomes: which outcome each action had.
    """

    episode: Episode
    before: Person
    after: Person
    outcomes: tuple[int, ...]


def simulate(
    robot: Decider,
    partner: AnyPartner,
    n: int,
    rng: np.random.Generator,
    *,
    trials: int = 1,
    carry_belief: bool = True,
    keep_mode: bool = True,
    max_steps: int = MAX_STEPS,
    processes: int = 1,
) -> list[Episode]:
    """Run the episodes of ``n`` people.

    Each has a random generator of their own (`coadapt.simulation.draw.Streams`), whose key alone
    is drawn from ``rng``. So the result depends on the seed and not on how the episodes are spread
    over processes, and the first people are the same however many follow. `simulate_batch` runs the
    same episodes, but keeps only what came of each.

    Args:
        robot: the robot; its belief starts from its prior with every person.
        partner: the simulated person.
        n: number of people, at least 0.
        rng: source of the key.
        trials, carry_belief, keep_mode, max_steps: see `Schedule`.
        processes: number of worker processes; 1 runs in this one.

    Returns:
        ``n * trials`` episodes, those of one person in a row.

    Raises:
        ValueError: if a number is out of its range.
    """
    schedule = Schedule(trials, carry_belief, keep_mode, max_steps)
    require_count(n)
    if processes < 1:
        raise ValueError(f"number of processes must be at least 1, not {processes}")
    streams = Streams.of(rng)
    if processes == 1:
        found = courses(robot, partner, streams, range(n), schedule)
        return [course.episode for course in found]
    # Workers are started afresh, the one way that behaves alike on all systems.
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as executor:
        return _spread(executor, robot, partner, streams, n, schedule, processes)


def courses(
    robot: Decider, partner: AnyPartner, streams: Streams, people: range, schedule: Schedule
) -> list[Course]:
    """The trials of some ``people``, side by side; those of one person in a row."""
    model = robot.model
    person = acting(partner, model)
    generators = [streams[i] for i in people]
    found: list[list[Course]] = [[] for _ in people]
    belief: FloatArray | None = None
    for trial in range(schedule.trials):
        starts = np.array([draw_start(model, rng) for rng in generators], dtype=np.int64)
        began: list[Person] = []
        for i, rng in enumerate(generators):
            before = found[i][-1].after if trial > 0 else None
            if before is not None and not schedule.keep_mode:
                before = before._replace(mode=NEW_MODE)
            began.append(person.begin(model, int(starts[i]), before, rng))
        trials = Trials(robot, len(people), belief, starts)
        ended, outcomes, apart = list(began), [[0][:0] for _ in people], [0.0 for _ in people]
        for _ in range(schedule.max_steps):
            running = trials.running
            if len(running) == 0:
                break
            now = list(map(int, running))
            windows, states = trials.window[running], trials.state[running]
            inputs = [
                person.act(model, int(x), ended[i], generators[i])
                for i, x in zip(now, states, strict=True)
            ]
            given = np.array([NO_INPUT if g is None else g for g in inputs])
            decisions = trials.decide(running, given, np.array([ended[i].mode for i in now]))
            which = draw_outcomes(model, [generators[i] for i in now], decisions)
            trials.move(running, decisions, which)
            for i, w, a, o in zip(now, windows, decisions.action, which, strict=True):
                if isinstance(person, ActingPartner):
                    apart[i] += person.seen_apart(ended[i], int(a))
                after = person.react(model, int(w), ended[i], int(a), int(o), generators[i])
                outcomes[i].append(int(o))
                ended[i] = after
        for i in range(len(people)):
            episode = trials.episode(i, apart[i] if isinstance(person, ActingPartner) else None)
            found[i].append(Course(episode, began[i], ended[i], tuple(outcomes[i])))
        if schedule.carry_belief:
            belief = trials.forecast
            if not schedule.keep_mode:
                belief = anew(belief, model.prior)
    return [course for each in found for course in each]


def anew(belief: FloatArray, prior: FloatArray) -> FloatArray:
    """``[..., A, M]``: what ``belief`` says of adaptability, with the modes of ``prior``."""
    # Column by column, in the order of the compiled loop.
    level = sum(belief[..., m] for m in range(belief.shape[-1]))
    return np.asarray(level)[..., None] * mode_prior(prior)


def mode_prior(prior: FloatArray) -> FloatArray:
    """``[M]`` the part of ``prior`` ``[A, M]`` about the mode."""
    return prior.sum(axis=0)


def require_count(n: int) -> None:
    """Raise ValueError unless ``n`` people can be simulated."""
    if n < 0:
        raise ValueError(f"number of episodes must be at least 0, not {n}")


def draw_start(model: Model, rng: np.random.Generator) -> int:
    """The first state of an episode."""
    starts = model.world.start_chances
    return list(starts)[draw(np.array(list(starts.values())), rng)]


def draw_outcomes(
    model: Model, generators: Sequence[np.random.Generator], decisions: Decisions
) -> IntArray:
    """``[K]`` an outcome for each decided action, each drawn from its own generator."""
    chances = model.outcome_chances(decisions.state, decisions.action, decisions.human_input)
    return np.array([draw(row, rng) for row, rng in zip(chances, generators, strict=True)])


def _run(
    robot: Decider, partner: AnyPartner, streams: Streams, people: range, schedule: Schedule
) -> list[Episode]:
    return [course.episode for course in courses(robot, partner, streams, people, schedule)]


def _spread(
    executor: Executor,
    robot: Decider,
    partner: AnyPartner,
    streams: Streams,
    n: int,
    schedule: Schedule,
    processes: int,
) -> list[Episode]:
    size = max(1, -(-n // (processes * BATCHES_PER_PROCESS)))
    parts = [range(i, min(i + size, n)) for i in range(0, n, size)]
    running = [executor.submit(_run, robot, partner, streams, part, schedule) for part in parts]
    return [episode for future in running for episode in future.result()]
