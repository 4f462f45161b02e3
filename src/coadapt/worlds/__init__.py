"""Worlds: where the robot can be, how it moves and what the goals are."""

from coadapt.worlds.grid import FIVE_WAYS, FOUR_WAYS, THREE_WAYS, grid
from coadapt.worlds.hallway import hallway
from coadapt.worlds.joint import JointWorld
from coadapt.worlds.table_carrying import table_carrying
from coadapt.worlds.table_clearing import table_clearing
from coadapt.worlds.world import Goal, World

__all__ = [
    "FIVE_WAYS",
    "FOUR_WAYS",
    "THREE_WAYS",
    "Goal",
    "JointWorld",
    "World",
    "grid",
    "hallway",
    "table_carrying",
    "table_clearing",
]
