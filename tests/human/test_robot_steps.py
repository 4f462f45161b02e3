"""The windows of the robot's steps against whole histories."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.human.history import NO_ACTION, NO_STATE, NO_WINDOW
from coadapt.human.robot_steps import StepWindows
from coadapt.worlds.joint import JointWorld
from tests.worlds.joint_strategies import joint_worlds


@given(joint_worlds(), st.integers(1, 4), st.integers(0, 2**32))
def test_windows_are_the_ends_of_histories(world: JointWorld, memory: int, seed: int) -> None:
    human_actions = world.human_actions
    windows = StepWindows.of(world.outcomes, list(world.starts), world.ends, memory, human_actions)
    rng = np.random.default_rng(seed)
    for start in world.starts:
        window, state = int(windows.beginning[start]), start
        steps: list[tuple[int, int]] = []
        human_action = NO_ACTION
        for _ in range(6):
            kept = steps[max(0, len(steps) - memory + 1) :]
            missing = memory - 1 - len(kept)
            assert windows.state[window] == state
            assert windows.human_action[window] == human_action
            past = zip(windows.past_states[window], windows.past_actions[window], strict=True)
            assert list(past) == [*kept, *[(0, NO_ACTION)] * missing]
            if world.ends[state]:
                assert (windows.next[window] == window).all()
                break
            # An outcome that is none leads nowhere.
            np.testing.assert_array_equal(
                windows.next[window] == NO_WINDOW, world.outcomes[state] == NO_STATE
            )
            a, outcome = (int(i) for i in rng.choice(np.argwhere(windows.next[window] >= 0)))
            steps.append((state, a))
            state = int(world.outcomes[state, a, outcome])
            human_action = outcome // (windows.next.shape[2] // human_actions)
            window = int(windows.next[window, a, outcome])


@pytest.mark.parametrize("memory", [0, 101])
def test_the_memory_is_limited(memory: int) -> None:
    moves = np.zeros((1, 1, 1), dtype=np.int64)
    with pytest.raises(ValueError, match="memory must be 1 to 100 steps"):
        StepWindows.of(moves, [0], np.array([False]), memory, 1)
