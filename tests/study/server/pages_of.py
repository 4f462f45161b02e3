"""Sessions that stand somewhere, without anything having happened, and forms for them."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from functools import cache

import msgspec

from coadapt.formalism import SharedAutonomy
from coadapt.study.protocol import Question, Study
from coadapt.study.protocol.reader import template
from coadapt.study.session import Session, Stage, plan_of
from coadapt.study.session.state import Result
from coadapt.tasks import Task, load_task

CHOICE = Question(name="hand", text="Which hand?", choices=("left", "right"), required=True)

MAYBE = Question(name="games", text="Do you play games?", choices=("yes", "no"))

NEEDED = Question(name="how", text="How was it?", required=True)


@cache
def asked_study() -> Study:
    """The template with questions of all kinds."""
    study = msgspec.convert(tomllib.loads(template().decode()), Study)
    questions = (*study.questions, CHOICE, MAYBE, NEEDED)
    return msgspec.structs.replace(study, questions=questions)


@cache
def small_model() -> SharedAutonomy:
    """Of the small table."""
    task = load_task("table_clearing_small")
    assert isinstance(task, Task)
    return task.build()


def standing(stage: Stage, study: Study | None = None, *, changed: bool = False) -> Session:
    """A session in ``stage``; ``changed``: its participant went for the other goal."""
    study = study or asked_study()
    stages = plan_of(study)
    position = stages.index(stage)
    chosen = position > stages.index(Stage("choice"))
    return Session(
        opened=True,
        position=position,
        device="keyboard" if position > 1 else None,
        choice=0 if chosen else None,
        condition=study.conditions[1].name if chosen else None,
        results=(Result(1, int(changed), 9, 1),) if chosen else (),
        end="finished" if stage.kind == "debrief" else None,
    )


def all_standings() -> Iterator[Session]:
    """A session in each stage."""
    for stage in plan_of(asked_study()):
        for changed in (False, True):
            yield standing(stage, changed=changed)
