"""What participants read, in Markdown."""

from __future__ import annotations

import msgspec

from coadapt.study.protocol.part import Part, require_text


class Texts(Part, frozen=True, kw_only=True):
    """The texts of the pages.

    Attributes:
        welcome: the first page.
        consent: what participants agree to before anything is recorded of them but their arrival
            and the check of their device.
        instructions: the task.
        practice: above a training session.
        choice: the question which goal the robot should go for first.
        trial: above a trial.
        debrief: after the questions.
        declined: for those who do not consent.
        withdrawn: for those who withdraw.
        closed: for those who come while the study is closed or full.
    """

    welcome: str
    consent: str
    instructions: str
    practice: str
    choice: str
    trial: str
    debrief: str
    declined: str
    withdrawn: str
    closed: str

    def __post_init__(self) -> None:
        for name in msgspec.structs.fields(self):
            require_text((name.name,), getattr(self, name.name))
