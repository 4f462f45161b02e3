"""The tables of an export: every column with its meaning. This file is the one source of truth."""

from __future__ import annotations

from typing import Annotated

from coadapt.study.export.column import Meaning, Row, Table

FORMAT = 1
"""Version of the export's format."""

Person = Annotated[str, Meaning("Pseudonym of the participant, the same in every export.")]

Trial = Annotated[int, Meaning("Number of the trial.", values="from 1")]

Seconds = "seconds since the session was opened"


class Participant(Row, frozen=True, kw_only=True):
    """A session."""

    participant: Person
    number: Annotated[
        int,
        Meaning(
            "Number of the session in the order of opening.",
            values="from 1; those of deleted sessions are missing",
        ),
    ]
    included: Annotated[
        bool,
        Meaning(
            "Whether the session is to be analysed: it was completed, and is not a simulated one "
            "among real ones."
        ),
    ]
    standing: Annotated[
        str,
        Meaning(
            "What became of the session.",
            values="completed; active: under way; stale: without a sign of life for longer than "
            "the protocol's stale_minutes; declined: no consent; withdrawn; excluded: by the "
            "researcher",
        ),
    ]
    reason: Annotated[str | None, Meaning("Why the researcher excluded the session.")]
    simulated: Annotated[bool, Meaning("Whether a program took part and not a person.")]
    opened: Annotated[str, Meaning("When the session was opened.", unit="UTC", values="ISO 8601")]
    duration: Annotated[
        float | None,
        Meaning("Time from the opening of the session to the last answer.", unit="seconds"),
    ]
    stage: Annotated[
        str, Meaning("The stage in which the session stands or ended, with its number.")
    ]
    device: Annotated[
        str | None,
        Meaning("What the participant steered with.", values="keyboard, gamepad, touch, switch"),
    ]
    pad: Annotated[str | None, Meaning("What the gamepad calls itself.")]
    browser: Annotated[str | None, Meaning("What the browser calls itself.")]
    width: Annotated[int | None, Meaning("Width of the window.", unit="CSS pixels")]
    height: Annotated[int | None, Meaning("Height of the window.", unit="CSS pixels")]
    latency: Annotated[
        float | None,
        Meaning("Median round trip between page and server at the preflight.", unit="seconds"),
    ]
    choice: Annotated[str | None, Meaning("Name of the goal the participant chose.")]
    condition: Annotated[str | None, Meaning("Name of the condition.")]
    robot: Annotated[str | None, Meaning("The robot of that condition.")]
    allocation: Annotated[
        int | None,
        Meaning("Place in the order of allocation.", values="from 1"),
    ]
    trials: Annotated[int, Meaning("Number of trials finished.")]
    changed: Annotated[
        bool | None,
        Meaning("Whether the participant went for another goal than the chosen one in some trial."),
    ]
    checks: Annotated[int, Meaning("Number of attention checks answered.")]
    checks_failed: Annotated[int, Meaning("Number of those answered otherwise than asked for.")]
    restarts: Annotated[
        int, Meaning("How often a training session or trial had to be begun again.")
    ]


class TrialRow(Row, frozen=True, kw_only=True):
    """A trial that began; of several attempts the last."""

    participant: Person
    trial: Trial
    condition: Annotated[str, Meaning("Name of the condition.")]
    robot: Annotated[str, Meaning("The robot of that condition.")]
    device: Annotated[
        str | None,
        Meaning(
            "What most of the inputs came from; that of the preflight without inputs.",
            values="keyboard, gamepad, touch, switch",
        ),
    ]
    choice: Annotated[str, Meaning("Name of the goal the participant chose before the trials.")]
    optimal: Annotated[str, Meaning("Name of the goal that the robot holds to be better.")]
    finished: Annotated[bool, Meaning("Whether the trial came to its end.")]
    goal: Annotated[str | None, Meaning("Name of the goal reached; none where steps ran out.")]
    at_optimal: Annotated[bool | None, Meaning("Whether the goal reached is the optimal one.")]
    reward: Annotated[
        float | None,
        Meaning(
            "Reward of the goal reached; 0 where steps ran out.", unit="the protocol's rewards"
        ),
    ]
    steps: Annotated[int, Meaning("Number of the robot's decisions in the last attempt.")]
    attempts: Annotated[int, Meaning("How often the trial began.", values="from 1")]
    wanted: Annotated[
        str | None,
        Meaning("Name of the goal that the last telling input was for, if any input told one."),
    ]
    changed: Annotated[
        bool | None, Meaning("Whether the goal wanted at last is another than the chosen one.")
    ]
    inputs: Annotated[int, Meaning("Number of steps with an input.")]
    disagreements: Annotated[
        int, Meaning("Number of steps in which the robot did not do what the input asked for.")
    ]
    matched: Annotated[
        int, Meaning("Number of steps in which the match rule had the input executed.")
    ]
    belief_alpha: Annotated[
        tuple[float, ...] | None,
        Meaning(
            "The robot's belief over adaptability at the end of the trial, in the order of "
            "`adaptability` in materials/model.json.",
            unit="probability",
        ),
    ]
    began: Annotated[float, Meaning("When the last attempt began.", unit=Seconds)]
    duration: Annotated[
        float | None, Meaning("Time from there to the end of the trial.", unit="seconds")
    ]
    first_input: Annotated[
        float | None, Meaning("Time from there to the first input.", unit="seconds")
    ]


