"""The web application: which address does what."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncGenerator, Mapping, Sequence
from contextlib import asynccontextmanager, suppress

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import HTMLResponse, PlainTextResponse, RedirectResponse, Response
from starlette.routing import BaseRoute, Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Scope
from starlette.websockets import WebSocket

from coadapt.study.record import SIMULATED
from coadapt.study.server.forms import Refusal, read_form
from coadapt.study.server.limits import Buckets
from coadapt.study.server.pages import Pages, Visit
from coadapt.study.server.requests import client_of, read_fields
from coadapt.study.server.security import SecurityHeaders, csrf_of, is_equal
from coadapt.study.server.service import Closed, Service
from coadapt.study.server.socket import Connections, steer
from coadapt.study.session import NotNow, Session
from coadapt.study.session.events import Noted, Withdrew
from coadapt.study.store import StoreError

log = logging.getLogger("coadapt.study")

COOKIE = "coadapt"
"""Holds the key of the browser's last session."""

COOKIE_AGE = 30 * 24 * 3600
"""Seconds."""

OPENING_RATE, OPENING_BURST = 1.0, 200.0
"""New sessions a second from one network, and at once: a class that begins together."""

POSTING_RATE, POSTING_BURST = 2.0, 30.0
"""Forms a second of one session, and at once."""

WITHDRAWN = "The participant has withdrawn."

PROBLEMS: Mapping[int, tuple[str, str]] = {
    400: ("This was not understood", "Please go back and load the page again."),
    403: ("This was not understood", "Please go back, load the page again and repeat your answer."),
    404: ("Nothing is here", "Please use the link that you were given."),
    405: ("This was not understood", "Please use the link that you were given."),
    408: ("This took too long", "Please go back and try again."),
    413: ("This is too long", "Please go back and write a shorter answer."),
    415: ("This was not understood", "Please go back and load the page again."),
    429: ("Too fast", "Too much came from you at once. Please wait a minute and try again."),
    500: (
        "Something went wrong",
        "It is our fault. Everything up to your last step is safe. Please load the page again.",
    ),
    503: (
        "This could not be stored",
        "Your last step could not be stored. Everything before it is safe. "
        "Please wait a minute, then go back and try again.",
    ),
}
"""Heading and text for what can go wrong."""


