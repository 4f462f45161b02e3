"""Many episodes at once: what came of each, without the record of its steps."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np

from coadapt.arrays import BoolArray, FloatArray, IntArray
from coadapt.formalism import Model
from coadapt.robots import Decider
from coadapt.robots.tables import TabledRobot, as_floats
from coadapt.simulation.draw import Streams
from coadapt.simulation.partners import AnyPartner, DescribedPartner
from coadapt.simulation.schedule import MAX_STEPS, Schedule
from coadapt.simulation.simulate import Course, courses, require_count
from coadapt.simulation.world_tables import world_tables
from coadapt.worlds.world import NO_GOAL

AT_ONCE = 10_000
"""People after whom an interruption is looked at."""


@dataclass(frozen=True, eq=False)
class Batch:
    """What came of the episodes of ``n`` people who did ``T`` trials each.

    Attributes:
        goal: ``[n, T]`` index of the goal reached, `NO_GOAL` where there was none.
        reward: ``[n, T]`` reward of that goal, in the paper's units; 0 without a goal.
        discounted_return: ``[n, T]`` discounted sum of rewards, penalties and costs of moves, as in
            `coadapt.simulation.Evaluation`.
        steps: ``[n, T]`` number of robot actions.
        disagreement: ``[n, T]`` expected number of steps in which the person saw the robot in
            another mode than their own, by what they remember.
        overridden: ``[n, T]`` number of steps in which the robot did something else than the input
            asked for.
        first_mode: ``[n, T]`` the person's mode at the start.
        last_mode: ``[n, T]`` their mode after the robot's last action.
        switched: ``[n, T]`` whether their mode changed at least once in the trial.
        first_kind, last_kind: ``[n, T]`` their kind, see `PartnerTables`: 0 where there is but one.
        taken: ``[X, A, N]`` how often each action was taken in each state with each outcome, in all
            episodes together; where it leads is in ``world.outcomes``.
        belief: ``[n, T, A, M]`` the robot's belief behind its last decision; None if it was not
            asked for.
    """

    goal: IntArray
    reward: FloatArray
    discounted_return: FloatArray
    steps: IntArray
    disagreement: FloatArray
    overridden: IntArray
    first_mode: IntArray
    last_mode: IntArray
    switched: BoolArray
    first_kind: IntArray
    last_kind: IntArray
    taken: IntArray
    belief: FloatArray | None = None

    @property
    def people(self) -> int:
        """``n``."""
        return len(self.goal)

    @property
    def trials(self) -> int:
        """``T``."""
        return self.goal.shape[1]


def simulate_batch(
    robot: Decider,
    partner: AnyPartner,
    n: int,
    rng: np.random.Generator,
    *,
    trials: int = 1,
    carry_belief: bool = True,
    keep_mode: bool = True,
    max_steps: int = MAX_STEPS,
    beliefs: bool = False,
) -> Batch:
    """Run the episodes of ``n`` people: those that `simulate` gives for the same seed.

    Whole episodes run in compiled code where robot and partner can be told as arrays, as all of
    coadapt's can. Others are simulated step by step, to the same effect.

    Args:
        robot: the robot; its belief starts from its prior with every person.
        partner: the simulated person.
        n: number of people, at least 0.
        rng: source of the key of their random generators.
        trials, carry_belief, keep_mode, max_steps: see `Schedule`. As in the paper's study a person
            keeps the mode in which their last trial ended, unless told otherwise.
        beliefs: whether to keep the robot's beliefs.

    Raises:
        ValueError: if a number is out of its range.
    """
    schedule = Schedule(trials, carry_belief, keep_mode, max_steps)
    require_count(n)
    streams = Streams.of(rng)
    if isinstance(robot, TabledRobot) and isinstance(partner, DescribedPartner):
        return _compiled(robot, partner, n, streams, schedule, beliefs)
    return batch_of(robot, courses(robot, partner, streams, range(n), schedule), trials, beliefs)


class _Known(TabledRobot, Decider, Protocol):
    """A robot that decides, and can be told as arrays."""


def _compiled(
    robot: _Known,
    partner: DescribedPartner,
    n: int,
    streams: Streams,
    schedule: Schedule,
    beliefs: bool,
) -> Batch:
    # Imported now: whoever simulates nothing need not wait for the compiler.
    from coadapt.simulation.kernels.run import Tallies, new_scratch, run_people  # noqa: PLC0415

    model = robot.model
    robot.reset()
    prior = as_floats(robot.belief)
    world, person = world_tables(model), partner.tables(model).checked(model)
    shape = (n, schedule.trials)
    goal, steps, overridden, first_mode, last_mode, first_kind, last_kind = np.zeros(
        (7, *shape), dtype=np.int64
    )
    reward, discounted_return, disagreement = np.zeros((3, *shape))
    out = Tallies(
        goal=goal,
        reward=reward,
        discounted_return=discounted_return,
        steps=steps,
        disagreement=disagreement,
        overridden=overridden,
        first_mode=first_mode,
        last_mode=last_mode,
        switched=np.zeros(shape, dtype=np.bool_),
        first_kind=first_kind,
        last_kind=last_kind,
        taken=np.zeros((model.world.states, *world.next.shape[1:]), dtype=np.int64),
        belief=np.zeros((n if beliefs else 0, schedule.trials, *prior.shape)),
    )
    scratch = new_scratch(robot.tables.room, *prior.shape)
    key = np.uint64(streams.key)
    for first in range(0, n, AT_ONCE):
        people = (first, min(first + AT_ONCE, n))
        with np.errstate(over="ignore"):  # words wrap around, also where nothing is compiled
            done = run_people(
                world,
                robot.tables,
                person,
                prior,
                key,
                people,
                schedule.carry_belief,
                schedule.keep_mode,
                schedule.max_steps,
                scratch,
                out,
            )
        if not done:
            raise ValueError("the person took an action that belongs to no mode, where modes show")
    return Batch(
        goal=out.goal,
        reward=out.reward,
        discounted_return=out.discounted_return,
        steps=out.steps,
        disagreement=out.disagreement,
        overridden=out.overridden,
        first_mode=out.first_mode,
        last_mode=out.last_mode,
        switched=out.switched,
        first_kind=out.first_kind,
        last_kind=out.last_kind,
        taken=out.taken,
        belief=out.belief if beliefs else None,
    )


def batch_of(robot: Decider, found: list[Course], trials: int, beliefs: bool) -> Batch:
    """What came of ``found``, the courses of ``trials`` trials of each person in a row."""
    model = robot.model
    shape = (len(found) // trials, trials)
    episodes = [course.episode for course in found]
    taken = np.zeros((model.world.states, *model.windows.next.shape[1:]), dtype=np.int64)
    for course in found:
        for decision, outcome in zip(course.episode.decisions, course.outcomes, strict=True):
            taken[decision.state, decision.action, outcome] += 1
    ends = [NO_GOAL if e.goal is None else e.goal for e in episodes]
    last = [e.decisions[-1].belief for e in episodes]
    return Batch(
        goal=np.array(ends, dtype=np.int64).reshape(shape),
        reward=np.array([e.reward for e in episodes], dtype=np.float64).reshape(shape),
        discounted_return=np.array([_collected(model, e) for e in found]).reshape(shape),
        steps=np.array([e.steps for e in episodes], dtype=np.int64).reshape(shape),
        disagreement=np.array([e.disagreement for e in episodes]).reshape(shape),
        overridden=np.array([e.overridden for e in episodes], dtype=np.int64).reshape(shape),
        first_mode=np.array([c.before.mode for c in found], dtype=np.int64).reshape(shape),
        last_mode=np.array([c.after.mode for c in found], dtype=np.int64).reshape(shape),
        switched=np.array([_switched(c) for c in found], dtype=np.bool_).reshape(shape),
        first_kind=np.array([c.before.kind for c in found], dtype=np.int64).reshape(shape),
        last_kind=np.array([c.after.kind for c in found], dtype=np.int64).reshape(shape),
        taken=taken,
        belief=np.reshape(last, (*shape, *robot.belief.shape)) if beliefs else None,
    )


def _switched(course: Course) -> bool:
    return any(a != b for a, b in pairwise((*course.episode.modes, course.after.mode)))


def _collected(model: Model, course: Course) -> float:
    total, scale = 0.0, 1.0
    for decision, mode in zip(course.episode.decisions, course.episode.modes, strict=True):
        total += scale * float(model.reward[decision.window, decision.action, mode])
        scale *= model.discount
    return total + scale * course.episode.reward
