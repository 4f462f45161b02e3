"""How close histories by their features come to whole ones (Sec. 7).

Plans for table clearing with each of some feature maps, and follows the plan in the model whose
person remembers all of the last k steps. Prints the number of windows, the planner's bounds on its
own, simplified model, and the expected discounted reward that the plan earns with that person.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np

import coadapt as ca
from coadapt.arrays import IntArray
from coadapt.human.features import Features, PerceivedMode, action_counts
from coadapt.human.history import NO_WINDOW, Windows
from coadapt.momdp import AlphaVectorPolicy
from coadapt.robots.match import NEVER_MATCH
from coadapt.simulation import evaluate_all

GAP = 1e-3
TOLERANCE = 1e-3


def side_by_side(whole: Windows, fewer: Windows, starts: list[int]) -> tuple[Windows, IntArray]:
    """The windows of ``whole``, each with the window of ``fewer`` that its history led to.

    Returns:
        Windows of all pairs that can be reached, which are those of ``whole`` to who asks, and
        ``[W]`` the second half of each pair.
    """
    number: dict[tuple[int, int], int] = {}
    beginning = np.full(len(whole.beginning), NO_WINDOW)
    for start in starts:
        pair = int(whole.beginning[start]), int(fewer.beginning[start])
        beginning[start] = number.setdefault(pair, len(number))
    following: list[IntArray] = []
    pairs = list(number)
    for w, v in pairs:
        after = np.full(whole.next.shape[1:], NO_WINDOW)
        for move in np.ndindex(after.shape):
            if whole.next[w][move] != NO_WINDOW:
                pair = int(whole.next[w][move]), int(fewer.next[v][move])
                if pair not in number:
                    number[pair] = len(number)
                    pairs.append(pair)
                after[move] = number[pair]
        following.append(after)
    first, second = np.array(pairs).T
    together = replace(
        whole,
        first=whole.first[first],
        actions=whole.actions[first],
        outcomes=whole.outcomes[first],
        state=whole.state[first],
        next=np.stack(following),
        beginning=beginning,
    )
    return together, second


def follow(model: ca.SharedAutonomy, features: Features | None) -> tuple[int, float, float, float]:
    """Windows, the planner's bounds, and what the plan earns with the person of ``model``."""
    simplified = replace(model, features=features)
    solution = ca.SARSOP(gap=GAP).solve(simplified.to_momdp())
    starts = list(model.world.start_chances)
    windows, which = side_by_side(model.windows, simplified.windows, starts)
    whole = replace(model)
    whole.__dict__["windows"] = windows  # in the place of those it would compute
    policy = chosen(solution.policy, which)
    robot = ca.robots.MutualAdaptation(whole, policy, NEVER_MATCH)
    people = [ca.SimulatedPartner(float(alpha)) for alpha in model.alpha.values]
    earned = evaluate_all(robot, people, tolerance=TOLERANCE)
    mean = sum(p * e.discounted_return for p, e in zip(model.alpha.prior, earned, strict=True))
    return len(simplified.windows), solution.lower, solution.upper, float(mean)


def chosen(policy: AlphaVectorPolicy, which: IntArray) -> AlphaVectorPolicy:
    """The policy that has in observed state ``i`` the vectors of ``which[i]``."""
    rows = [np.arange(policy.start[v], policy.start[v + 1]) for v in which]
    start = np.concatenate(([0], np.cumsum([len(row) for row in rows])))
    every = np.concatenate(rows)
    return AlphaVectorPolicy(start, policy.vectors[every], policy.actions[every])


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--columns", type=int, default=11)
    parser.add_argument("--rows", type=int, default=3)
    parser.add_argument("--memory", type=int, default=4)
    parser.add_argument("--step-cost", type=float, default=1.2)
    arguments = parser.parse_args()
    model = ca.SharedAutonomy(
        ca.worlds.table_clearing(arguments.columns, arguments.rows),
        memory=arguments.memory,
        step_cost=arguments.step_cost,
    )
    maps: dict[str, Features | None] = {
        "everything": None,
        "how often each action": action_counts,
        **{
            f"what it looked like, in {n} levels": PerceivedMode(model.modal_policies, n)
            for n in (2, 4, 10)
        },
        "the last action": lambda _, actions: actions[-1:],
        "nothing": lambda _states, _actions: 0,
    }
    print(f"{'what counts':<34}{'windows':>8}{'lower':>10}{'upper':>10}{'earned':>10}")
    for name, features in maps.items():
        windows, lower, upper, earned = follow(model, features)
        print(f"{name:<34}{windows:>8}{lower:>10.4f}{upper:>10.4f}{earned:>10.4f}")


if __name__ == "__main__":
    main()