class StepRow(Row, frozen=True, kw_only=True):
    """A step of a training session or trial, in any of its attempts."""

    participant: Person
    stage: Annotated[str, Meaning("What kind of stage it is part of.", values="practice, trial")]
    number: Annotated[int, Meaning("Number of the training session or trial.", values="from 1")]
    attempt: Annotated[int, Meaning("Number of the attempt at it.", values="from 1")]
    counts: Annotated[bool, Meaning("Whether this attempt came to its end; at most one does.")]
    step: Annotated[int, Meaning("Number of the step in the attempt.", values="from 0")]
    time: Annotated[float, Meaning("When the server decided.", unit=Seconds)]
    state: Annotated[int, Meaning("Robot state before the step: an index in `states`.")]
    window: Annotated[
        int | None,
        Meaning(
            "What the person remembers there: an index in the model's windows, which are the "
            "states where the memory is 1. Missing in training."
        ),
    ]
    input: Annotated[str | None, Meaning("Name of the input; missing where there was none.")]
    action: Annotated[
        str | None,
        Meaning("Name of the robot's action; missing where it stayed in training."),
    ]
    planned: Annotated[
        str | None, Meaning("The action before the match rule. Missing in training.")
    ]
    agreement: Annotated[
        float | None,
        Meaning(
            "The robot's confidence that both want the same goal. Missing in training.",
            unit="probability",
        ),
    ]
    matched: Annotated[
        bool | None,
        Meaning("Whether the match rule had the input executed. Missing in training."),
    ]
    reached: Annotated[int, Meaning("Robot state after the step: an index in `states`.")]
    belief: Annotated[
        tuple[tuple[float, ...], ...] | None,
        Meaning(
            "The belief behind the decision: a row for each adaptability, in it a number for each "
            "goal. Missing in training.",
            unit="probability",
        ),
    ]
    device: Annotated[
        str | None,
        Meaning("What the input came from.", values="keyboard, gamepad, touch, switch"),
    ]
    input_time: Annotated[float | None, Meaning("When the server stored that input.", unit=Seconds)]
    page_time: Annotated[
        float | None,
        Meaning("When the page saw it, by a clock of its own.", unit="seconds"),
    ]
    device_time: Annotated[
        float | None,
        Meaning("The gamepad's own time of it, by the page's clock.", unit="seconds"),
    ]


class AnswerRow(Row, frozen=True, kw_only=True):
    """An answer."""

    participant: Person
    item: Annotated[str, Meaning("Name of the item or question.")]
    scale: Annotated[str | None, Meaning("Name of the scale; missing of a question.")]
    position: Annotated[
        int, Meaning("Place on the page as this participant saw it.", values="from 1")
    ]
    kind: Annotated[
        str,
        Meaning(
            "What kind of answer it is.",
            values="rating: of an item of a scale; check: of an attention check; choice: one of "
            "several answers; text",
        ),
    ]
    value: Annotated[
        int | None,
        Meaning("The point or choice, as it was given.", values="from 1, in the order shown"),
    ]
    score: Annotated[
        int | None,
        Meaning("What counts towards the scale: `value`, turned round if the item is reversed."),
    ]
    points: Annotated[int | None, Meaning("Number of points or choices.")]
    label: Annotated[str | None, Meaning("The words of the point or choice.")]
    text: Annotated[str | None, Meaning("The answer in words.")]
    correct: Annotated[
        bool | None, Meaning("Of an attention check: whether it was answered as asked for.")
    ]
    time: Annotated[float, Meaning("When the page was sent in.", unit=Seconds)]


class EventRow(Row, frozen=True, kw_only=True):
    """A stored event. The other tables are made from these."""

    participant: Person
    sequence: Annotated[int, Meaning("Number of the event in its session.")]
    time: Annotated[float, Meaning("When the server stored it.", unit=Seconds)]
    stage: Annotated[str, Meaning("The stage in which the session was, with its number.")]
    event: Annotated[str, Meaning("What kind of event it is.")]
    data: Annotated[
        str,
        Meaning("All of it, a JSON object. Links' parameters are left out, for they name people."),
    ]


PARTICIPANTS = Table(
    "participants", "A row for each session that was opened.", Participant, ("participant",)
)
TRIALS = Table(
    "trials",
    "A row for each trial that began. What is said of steps is said of the last attempt.",
    TrialRow,
    ("participant", "trial"),
)
STEPS = Table(
    "steps",
    "A row for each step of each attempt at a training session or trial.",
    StepRow,
    ("participant", "stage", "number", "attempt", "step"),
)
ANSWERS = Table(
    "answers", "A row for each answer to an item or question.", AnswerRow, ("participant", "item")
)
EVENTS = Table(
    "events",
    "A row for each stored event: what all other tables are made from.",
    EventRow,
    ("participant", "sequence"),
)

TABLES = (PARTICIPANTS, TRIALS, STEPS, ANSWERS, EVENTS)
