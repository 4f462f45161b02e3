"""The robots of a study: one for each condition and chosen goal, planned once and kept on disk."""

from __future__ import annotations

import os
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path

import msgspec

from coadapt.formalism import SharedAutonomy
from coadapt.momdp.files import read_policy, write_policy
from coadapt.momdp.policy import AlphaVectorPolicy
from coadapt.robots.setup import (
    ConditionRobot,
    Progress,
    planned_policy,
    planning_problem,
    robot_with,
)
from coadapt.robots.task_setup import TaskSetup
from coadapt.study.protocol import Condition, Study
from coadapt.study.protocol.reader import study_task
from coadapt.tasks import Task

POLICIES = "policies"
"""The folder of a study's directory that holds its policies."""

Robots = Mapping[tuple[str, int], ConditionRobot]
"""By the name of the condition and the index of the chosen goal."""


def model_of(robots: Robots) -> SharedAutonomy:
    """World and inputs, which all robots of a study have in common."""
    return next(iter(robots.values())).model


def setup_of(study: Study, task: Task, condition: Condition, choice: int) -> TaskSetup:
    """What the robot of ``condition`` is built from, for a participant who chose goal ``choice``.

    The other goal is the optimal one (Sec. 6.3).
    """
    rewards = study.rewards
    goals = tuple(
        msgspec.structs.replace(goal, reward=rewards.other if i == choice else rewards.optimal)
        for i, goal in enumerate(task.goals)
    )
    return TaskSetup(
        task=msgspec.structs.replace(task, goals=goals),
        robot=condition.robot,
        match_threshold=condition.match_threshold,
    )


def load_robots(
    study: Study, directory: str | os.PathLike[str], progress: Progress | None = None
) -> Robots:
    """All robots of ``study``; policies that are not in ``directory`` yet are planned now.

    Raises:
        InputError: if a policy file there cannot be read.
        KeyboardInterrupt: if planning was interrupted; the policies planned so far are kept.
    """
    task = study_task(study, directory)
    return {
        (condition.name, choice): _load(
            setup_of(study, task, condition, choice), directory, progress
        )
        for condition in study.conditions
        for choice in range(len(task.goals))
    }


def _load(
    setup: TaskSetup, directory: str | os.PathLike[str], progress: Progress | None
) -> ConditionRobot:
    model = setup.model()
    problem = planning_problem(setup, model)
    if problem is None:
        return robot_with(setup, model, None)
    path = Path(directory) / POLICIES / f"{_digest(setup)}.coadapt"
    policy: AlphaVectorPolicy
    if path.exists():
        policy = read_policy(path)
    else:
        policy = planned_policy(problem, setup.gap, progress)
        path.parent.mkdir(exist_ok=True)
        write_policy(policy, path)
    return robot_with(setup, model, policy)


def _digest(setup: TaskSetup) -> str:
    """A name for the policy: the same for setups that plan alike."""
    alike = msgspec.structs.replace(setup, match_threshold=0.0)
    return sha256(msgspec.json.encode(alike, order="deterministic")).hexdigest()[:32]
