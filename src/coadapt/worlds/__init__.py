"""Worlds: where the robot can be, how it moves and what the goals are."""

from coadapt.worlds.grid import FIVE_WAYS, FOUR_WAYS, THREE_WAYS, grid
from coadapt.worlds.table_clearing import table_clearing
from coadapt.worlds.world import Goal, World

__all__ = ["FIVE_WAYS", "FOUR_WAYS", "THREE_WAYS", "Goal", "World", "grid", "table_clearing"]
