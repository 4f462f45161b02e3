"""Two ways to override fewer inputs: the match rule, and a penalty in the reward.

    python benchmarks/agreement.py

Modal policies are stochastic, so robot and person may agree on the goal and not on the action. The
paper's answer is the match rule (Sec. 5.3), of which the planner knows nothing; a penalty for
disagreement between actions is left for future work. Both are tried on table clearing with users
who begin in the left mode. Printed are expectations, exact but for at most 0.3 % of the episodes:
the reward of the goal, the inputs overridden, the steps seen as disagreement between modes, the
robot's actions, and the discounted return in the paper's reward.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import coadapt as ca
from coadapt.robots import NEVER_MATCH, MatchRule, MutualAdaptation
from coadapt.simulation import Evaluation, evaluate_all

ALPHAS = (0.0, 0.5, 1.0)
GAP = 1e-3
TOLERANCE = 3e-3

VARIANTS: tuple[tuple[float, bool], ...] = (
    (0.0, False),
    (0.0, True),
    (-0.05, False),
    (-0.1, False),
    (-0.2, False),
    (-0.1, True),
)
"""The cost ``C_a`` of another action than the person wants, and whether the match rule is on."""


def evaluate(model: ca.SharedAutonomy, cost: float, rule: bool) -> list[Evaluation]:
    """The robot planned with ``cost``, with users of every alpha."""
    priced = replace(model, action_disagreement_cost=cost)
    policy = ca.SARSOP(gap=GAP).solve(priced.to_momdp()).policy
    robot = MutualAdaptation(model, policy, MatchRule() if rule else NEVER_MATCH)
    users = [ca.SimulatedPartner(alpha, mode=0) for alpha in ALPHAS]
    return evaluate_all(robot, users, tolerance=TOLERANCE)


def main() -> None:
    """Print the table."""
    argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0]).parse_args()
    model = ca.SharedAutonomy(ca.worlds.table_clearing())
    print("| C_a | match rule | alpha | reward | overridden | disagreement | actions | return |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for cost, rule in VARIANTS:
        for alpha, e in zip(ALPHAS, evaluate(model, cost, rule), strict=True):
            print(
                f"| {cost:g} | {'yes' if rule else 'no'} | {alpha:g} | {e.reward:.3f} "
                f"| {e.overridden:.2f} | {e.disagreement:.2f} | {e.steps:.2f} "
                f"| {e.discounted_return:.3f} |"
            )


if __name__ == "__main__":
    main()
