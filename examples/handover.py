"""A collaboration of one's own: a robot hands a cup to a person, at the counter or over the table.

Both move to one of two places, one step at a time; the cup changes hands where they meet. Over the
table is better. Run it with ``python examples/handover.py``.
"""

import numpy as np

import coadapt as ca

# A state is how far the two have come to each other: 0 is the counter, 4 is the table.
place = np.arange(5)
moves = np.empty((5, 2, 2), dtype=np.int64)
for robot in (0, 1):
    for human in (0, 1):
        moves[:, robot, human] = np.clip(place + robot + human - 1, 0, 4)
world = ca.worlds.JointWorld(
    name="handover",
    moves=moves,
    goals=(ca.worlds.Goal("counter", 0, 5.0), ca.worlds.Goal("table", 4, 8.0)),
    starts={1: 0.5, 2: 0.5},
    state_names=tuple(f"place {i}" for i in place),
    action_names=("to the counter", "to the table"),
    human_action_names=("to the counter", "to the table"),
    positions=np.column_stack([place, np.zeros(5)]).astype(float),
)
model = ca.Collaboration(world, memory=2, discount=0.95)
solution = ca.SARSOP(gap=1e-3).solve(model.to_momdp())
robot = ca.robots.Collaborator(model, solution.policy)
for adaptability in (0.0, 0.5, 1.0):
    person = ca.SimulatedPartner(adaptability, mode=0)
    chances = ca.evaluate(robot, person).goal_probability
    print(f"alpha {adaptability}: counter {chances[0]:.2f}, table {chances[1]:.2f}")
