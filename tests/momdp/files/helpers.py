"""Comparing problems, and reading text as if it were a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from coadapt.errors import InputError
from coadapt.momdp import MOMDP
from coadapt.momdp.files import read_pomdp


def problem_from(directory: Path, text: str | bytes, suffix: str = ".pomdp") -> MOMDP:
    """The problem in a file with the contents ``text``."""
    path = directory / f"problem{suffix}"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_pomdp(path)


def refusal(directory: Path, text: str | bytes, suffix: str = ".pomdp") -> str:
    """What the error says about the contents ``text``, from the line on: ``12: found ...``."""
    with pytest.raises(InputError) as caught:
        problem_from(directory, text, suffix)
    message = str(caught.value)
    assert "\n" not in message
    start = f"{directory / 'problem'}{suffix}:"
    assert message.startswith(start), message
    return message[len(start) :].strip()


def joint(problem: MOMDP, x: int, a: int) -> dict[int, np.ndarray]:
    """For each successor of (x, a) the map ``[Y, Y']``."""
    return {
        int(problem.edge_next[e]): problem.transition.matrix(int(problem.edge_map[e]))
        for e in problem.edges(x, a)
    }


def reached(problem: MOMDP, a: int) -> np.ndarray:
    """``[X', Y']`` whether action ``a`` can lead there."""
    states, size, _, _ = problem.shape
    arrives = np.zeros((states, size), dtype=bool)
    for x in range(states):
        for x_next, matrix in joint(problem, x, a).items():
            arrives[x_next] |= matrix.any(axis=0)
    return arrives


def assert_same(first: MOMDP, second: MOMDP, tolerance: float = 1e-12) -> None:
    """Both problems have the same names, numbers and roots; observations where they can be made."""
    for names in ("observed_names", "hidden_names", "action_names", "observation_names"):
        assert getattr(first, names) == getattr(second, names)
    assert first.shape == second.shape
    assert first.discount == second.discount
    close = {"rtol": 0.0, "atol": tolerance}
    np.testing.assert_allclose(first.reward, second.reward, **close)
    assert [root.x for root in first.roots] == [root.x for root in second.roots]
    for one, other in zip(first.roots, second.roots, strict=True):
        np.testing.assert_allclose(one.probability, other.probability, **close)
        np.testing.assert_allclose(one.belief, other.belief, **close)
    assert_same_moves(first, second, tolerance)


def assert_same_moves(first: MOMDP, second: MOMDP, tolerance: float = 1e-12) -> None:
    """The observed states of ``first`` have the same transitions and observations in ``second``."""
    close = {"rtol": 0.0, "atol": tolerance}
    states, _, actions, _ = first.shape
    compared: set[tuple[int, int]] = set()
    for x in range(states):
        for a in range(actions):
            edges, others = first.edges(x, a), second.edges(x, a)
            assert [first.edge_next[e] for e in edges] == [second.edge_next[e] for e in others]
            compared |= {
                (int(first.edge_map[e]), int(second.edge_map[f]))
                for e, f in zip(edges, others, strict=True)
            }
    for one, other in compared:
        np.testing.assert_allclose(
            first.transition.matrix(one), second.transition.matrix(other), **close
        )
    seen: set[tuple[int, int]] = set()
    for a in range(actions):
        arrives = reached(first, a) if first.states < 2000 else None
        for x in range(states):
            pair = int(first.observation_index[a, x]), int(second.observation_index[a, x])
            if arrives is None and pair in seen:
                continue
            seen.add(pair)
            chosen = slice(None) if arrives is None else arrives[x]
            np.testing.assert_allclose(
                first.observation[pair[0]][chosen], second.observation[pair[1]][chosen], **close
            )
