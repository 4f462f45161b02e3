"""Whether a robot guides, probes or complies."""

from __future__ import annotations

import numpy as np
import pytest

from coadapt.robots import Robot
from coadapt.robots.setup import RobotSetup
from coadapt.simulation import SimulatedPartner, evaluate, simulate
from coadapt.simulation.conduct import CLEARLY, FEW, Phase, insisting_steps, phase

LEFT = SimulatedPartner(0.0, 0)


def counted(robot: Robot, runs: int) -> np.ndarray:
    """The steps in which the robot insists, counted in simulated episodes by the definition."""
    perceived = robot.model.perceived
    found: list[int] = []
    for episode in simulate(robot, LEFT, runs, np.random.default_rng(5)):
        count = 0
        for d in episode.decisions:
            if d.asked is not None and d.asked != d.action:
                here = perceived[d.window]
                count += bool(here[d.action, 0] < here[d.asked, 0] - CLEARLY)
        found.append(count)
    return np.array(found)


@pytest.mark.parametrize("name", ["mutual_adaptation", "one_way_adaptation", "no_adaptation"])
@pytest.mark.parametrize("memory", [1, 2])
def test_expected_steps_are_those_of_episodes(name: str, memory: int) -> None:
    setup = RobotSetup(
        robot=name,  # pyright: ignore[reportArgumentType]
        columns=7,
        rows=3,
        discount=0.9,
        memory=memory,
        gap=0.01,
    )
    robot = setup.build()
    steps = counted(robot, 2000)
    error = steps.std() / np.sqrt(len(steps))
    assert abs(insisting_steps(robot, LEFT) - steps.mean()) <= 4 * error + 1e-3


def test_the_paper_s_robot_probes_then_complies() -> None:
    # Sec. 5.4: it complies with User 1, after moves forward, which commit to nothing.
    for cost, gap, expected in (
        (-0.32, 1.0, Phase.PROBES),
        (-0.32, 0.1, Phase.COMPLIES),
        (-0.01, 1.0, Phase.GUIDES),
    ):
        robot = RobotSetup(disagreement_cost=cost, right_reward=10 + gap).build()
        optimal = float(evaluate(robot, LEFT, tolerance=0.01).goal_probability[1])
        assert phase(optimal, insisting_steps(robot, LEFT)) is expected


def test_the_limits_of_the_phases() -> None:
    assert phase(0.5, 0.0) is Phase.GUIDES
    assert phase(0.49, FEW) is Phase.PROBES
    assert phase(0.49, FEW - 1e-9) is Phase.COMPLIES
