"""A whole protocol."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from coadapt.errors import excerpt
from coadapt.hypotheses import Hypothesis
from coadapt.requirements import FieldError, require, require_reward
from coadapt.study.protocol.allocation import Allocation
from coadapt.study.protocol.clock import Clock
from coadapt.study.protocol.condition import Condition
from coadapt.study.protocol.part import Part, require_text
from coadapt.study.protocol.questions import Question, Scale
from coadapt.study.protocol.recruitment import Recruitment
from coadapt.study.protocol.texts import Texts

FORMAT = 1
"""Version of the format."""

MOST_TRIALS = 100

MOST_CONDITIONS = 20


class Rewards(Part, frozen=True, kw_only=True):
    """What the goals are worth (Sec. 6.5).

    Attributes:
        optimal: ``R_opt``, of the goal that the participant did not choose.
        other: ``R_sub``, of the chosen one.
    """

    optimal: float = 11.0
    other: float = 10.0

    def __post_init__(self) -> None:
        require_reward(("optimal",), self.optimal)
        require_reward(("other",), self.other)
        require(("optimal",), self.optimal > self.other, "above that of the other", self.optimal)


class Study(Part, frozen=True, kw_only=True):
    """The protocol of a study (Sec. 6).

    Attributes:
        format: version of the format, `FORMAT`.
        title: what participants see above every page.
        contact: whom they can ask.
        task: name of a task with two goals (`coadapt tasks`), or a TOML file beside `study.toml`.
        trials: how often each participant does the task.
        practice: number of training sessions, in which the robot just follows the inputs.
        belief: ``"reset"``: the robot starts every trial from its prior; ``"carried"``: from what
            it believed at the end of the trial before.
        rewards: of the goals: the one that the participant does not choose is the optimal one.
        clock: when the robot decides.
        conditions: the robots.
        allocation: how participants are allocated to them.
        texts: what participants read.
        scales: what they rate, a page each.
        questions: what else they are asked, on one page.
        recruitment: where they come from and go back to.
        hypotheses: what is expected and how it is tested, declared before data exist.

    Raises:
        FieldError: if a value cannot be used, or the parts do not fit together.
    """

    format: int
    title: str
    texts: Texts
    conditions: tuple[Condition, ...]
    contact: str = ""
    task: str = "table_clearing"
    trials: int = 3
    practice: int = 2
    belief: Literal["reset", "carried"] = "reset"
    rewards: Rewards = Rewards()
    clock: Clock = Clock()
    allocation: Allocation = Allocation()
    scales: tuple[Scale, ...] = ()
    questions: tuple[Question, ...] = ()
    recruitment: Recruitment = Recruitment()
    hypotheses: tuple[Hypothesis, ...] = ()

    def __post_init__(self) -> None:
        if self.format > FORMAT:
            newer = f"is {self.format}, newer than this coadapt reads; expected {FORMAT}"
            raise FieldError(("format",), newer)
        require(("format",), self.format == FORMAT, f"{FORMAT}", self.format)
        require_text(("title",), self.title)
        wanted = f"from 1 to {MOST_TRIALS}"
        require(("trials",), 1 <= self.trials <= MOST_TRIALS, wanted, self.trials)
        wanted = f"from 0 to {MOST_TRIALS}"
        require(("practice",), 0 <= self.practice <= MOST_TRIALS, wanted, self.practice)
        count, wanted = len(self.conditions), f"1 to {MOST_CONDITIONS} conditions"
        require(("conditions",), 1 <= count <= MOST_CONDITIONS, wanted, count)
        self._require_different("conditions", (c.name for c in self.conditions))
        self._require_different("scales", (s.name for s in self.scales))
        self._require_different("scales", (i.name for s in self.scales for i in s.items))
        items = {item.name for scale in self.scales for item in scale.items}
        for i, question in enumerate(self.questions):
            new = question.name not in items
            require(("questions", i, "name"), new, "new", excerpt(question.name))
            items.add(question.name)
        self._require_different("hypotheses", (h.name for h in self.hypotheses))
        conditions, scales = {c.name for c in self.conditions}, {s.name for s in self.scales}
        for i, hypothesis in enumerate(self.hypotheses):
            hypothesis.require_known(("hypotheses", i), conditions, scales)

    def condition(self, name: str) -> Condition:
        """The condition called ``name``; KeyError if there is none."""
        return {condition.name: condition for condition in self.conditions}[name]

    def _require_different(self, key: str, names: Iterator[str]) -> None:
        seen: set[str] = set()
        for name in names:
            if name in seen:
                raise FieldError((key,), f"has {excerpt(name)} twice, expected different names")
            seen.add(name)
