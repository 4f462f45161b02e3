"""Writes problems of the published families that nobody has published, to try a solver on.

    python benchmarks/other_problems.py DIRECTORY
    python benchmarks/solve.py --problems DIRECTORY/*.pomdpx --reference PATH/TO/pomdpsol

*rocks_N_K* is RockSample on N x N cells with K rocks (Smith and Simmons, UAI 2004), *tag_H_W* is
Tag on H x W cells (Pineau, Gordon, Thrun, IJCAI 2003), *maze_N_S* a robot that turns and walks
among N x N cells, some of them walls, and sees walls next to it, not always rightly (as in Littman,
Cassandra, Kaelbling, ICML 1995). Positions of rocks, walls and goals are drawn from fixed seeds.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from coadapt.momdp import MOMDP, Root
from coadapt.momdp.files import write_pomdpx

STEPS = ((-1, 0), (0, 1), (1, 0), (0, -1))
"""North, east, south, west, as rows and columns."""

DISCOUNT = 0.95


def rocks(size: int, count: int, seed: int) -> MOMDP:
    """RockSample: 10 for a good rock and for leaving to the east, -10 for a bad rock.

    Sampling where there is no rock and walking off elsewhere costs 100.
    """
    rng = np.random.default_rng(seed)
    at = [int(cell) for cell in rng.choice(size * size, count, replace=False)]
    outside = size * size
    actions, hidden = 5 + count, 2**count
    good = (np.arange(hidden)[:, None] >> np.arange(count)) & 1  # [Y, K]
    transition_x = np.zeros((outside + 1, actions, outside + 1))
    transition_y = np.zeros((outside + 1, actions, hidden, hidden))
    transition_y[:] = np.eye(hidden)
    observation = np.zeros((actions, outside + 1, hidden, 3))  # nothing, bad, good
    observation[..., 0] = 1.0
    reward = np.zeros((outside + 1, actions, hidden))
    for x in range(outside):
        row, column = divmod(x, size)
        for a, (down, right) in enumerate(STEPS):
            to = (row + down, column + right)
            if to[1] == size:
                transition_x[x, a, outside] = 1.0
                reward[x, a] = 10.0
            elif 0 <= to[0] < size and to[1] >= 0:
                transition_x[x, a, to[0] * size + to[1]] = 1.0
            else:
                transition_x[x, a, x] = 1.0
                reward[x, a] = -100.0
        transition_x[x, 4:, x] = 1.0
        reward[x, 4] = -100.0
        if x in at:
            i = at.index(x)
            reward[x, 4] = np.where(good[:, i], 10.0, -10.0)
            transition_y[x, 4] = np.eye(hidden)[np.arange(hidden) & ~(1 << i)]
        for i, cell in enumerate(at):
            distance = np.hypot(row - cell // size, column - cell % size)
            right_way = (1.0 + 2.0 ** (-distance / 20.0)) / 2.0
            observation[5 + i, x, :, 0] = 0.0
            observation[5 + i, x, :, 1] = np.where(good[:, i], 1.0 - right_way, right_way)
            observation[5 + i, x, :, 2] = np.where(good[:, i], right_way, 1.0 - right_way)
    transition_x[outside, :, outside] = 1.0
    start = Root((size // 2) * size, np.full(hidden, 1.0 / hidden))
    return MOMDP.from_arrays(
        transition_x, transition_y, observation, reward, DISCOUNT, [start], terminal=[outside]
    )


def tag(height: int, width: int) -> MOMDP:
    """Tag: 10 for tagging the other robot, which flees; -10 for missing it, -1 for every step."""
    cells = height * width

    def step(cell: int, way: tuple[int, int]) -> int:
        row, column = cell // width + way[0], cell % width + way[1]
        inside = 0 <= row < height and 0 <= column < width
        return row * width + column if inside else cell

    def distance(a: int, b: int) -> int:
        return abs(a // width - b // width) + abs(a % width - b % width)

    transition_x = np.zeros((cells + 1, 5, cells, cells + 1))
    transition_y = np.zeros((cells + 1, 5, cells, cells))
    transition_y[cells] = np.eye(cells)
    transition_x[cells, :, :, cells] = 1.0
    reward = np.zeros((cells + 1, 5, cells))
    for x in range(cells):
        for y in range(cells):
            away = [
                to for to in (step(y, way) for way in STEPS) if distance(x, to) > distance(x, y)
            ]
            flight = np.zeros(cells)
            flight[y] = 0.2 if away else 1.0
            for to in away:
                flight[to] += 0.8 / len(away)
            for a in range(5):
                if a == 4 and x == y:
                    transition_x[x, a, y, cells] = 1.0
                    transition_y[x, a, y, y] = 1.0
                    reward[x, a, y] = 10.0
                else:
                    transition_x[x, a, y, x if a == 4 else step(x, STEPS[a])] = 1.0
                    transition_y[x, a, y] = flight
                    reward[x, a, y] = -10.0 if a == 4 else -1.0
    observation = np.zeros((5, cells + 1, cells, 2))
    for x in range(cells + 1):
        for y in range(cells):
            observation[:, x, y, int(x == y)] = 1.0  # whether the other is here
    start = Root(0, np.full(cells, 1.0 / cells))
    return MOMDP.from_arrays(
        transition_x, transition_y, observation, reward, DISCOUNT, [start], terminal=[cells]
    )


def maze(size: int, walls: int, seed: int) -> MOMDP:
    """A maze: 1 at the goal, from where the robot is put anywhere else; one observed state."""
    rng = np.random.default_rng(seed)
    cells = draw_maze(size, walls, rng)
    place = {cell: i for i, cell in enumerate(cells)}
    goal = int(rng.integers(len(cells)))
    states = 4 * len(cells)  # a cell and the way the robot faces
    elsewhere = np.where(np.arange(states) // 4 == goal, 0.0, 1.0)
    elsewhere /= elsewhere.sum()

    def ahead(cell: int, way: int) -> int:
        (row, column), (down, right) = cells[cell], STEPS[way % 4]
        return place.get((row + down, column + right), cell)

    transition = np.zeros((5, states, states))
    observation = np.zeros((states, 17))  # walls on four sides, or the goal
    reward = np.zeros((5, states))
    for cell in range(len(cells)):
        for way in range(4):
            s = 4 * cell + way
            if cell == goal:
                transition[:, s] = elsewhere
                reward[:, s] = 1.0
                observation[s, 16] = 1.0
                continue
            turned = [4 * cell + (way + turn) % 4 for turn in range(4)]
            after = [s, 4 * ahead(cell, way) + way, *turned[1:]]  # stay, forward, right, back, left
            transition[0, s, s] = 1.0
            for a in range(1, 5):
                # Now and then nothing happens, or something else.
                transition[a, s, after[a]] += 0.8
                transition[a, s, s] += 0.1
                transition[a, s, after[1 if a != 1 else 4]] += 0.05
                transition[a, s, after[2 if a != 2 else 3]] += 0.05
            sees = [0.9 if ahead(cell, way + side) == cell else 0.05 for side in range(4)]
            for o in range(16):
                bits = [(o >> side) & 1 for side in range(4)]
                observation[s, o] = np.prod(
                    [p if bit else 1.0 - p for p, bit in zip(sees, bits, strict=True)]
                )
    return MOMDP.from_arrays(
        np.ones((1, 5, 1)),
        transition[None],
        np.broadcast_to(observation, (5, 1, states, 17)),
        reward[None],
        DISCOUNT,
        [Root(0, elsewhere)],
    )


def draw_maze(size: int, walls: int, rng: np.random.Generator) -> list[tuple[int, int]]:
    """The free cells of ``size`` x ``size`` after ``walls`` draws of a wall, all connected."""
    while True:
        free = np.ones((size, size), dtype=np.bool_)
        for _ in range(walls):
            free[tuple(rng.integers(0, size, 2))] = False
        cells = [(int(row), int(column)) for row, column in np.argwhere(free)]
        found, waiting = {cells[0]}, [cells[0]]
        while waiting:
            row, column = waiting.pop()
            for down, right in STEPS:
                cell = (row + down, column + right)
                if cell in cells and cell not in found:
                    found.add(cell)
                    waiting.append(cell)
        if len(found) == len(cells):
            return cells


ROCKS = ((6, 7, 5), (9, 6, 3), (7, 7, 21), (9, 7, 22), (5, 9, 23))
TAGS = ((4, 9), (6, 6), (5, 6), (3, 10), (2, 20))
MAZES = ((5, 7, 11), (6, 12, 12))


def main() -> None:
    """Write them all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("directory", type=Path)
    out: Path = parser.parse_args().directory
    out.mkdir(parents=True, exist_ok=True)
    for size, count, seed in ROCKS:
        write_pomdpx(rocks(size, count, seed), out / f"rocks_{size}_{count}.pomdpx")
    for height, width in TAGS:
        write_pomdpx(tag(height, width), out / f"tag_{height}_{width}.pomdpx")
    for size, walls, seed in MAZES:
        write_pomdpx(maze(size, walls, seed), out / f"maze_{size}_{seed}.pomdpx")


if __name__ == "__main__":
    main()
