"""Compiled or not, the same episodes."""

from __future__ import annotations

from tests.momdp.apart import run_apart

PROGRAM = """
import json
import numpy as np
from coadapt import SimulatedPartner, simulate_batch
from coadapt.robots.kernels.decide import decide_all
from coadapt.simulation.partners import Lapsing, drifting
from tests.robots.worlds import MODEL
from tests.simulation.strategies import robots_for

found = []
for robot in robots_for(MODEL, np.random.default_rng(0)):
    for partner in (SimulatedPartner(0.5), Lapsing(drifting(0.5, 0.3), 0.2)):
        batch = simulate_batch(
            robot, partner, 12, np.random.default_rng(1), trials=2, max_steps=9, beliefs=True
        )
        found += [batch.goal.tolist(), batch.discounted_return.tolist(), batch.belief.tolist()]
print(json.dumps({"found": found, "compiled": hasattr(decide_all, "overloads")}))
"""


def test_the_compiler_changes_nothing() -> None:
    compiled = run_apart(PROGRAM)
    plain = run_apart(PROGRAM, NUMBA_DISABLE_JIT="1")
    assert compiled["compiled"] and not plain["compiled"]
    assert compiled["found"] == plain["found"]
