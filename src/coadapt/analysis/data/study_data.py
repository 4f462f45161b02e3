"""The data of a study as the analysis takes them, whatever file they came from."""

from __future__ import annotations

import msgspec

from coadapt.analysis.data.declaration import Declaration
from coadapt.analysis.data.problems import Problem


class Step(msgspec.Struct, frozen=True, kw_only=True):
    """A step of a trial.

    Attributes:
        belief: of the robot over adaptability, before the decision.
        towards: its belief that the participant wants the goal it holds to be better.
        input, action: names; None for no input.
        matched: whether the match rule had the input executed.
        disagreement: the probability, by the robot's belief, that both want different goals.
    """

    belief: tuple[float, ...]
    towards: float
    input: str | None
    action: str | None
    matched: bool
    disagreement: float | None


class Trial(msgspec.Struct, frozen=True, kw_only=True):
    """A trial of a participant; None where the data do not say.

    Attributes:
        number: from 1.
        goal: name of the goal reached.
        optimal: whether it is the one that the robot holds to be better.
        reward: of the goal.
        switched: whether the participant wanted another goal at the end than the chosen one.
        steps, inputs, disagreements, matched: numbers of steps, of those with an input, of those in
            which the robot did something else than the input asked for, and of those in which the
            match rule had the input executed.
        seconds: duration.
        belief: of the robot over adaptability at the end.
        course: the steps, if they were recorded.
    """

    number: int
    goal: str | None = None
    optimal: bool | None = None
    reward: float | None = None
    switched: bool | None = None
    steps: int | None = None
    inputs: int | None = None
    disagreements: int | None = None
    matched: int | None = None
    seconds: float | None = None
    belief: tuple[float, ...] | None = None
    course: tuple[Step, ...] = ()


class Person(msgspec.Struct, frozen=True, kw_only=True):
    """A participant who is analysed.

    Attributes:
        name: pseudonym.
        condition: name.
        trials: those that were finished.
        ratings: by the item's name, the point as it was given, from 1.
        performance: mean reward, where it is given and not found from trials.
        switched: whether they switched, where it is given and not found from trials.
        checks_failed: number of attention checks answered otherwise than asked for.
    """

    name: str
    condition: str
    trials: tuple[Trial, ...] = ()
    ratings: dict[str, int] = {}
    performance: float | None = None
    switched: bool | None = None
    checks_failed: int = 0


class Flow(msgspec.Struct, frozen=True, kw_only=True):
    """What became of those who came (CONSORT).

    Attributes:
        opened: how many sessions there are in the data.
        standing: how many of each standing, as the data call it.
        left_out: how many that are not analysed, by the reason.
        allocated, analysed: by condition.
        simulated: how many of the analysed are programs and no people.
    """

    opened: int
    standing: dict[str, int]
    left_out: dict[str, int]
    allocated: dict[str, int]
    analysed: dict[str, int]
    simulated: int = 0


class StudyData(msgspec.Struct, frozen=True, kw_only=True):
    """The data of a study.

    Attributes:
        form: what they were read from: "counts", "table" or "export".
        source: name of the file or folder.
        sha256: of what was read, files in the order of their names.
        declared: conditions, scales and hypotheses.
        declared_in: file of the declaration, "" if there was none.
        declared_sha256: of that file.
        stored_sha256: of the protocol, as stored with the data; "" if it is not.
        conditions: names, in their order.
        people: who is analysed.
        flow: what became of those who came.
        problems: what is wrong in the data, and what was done about it.
        notes: what a reader must know of these data.
        adaptability: the values of α that beliefs are about.
        disagreement_cost: ``C`` of Eq. 8 that the robots planned with; None where the data do not
            say.
    """

    form: str
    source: str
    sha256: str
    declared: Declaration
    declared_in: str = ""
    declared_sha256: str = ""
    stored_sha256: str = ""
    conditions: tuple[str, ...]
    people: tuple[Person, ...]
    flow: Flow
    problems: tuple[Problem, ...] = ()
    notes: tuple[str, ...] = ()
    adaptability: tuple[float, ...] = ()
    disagreement_cost: float | None = None

    def of(self, condition: str) -> tuple[Person, ...]:
        """Those in a condition."""
        return tuple(person for person in self.people if person.condition == condition)
