"""How a robot treats somebody who asks for another goal than the best: it guides, probes, complies.

Think of a person who never adapts (alpha = 0) and wants the goal that is worth less. In a step the
robot *insists* if it does not do what was asked, and the person sees its action as less likely to
be headed for their goal than the one they asked for:

    P(m_r = m_h | w, a_r) < P(m_r = m_h | w, a_h) - `CLEARLY`    (Eq. 2)

So to go forward, which commits to nothing, where the person asks for left counts; to go left where
they ask for forward, an action of their own goal, does not. What the robot does with that person
as a whole is

* it *guides*: it ends at the best goal in spite of them, with probability 1/2 or more;
* it *complies*: it does not, and insists in fewer than `FEW` steps on average;
* it *probes, then complies*: it does not, but first insists in more steps than that.

The numbers `CLEARLY` and `FEW` are ours.
"""

from __future__ import annotations

from enum import Enum

import numpy as np

from coadapt.human.history import NO_ACTION
from coadapt.robots import Decider
from coadapt.simulation.evaluation import expand
from coadapt.simulation.partners import SimulatedPartner

CLEARLY = 0.1
"""How much less likely, for a difference that a person notices."""

FEW = 0.25
"""Steps."""

NEGLIGIBLE = 1e-6
"""Situations less likely than this are left out."""


class Phase(Enum):
    """What a robot does with somebody who does not adapt."""

    GUIDES = "guides"
    PROBES = "probes, then complies"
    COMPLIES = "complies"


def phase(optimal: float, insisting: float) -> Phase:
    """The phase.

    Args:
        optimal: probability of ending at the best goal with somebody who does not adapt.
        insisting: expected number of steps in which the robot insists.
    """
    if optimal >= 0.5:
        return Phase.GUIDES
    return Phase.PROBES if insisting >= FEW else Phase.COMPLIES


def insisting_steps(robot: Decider, partner: SimulatedPartner) -> float:
    """Expected number of steps in which ``robot`` insists.

    Args:
        robot: the robot; its belief starts from its prior.
        partner: follows the adaptation model. The mode that counts is the one they are in.
    """
    total = 0.0
    for visits in expand(robot, partner, threshold=NEGLIGIBLE):
        taken = visits.decisions
        asked = taken.asked != NO_ACTION
        seen = robot.model.perceived[taken.window, taken.action]  # [N, M]
        wanted = robot.model.perceived[taken.window, np.where(asked, taken.asked, taken.action)]
        insists = (seen < wanted - CLEARLY) & (asked & (taken.asked != taken.action))[:, None]
        total += float((visits.weight[:, 0] * insists).sum())
    return total
