"""The robots that participants are allocated to (Sec. 6.1)."""

from __future__ import annotations

import math

from coadapt.requirements import require
from coadapt.robots.setup import ROBOT_NAMES, RobotName
from coadapt.study.protocol.part import LONGEST_TEXT, Part, require_identifier


class Condition(Part, frozen=True, kw_only=True):
    """A condition.

    Attributes:
        name: what it is called in the data; participants never see it.
        robot: which of the robots of Sec. 6.1.
        match_threshold: agreement at which the input is executed; above 1 it never is.
        briefing: what only participants of this condition are told before the first trial, in
            Markdown; nothing by default.
        quota: completed sessions at which it is closed; None for no limit.
    """

    name: str
    robot: RobotName
    match_threshold: float = 0.9
    briefing: str = ""
    quota: int | None = None

    def __post_init__(self) -> None:
        require_identifier(("name",), self.name)
        require(
            ("robot",), self.robot in ROBOT_NAMES, f"one of {', '.join(ROBOT_NAMES)}", self.robot
        )
        wanted, threshold = "a number of at least 0", self.match_threshold
        require(("match_threshold",), 0 <= threshold < math.inf, wanted, threshold)
        length = len(self.briefing)
        require(
            ("briefing",), length <= LONGEST_TEXT, f"{LONGEST_TEXT:,} characters at most", length
        )
        require(("quota",), self.quota is None or self.quota >= 1, "at least 1", self.quota)
