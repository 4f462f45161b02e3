"""Sweeps: grids of parameters, conditions and simulated people, interrupted and resumed at will."""

from coadapt.simulation.sweep.cell import Cell
from coadapt.simulation.sweep.cells import Layout, lay_out
from coadapt.simulation.sweep.grid import Grid, Sweep
from coadapt.simulation.sweep.read import parse_sweep, read_sweep
from coadapt.simulation.sweep.run import Outcome, run_sweep
from coadapt.simulation.sweep.values import Range
from coadapt.simulation.sweep.workers import DaskWorkers, LocalWorkers, Workers

__all__ = [
    "Cell",
    "DaskWorkers",
    "Grid",
    "Layout",
    "LocalWorkers",
    "Outcome",
    "Range",
    "Sweep",
    "Workers",
    "lay_out",
    "parse_sweep",
    "read_sweep",
    "run_sweep",
]
