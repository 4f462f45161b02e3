"""SARSOP for mixed-observability MDPs."""

from coadapt.momdp.sarsop.controller import condensed
from coadapt.momdp.sarsop.search import compile_kernels, kernels_are_compiled
from coadapt.momdp.sarsop.solution import Record, Solution, Status
from coadapt.momdp.sarsop.solver import SARSOP

__all__ = [
    "SARSOP",
    "Record",
    "Solution",
    "Status",
    "compile_kernels",
    "condensed",
    "kernels_are_compiled",
]
