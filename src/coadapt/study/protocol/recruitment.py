"""Where participants come from and go back to."""

from __future__ import annotations

from urllib.parse import urlsplit

from coadapt.errors import excerpt
from coadapt.requirements import require
from coadapt.study.protocol.part import Part

PROLIFIC = ("PROLIFIC_PID", "STUDY_ID", "SESSION_ID")
"""The parameters of links from Prolific."""


class Recruitment(Part, frozen=True, kw_only=True):
    """Links to and from the study.

    Attributes:
        parameters: names of the parameters of the link that are kept with the session.
        participant: the one of them that names the person: who comes again finds the session as
            they left it. None: only their browser tells.
        return_link: where the last page leads those who finish, https; "" for nowhere.
        declined_link: the same for those who do not consent.
    """

    parameters: tuple[str, ...] = PROLIFIC
    participant: str | None = PROLIFIC[0]
    return_link: str = ""
    declined_link: str = ""

    def __post_init__(self) -> None:
        known = self.participant is None or self.participant in self.parameters
        wanted = f"one of the parameters {', '.join(self.parameters)}"
        require(("participant",), known, wanted, excerpt(f"{self.participant}"))
        for name in ("return_link", "declined_link"):
            link: str = getattr(self, name)
            usable = not link or (urlsplit(link).scheme == "https" and bool(urlsplit(link).netloc))
            require((name,), usable, "a link that begins with https://", excerpt(link))
