"""The researcher's pages, as HTML."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from coadapt.study.attempts import StoredAttempt
from coadapt.study.export.rows import SessionRows
from coadapt.study.protocol import Study
from coadapt.study.record import Record
from coadapt.study.server.admin.desk import Dashboard
from coadapt.study.server.admin.overview import Glance, stage_name
from coadapt.study.server.admin.timeline import timeline
from coadapt.study.server.pages import asset
from coadapt.study.session.plan import Stage

REFRESH = 5
"""Seconds between looks at the dashboard."""

STANDINGS = ("completed", "active", "stale", "withdrawn", "declined", "excluded")
"""In the order in which they are shown."""


class AdminPages:
    """The pages of the researcher.

    Args:
        study: the protocol.
        goals: names of the goals.

    Raises:
        InputError: if the programs of the pages have not been built.
    """

    def __init__(self, study: Study, goals: tuple[str, ...]) -> None:
        self._study, self._goals = study, goals
        self._environment = Environment(
            loader=PackageLoader("coadapt.study.server", "templates/admin"),
            autoescape=True,
            undefined=StrictUndefined,
            trim_blocks=True,
            lstrip_blocks=True,
        )
        filters: dict[str, Any] = {"when": when, "ago": ago, "named": self._named}
        self._environment.filters.update(filters)
        known: dict[str, Any] = {
            "study": study,
            "style": asset("pages.css"),
            "admin_style": asset("admin.css"),
            "icon": asset("icon.svg"),
            "refresh_program": asset("built/refresh.js"),
            "replay_program": asset("built/replay.js"),
            "refresh": REFRESH,
            "standings": STANDINGS,
        }
        self._environment.globals.update(known)

    def sign_in(self, problem: str = "") -> str:
        """The page that asks for the token."""
        return self._render("sign_in", problem=problem)

    def problem(self, heading: str, text: str) -> str:
        """A page that says what went wrong."""
        return self._render("problem", heading=heading, text=text)

    def dashboard(self, board: Dashboard, csrf: str) -> str:
        """Who is where."""
        return self._render("dashboard", board=board, csrf=csrf)

    def session(
        self,
        seen: Glance,
        record: Record,
        attempts: list[StoredAttempt],
        rows: SessionRows,
        csrf: str,
        *,
        unblinded: bool,
    ) -> str:
        """One session."""
        return self._render(
            "session",
            seen=seen,
            participant=rows.participant(),
            answers=list(rows.answers()),
            attempts=attempts,
            goals=self._goals,
            lines=timeline(self._study, record, self._goals, unblinded=unblinded),
            now=datetime.now(UTC).timestamp(),
            unblinded=unblinded,
            csrf=csrf,
        )

    def replay(self, seen: Glance, attempt: StoredAttempt, index: int, *, unblinded: bool) -> str:
        """One attempt, drawn again."""
        return self._render("replay", seen=seen, attempt=attempt, index=index, unblinded=unblinded)

    def _named(self, stage: Stage) -> str:
        return stage_name(self._study, stage)

    def _render(self, name: str, **values: object) -> str:
        return self._environment.get_template(f"{name}.html.j2").render(values)


def when(time: float) -> str:
    """A time in words: ``"26 Nov 2026, 15:08:09 UTC"``."""
    return f"{datetime.fromtimestamp(time, UTC):%-d %b %Y, %H:%M:%S} UTC"


def ago(time: float, now: float) -> str:
    """How long ago ``time`` was."""
    return f"{span(now - time)} ago"


def span(seconds: float) -> str:
    """A duration in words: ``"5 s"``, ``"12 min"``, ``"3 h"``, ``"2 days"``."""
    seconds = max(0.0, seconds)
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 90 * 60:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.0f} h" if seconds < 48 * 3600 else f"{seconds / 86400:.0f} days"
