"""What participants see, as HTML: a pure function of the study and the session."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from importlib.resources import files
from typing import Literal

import msgspec
from jinja2 import Environment, PackageLoader, StrictUndefined

from coadapt.errors import InputError
from coadapt.formalism import SharedAutonomy
from coadapt.study.order import shown_items
from coadapt.study.protocol import Study
from coadapt.study.server.forms import Refusal
from coadapt.study.server.markdown import markdown
from coadapt.study.server.scene import steering
from coadapt.study.session.machine import LONGEST_ANSWER, asked_questions
from coadapt.study.session.plan import Kind, Stage, plan_of
from coadapt.study.session.state import Session

STATIC = files(__package__ or "").joinpath("static")
"""The folder of style sheets and programs that pages name."""

PARTS: Mapping[str, frozenset[Kind]] = {
    "Start": frozenset({"welcome", "preflight", "consent", "instructions"}),
    "Practice": frozenset({"practice"}),
    "Task": frozenset({"choice", "briefing", "trial"}),
    "Questions": frozenset({"scale", "questions"}),
    "End": frozenset({"debrief"}),
}
"""What participants are told of where they are."""

TEMPLATES: Mapping[Kind, str] = {
    "welcome": "read",
    "preflight": "preflight",
    "consent": "consent",
    "instructions": "read",
    "practice": "steer",
    "choice": "choice",
    "briefing": "read",
    "trial": "steer",
    "scale": "scale",
    "questions": "questions",
    "debrief": "debrief",
}

HEADINGS: Mapping[Kind, str] = {
    "welcome": "Welcome",
    "preflight": "Your screen and controls",
    "consent": "Do you want to take part?",
    "instructions": "Instructions",
    "practice": "Practice",
    "choice": "Your choice",
    "briefing": "Before you begin",
    "trial": "Trial",
    "scale": "Your view",
    "questions": "Some last questions",
    "debrief": "Thank you",
}

Notice = Literal["closed", "declined", "withdrawn", "excluded", "paused"]
"""Pages of those who cannot go on."""

NOTICES: Mapping[Notice, tuple[str, str]] = {
    "closed": ("Not open at the moment", ""),
    "declined": ("You are not taking part", ""),
    "withdrawn": ("You have withdrawn", ""),
    "excluded": ("This session has ended", "The researchers have ended this session."),
    "paused": (
        "A short break",
        "The researchers have paused the study. Everything you did is safe. "
        "Please load this page again in a few minutes.",
    ),
}
"""Heading and text of each; where the text is empty the protocol has one."""


@dataclass(frozen=True)
class Visit:
    """Whose page it is.

    Attributes:
        key: of the session.
        path: the address of its page, for example ``"/s/KEY"``.
        csrf: what its forms have to carry.
    """

    key: str
    path: str
    csrf: str


class Pages:
    """The pages of a study.

    Args:
        study: the protocol.
        model: of its task: goals and inputs.
        root: what stands in front of the server's addresses, for example behind a proxy.

    Raises:
        InputError: if the programs of the pages have not been built.
    """

    def __init__(self, study: Study, model: SharedAutonomy, root: str = "") -> None:
        self._study = study
        self._inputs = steering(model)
        self._goals = [goal.name for goal in model.world.goals]
        self._environment = Environment(
            loader=PackageLoader("coadapt.study.server", "templates"),
            autoescape=True,
            undefined=StrictUndefined,
            trim_blocks=True,
            lstrip_blocks=True,
        )
        self._environment.filters.update(markdown=markdown)
        self._frame: dict[str, object] = {
            "study": study,
            "style": asset("pages.css", root),
            "icon": asset("icon.svg", root),
            "forms_program": asset("built/forms.js", root),
            "steer_program": asset("built/steer.js", root),
            "preflight_program": asset("built/preflight.js", root),
            "visit": None,
            "stage": None,
            "parts": (),
            "problems": {},
        }

    def stage(self, session: Session, visit: Visit, refusal: Refusal | None = None) -> str:
        """The page of ``session``: its stage, or how it ended.

        Args:
            session: after everything that happened.
            visit: whose it is.
            refusal: what was wrong with the form that was posted last, to be shown beside it.
        """
        if session.end in ("declined", "withdrawn", "excluded"):
            return self.notice(session.end)
        study, stages = self._study, plan_of(self._study)
        stage = stages[session.position]
        refusal = refusal or Refusal({}, {})
        return self._render(
            TEMPLATES[stage.kind],
            stage=stage,
            heading=_heading(study, stage),
            parts=_parts(stages),
            part=next(name for name, kinds in PARTS.items() if stage.kind in kinds),
            visit=visit,
            session=session,
            problems=refusal.problems,
            given=refusal.given,
            **self._of_kind(session, stage, visit),
        )

    def notice(self, notice: Notice) -> str:
        """The page of those who cannot go on."""
        heading, text = NOTICES[notice]
        link = self._study.recruitment.declined_link if notice == "declined" else ""
        return self._render(
            "notice", heading=heading, text=text or getattr(self._study.texts, notice), link=link
        )

    def error(self, heading: str, text: str) -> str:
        """A page that says what went wrong, in Markdown."""
        return self._render("notice", heading=heading, text=text, link="")

    def _of_kind(self, session: Session, stage: Stage, visit: Visit) -> dict[str, object]:
        """What only the template of this kind of stage needs."""
        study = self._study
        match stage.kind:
            case "welcome" | "instructions" | "consent" | "debrief" | "practice" | "trial":
                return {"text": getattr(study.texts, stage.kind)}
            case "briefing":
                condition = session.condition
                return {"text": study.condition(condition).briefing if condition else ""}
            case "preflight":
                return {"inputs": msgspec.to_builtins(self._inputs)}
            case "choice":
                return {"text": study.texts.choice, "goals": self._goals}
            case "scale":
                scale = study.scales[stage.number - 1]
                return {"scale": scale, "items": shown_items(scale, visit.key)}
            case "questions":
                return {"questions": asked_questions(study, session), "longest": LONGEST_ANSWER}

    def _render(self, name: str, **values: object) -> str:
        return self._environment.get_template(f"{name}.html.j2").render({**self._frame, **values})


def asset(name: str, root: str = "") -> str:
    """The address of a file of `STATIC`, which changes with what is in it.

    Raises:
        InputError: if it is a program that has not been built.
    """
    try:
        content = STATIC.joinpath(name).read_bytes()
    except FileNotFoundError:
        missing = f"{name} has not been built, so there is nothing to steer with"
        raise InputError(f"{missing}; run `make` in the checkout of coadapt") from None
    return f"{root}/static/{name}?v={sha256(content).hexdigest()[:12]}"


def _heading(study: Study, stage: Stage) -> str:
    heading = HEADINGS[stage.kind]
    match stage.kind:
        case "practice":
            return f"{heading} {stage.number} of {study.practice}"
        case "trial":
            return f"{heading} {stage.number} of {study.trials}"
        case "scale":
            return study.scales[stage.number - 1].title or heading
        case _:
            return heading


def _parts(stages: tuple[Stage, ...]) -> list[str]:
    """The parts that a study with these stages has."""
    kinds = {stage.kind for stage in stages}
    return [name for name, of_part in PARTS.items() if kinds & of_part]
