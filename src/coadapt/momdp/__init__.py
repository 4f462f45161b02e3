"""Planning under mixed observability: the problem, its check, its solution."""

from coadapt.momdp.check import MOMDPError, MOMDPWarning, check_momdp
from coadapt.momdp.model import MOMDP, Root
from coadapt.momdp.policy import AlphaVectorPolicy, action_values
from coadapt.momdp.transition import JumpTransition, SparseTransition

__all__ = [
    "MOMDP",
    "AlphaVectorPolicy",
    "JumpTransition",
    "MOMDPError",
    "MOMDPWarning",
    "Root",
    "SparseTransition",
    "action_values",
    "check_momdp",
]
