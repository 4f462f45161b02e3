"""SARSOP for mixed-observability MDPs."""

from coadapt.momdp.sarsop.solver import SARSOP, Record, Solution, Status

__all__ = ["SARSOP", "Record", "Solution", "Status"]
