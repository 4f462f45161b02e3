"""A task of one's own: three bottles, the right one the best.

Run it with ``python examples/three_bottles.py``.
"""

import coadapt as ca

world = ca.worlds.grid(
    columns=13,
    rows=4,
    start=(6, 0),
    goals=[("left", (0, 3), 10.0), ("middle", (6, 3), 8.0), ("right", (12, 3), 11.0)],
    name="three_bottles",
)
model = ca.SharedAutonomy(world, adaptability=(0.0, 0.5, 1.0), disagreement_cost=-0.32)
problem = model.to_momdp()
ca.check_momdp(problem)
solution = ca.SARSOP(gap=1e-2).solve(problem)
print(f"{problem.states} states, value between {solution.lower:.3f} and {solution.upper:.3f}")

robot = ca.robots.MutualAdaptation(model, solution.policy)
for adaptability in (0.0, 0.5, 1.0):
    partner = ca.SimulatedPartner(adaptability, mode=0)
    chances = ca.evaluate(robot, partner, tolerance=1e-2).goal_probability
    named = zip(model.mode_names, chances, strict=True)
    print(f"alpha {adaptability}: " + ", ".join(f"{name} {p:.2f}" for name, p in named))
