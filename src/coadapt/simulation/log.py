"""The log format: human inputs in a CSV file, with the decisions they led to where we know them.

A log is UTF-8 text. Somebody else's needs two columns, ``time`` and ``input``; ``trial`` and
``participant`` are optional. Ours begin with comment lines that hold the robot's setup, and have a
column for everything a decision consists of, with numbers written so that they are read back to the
same bit:

    # coadapt log, format 2
    # written by coadapt 0.1.0
    # setup {"robot": "mutual_adaptation", ...}
    time,input,trial,state,action,planned,matched,agreement,belief[alpha=0 left],...
    0.512,left,1,column 6 row 0,forward,forward,false,0.5,0.1911...
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from coadapt.robots import Decision, Robot

FORMAT = 2
"""Version of the format. Since 2 a setup may hold a task."""

FIRST_FORMAT = 1
"""The oldest one that is read."""

FORMAT_LINE = "# coadapt log, format"
VERSION_LINE = "# written by coadapt"
SETUP_LINE = "# setup"

TIME, INPUT, TRIAL, PARTICIPANT = "time", "input", "trial", "participant"
MATCHED, AGREEMENT = "matched", "agreement"
DECISION_COLUMNS = ("state", "action", "planned", MATCHED, AGREEMENT)
BELIEF_PREFIX = "belief["

LARGEST_FILE = 100_000_000
"""Bytes."""

LONGEST_LINE = 65_536
"""Bytes, the line's end included."""

MOST_ROWS = 1_000_000

LONGEST_TRIAL = 100_000
"""Rows."""

Value = str | bool | float
"""What a cell of a decision column holds."""


@dataclass(frozen=True)
class LogRow:
    """One time step of a log.

    Attributes:
        line: number of the line it was read from, from 1.
        time: seconds on the log's own clock.
        human_input: name of the input, or None for no input.
        trial: number of the trial, from 1.
        recorded: the decision as recorded, by column; only what the log has.
        participant: who steered, or None if the log does not say.
    """

    line: int
    time: float
    human_input: str | None
    trial: int
    recorded: Mapping[str, Value] = field(default_factory=dict[str, Value])
    participant: str | None = None


def is_decision_column(name: str) -> bool:
    """Whether a column of our own logs holds a part of the decision."""
    return name in DECISION_COLUMNS or name.startswith(BELIEF_PREFIX)


class DecisionCells:
    """The cells of a robot's decisions, by column.

    Args:
        robot: decides.

    Attributes:
        columns: names of the decision columns, one for each adaptability and mode among them.
    """

    def __init__(self, robot: Robot) -> None:
        world, model = robot.model.world, robot.planning_model
        self._states = world.state_names
        self._inputs, self._actions = model.interface.names, world.action_names
        self._beliefs = tuple(
            f"{BELIEF_PREFIX}{alpha} {mode}]"
            for alpha in model.alpha.names
            for mode in model.mode_names
        )
        self.columns = (*DECISION_COLUMNS, *self._beliefs)

    def input(self, decision: Decision) -> str | None:
        """The name of the input before ``decision``, or None for no input."""
        given = decision.human_input
        return None if given is None else self._inputs[given]

    def values(self, decision: Decision) -> dict[str, Value]:
        """The cells of ``decision``."""
        cells: list[Value] = [
            self._states[decision.state],
            self._actions[decision.action],
            self._actions[decision.planned],
            decision.matched,
            float(decision.agreement),
            *decision.belief.ravel().tolist(),
        ]
        return dict(zip(self.columns, cells, strict=True))


def number(value: float) -> str:
    """The shortest text that is read back as the same number."""
    return repr(float(value)).removesuffix(".0")