class Site:
    """The pages of a study, over HTTP.

    Args:
        service: the study.
        pages: what participants see.
        secure: whether browsers reach it over TLS.
    """

    def __init__(self, service: Service, pages: Pages, *, secure: bool) -> None:
        self.service = service
        self.pages = pages
        self.secure = secure
        self.connections = Connections()
        self._opening = Buckets(OPENING_RATE, OPENING_BURST)
        self._posting = Buckets(POSTING_RATE, POSTING_BURST)

    async def enter(self, request: Request) -> Response:
        """A participant comes by a link, for the first time or again."""
        if request.method == "HEAD":  # who looks what the link is does not come
            return PlainTextResponse("")
        returning = request.cookies.get(COOKIE)
        if not self._opening.take(client_of(request)):
            raise HTTPException(429)
        try:
            key = await self.service.open(dict(request.query_params), returning)
        except Closed:
            return HTMLResponse(self.pages.notice("closed"))
        if SIMULATED in request.query_params:  # who says so spoils only their own session
            await self.service.record(key, Noted(what=SIMULATED))
        response = RedirectResponse(f"/s/{key}", 303)
        response.set_cookie(
            COOKIE, key, COOKIE_AGE, path="/", secure=self.secure, httponly=True, samesite="lax"
        )
        return response

    async def show(self, request: Request) -> Response:
        """The page where the session stands."""
        key = request.path_params["key"]
        session = await self._session(key)
        if session.end is None and await self.service.status() == "paused":
            return HTMLResponse(self.pages.notice("paused"))
        if session.end is None and session.choice is not None and session.condition is None:
            session = await self.service.allocate(key)
            if session.condition is None:  # all quotas are met
                return HTMLResponse(self.pages.notice("closed"))
        return HTMLResponse(self.pages.stage(session, visit_of(key)))

    async def take(self, request: Request) -> Response:
        """The form of a page."""
        key, form = await self._form(request)
        session = await self._session(key)
        read = read_form(self.service.study, session, form)
        if isinstance(read, Refusal):
            page = self.pages.stage(session, visit_of(key), read)
            return HTMLResponse(page, status_code=422)
        if read:
            with suppress(NotNow):  # it came late, or twice
                await self.service.record(key, *read)
        return RedirectResponse(f"/s/{key}", 303)

    async def withdraw(self, request: Request) -> Response:
        """The participant does not want to go on."""
        key, _ = await self._form(request)
        await self._session(key)
        with suppress(NotNow):  # it has ended already
            await self.service.record(key, Withdrew())
        self.connections.end(key, WITHDRAWN)
        return RedirectResponse(f"/s/{key}", 303)

    async def steer(self, websocket: WebSocket) -> None:
        """The participant steers."""
        key: str = websocket.path_params["key"]
        await steer(websocket, self.service, self.connections, key)

    async def health(self, _: Request) -> Response:
        """Whether the server and its database work."""
        await asyncio.to_thread(self.service.store.setting, "format")
        return PlainTextResponse("ok")

    async def problem(self, _: Request, error: Exception) -> Response:
        """A page for what went wrong, without details."""
        if isinstance(error, HTTPException):
            code, headers = error.status_code, error.headers
        elif isinstance(error, StoreError):
            log.error("not stored: %s", error)
            code, headers = 503, {"Retry-After": "30"}
        else:
            code, headers = 500, None
        heading, text = PROBLEMS.get(code, PROBLEMS[400])
        return HTMLResponse(self.pages.error(heading, text), code, headers)

    async def gone(self, _: Request, error: Exception) -> Response:
        """The client has gone before its form was complete; nobody reads this answer."""
        del error
        return Response(status_code=400)

    async def _session(self, key: str) -> Session:
        try:
            return await self.service.session(key)
        except KeyError as error:
            raise HTTPException(404) from error

    async def _form(self, request: Request) -> tuple[str, dict[str, str]]:
        """The key in the address and the form, which is one of ours."""
        key: str = request.path_params["key"]
        if not self._posting.take(key):
            raise HTTPException(429)
        form = await read_fields(request)
        if not is_equal(form.get("csrf", ""), csrf_of(key)):
            raise HTTPException(403)
        return key, form


def study_app(site: Site, more: Sequence[BaseRoute] = ()) -> ASGIApp:
    """The application of ``site``; ``more`` routes are those of the researcher's side."""

    @asynccontextmanager
    async def life(_: Starlette) -> AsyncGenerator[None]:
        try:
            yield
        finally:
            await site.service.close()

    routes = [
        Route("/", site.enter),
        Route("/s/{key}", site.show, methods=["GET"]),
        Route("/s/{key}", site.take, methods=["POST"]),
        Route("/s/{key}/withdraw", site.withdraw, methods=["POST"]),
        WebSocketRoute("/s/{key}/steer", site.steer),
        Route("/health", site.health),
        Mount("/static", Static(packages=[("coadapt.study.server", "static")])),
        *more,
    ]
    app = Starlette(
        routes=routes,
        exception_handlers={
            HTTPException: site.problem,
            StoreError: site.problem,
            ClientDisconnect: site.gone,
            Exception: site.problem,
        },
        lifespan=life,
    )
    # Around everything, for also an answer to a bug must have the headers.
    return SecurityHeaders(app)


class Static(StaticFiles):
    """Files whose addresses change with their contents, so that browsers can keep them."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """The file at ``path``."""
        response = await super().get_response(path, scope)
        response.headers["Cache-Control"] = "public, max-age=31536000, immutable"
        return response


def visit_of(key: str) -> Visit:
    """Whose page it is."""
    return Visit(key=key, path=f"/s/{key}", csrf=csrf_of(key))
