"""The researcher's addresses: a token lets in, a cookie keeps, every form carries a secret."""

from __future__ import annotations

import asyncio
import shutil
from collections.abc import Awaitable, Callable, Sequence
from hashlib import sha256

import msgspec
from starlette.background import BackgroundTask
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, RedirectResponse, Response
from starlette.routing import BaseRoute, Mount, Route

from coadapt.study.export.names import Names
from coadapt.study.export.rows import SessionRows
from coadapt.study.record import Record, Stored
from coadapt.study.server.admin.desk import Desk
from coadapt.study.server.admin.pages import STANDINGS, AdminPages
from coadapt.study.server.limits import Buckets
from coadapt.study.server.requests import client_of, read_fields
from coadapt.study.server.security import is_admin_token, is_equal
from coadapt.study.server.service import Status
from coadapt.study.session import NotNow

COOKIE = "coadapt_admin"
"""Holds the token."""

COOKIE_AGE = 12 * 3600
"""Seconds."""

TRIES_RATE, TRIES_BURST = 0.2, 10.0
"""Tokens tried a second from one network, and at once."""

LONGEST_REASON = 1000
"""Characters."""

STATUSES: dict[str, Status] = {"open": "open", "close": "closed", "pause": "paused"}
"""What the researcher can do with the study."""

Handler = Callable[[Request, str], Awaitable[Response]]
"""Gets the token too, which is the right one."""


class AdminSite:
    """The researcher's pages over HTTP.

    Args:
        desk: what there is to see and to do.
        pages: what it looks like.
        secure: whether browsers reach it over TLS.
    """

    def __init__(self, desk: Desk, pages: AdminPages, *, secure: bool) -> None:
        self._desk, self._pages, self._secure = desk, pages, secure
        self._tries = Buckets(TRIES_RATE, TRIES_BURST)

    # Getting in

    async def enter(self, request: Request) -> Response:
        """The token comes with the link or the form; the browser keeps it from then on."""
        if request.method == "POST":
            token = (await read_fields(request)).get("token", "").strip()
        else:
            token = request.query_params.get("token", "")
        if not token:
            return await self.guarded(self.dashboard)(request)
        if not self._tries.take(client_of(request)):
            return HTMLResponse(self._pages.sign_in("Too many tries. Please wait a minute."), 429)
        if not await self._is_right(token):
            problem = "This is not the token of this study, or no longer."
            return HTMLResponse(self._pages.sign_in(problem), 403)
        # The token does not stay in the address, where it would be seen and remembered.
        response = RedirectResponse("/admin", 303)
        response.set_cookie(
            COOKIE,
            token,
            COOKIE_AGE,
            path="/admin",
            secure=self._secure,
            httponly=True,
            samesite="lax",
        )
        return response

    async def leave(self, request: Request) -> Response:
        """Forget the token."""
        del request
        response = RedirectResponse("/admin", 303)
        response.delete_cookie(COOKIE, path="/admin")
        return response

    def guarded(self, handler: Handler) -> Callable[[Request], Awaitable[Response]]:
        """``handler``, for those alone who have the token; forms must carry their secret."""

        async def guarded(request: Request) -> Response:
            token = request.cookies.get(COOKIE, "")
            if not token or not await self._is_right(token):
                return HTMLResponse(self._pages.sign_in(), 403)
            try:
                return await handler(request, token)
            except KeyError:
                text = "There is no such session. It may have been deleted."
                return HTMLResponse(self._pages.problem("Not found", text), 404)
            except NotNow as error:
                text = f"This cannot be done now: {error}."
                return HTMLResponse(self._pages.problem("Not possible", text), 409)

        return guarded

    async def _is_right(self, token: str) -> bool:
        return await asyncio.to_thread(is_admin_token, self._desk.service.store, token)

    # Looking

    async def dashboard(self, request: Request, token: str) -> Response:
        """Who is where."""
        shown = request.query_params.get("standing")
        page = request.query_params.get("page", "1")
        board = await self._desk.dashboard(
            int(page) if page.isdecimal() and len(page) < 9 else 1,
            shown if shown in STANDINGS else None,
        )
        return HTMLResponse(self._pages.dashboard(board, csrf_of(token)))

    async def find(self, request: Request, token: str) -> Response:
        """The session that is meant by a number, pseudonym or name."""
        del token
        number = await self._desk.find(request.query_params.get("q", ""))
        if number is None:
            text = "No session has this number, pseudonym or recruitment name."
            return HTMLResponse(self._pages.problem("Not found", text), 404)
        return RedirectResponse(f"/admin/sessions/{number}", 303)

    async def session(self, request: Request, token: str) -> Response:
        """One session."""
        record = await self._record(request)
        seen = self._desk.glance(record)
        service = self._desk.service
        names = Names.of_model(next(iter(service.robots.values())).model)
        stored = Stored(service.directory, service.study, lambda: [record])
        rows = SessionRows(stored, names, record, record.events[-1].time)
        page = self._pages.session(
            seen,
            record,
            self._desk.attempts(record),
            rows,
            csrf_of(token),
            unblinded=await self._desk.is_unblinded(),
        )
        return HTMLResponse(page)

    async def replay(self, request: Request, token: str) -> Response:
        """One attempt, drawn again."""
        del token
        record, index = await self._record(request), int(request.path_params["index"])
        attempts = self._desk.attempts(record)
        if index >= len(attempts):
            raise KeyError(index)
        page = self._pages.replay(
            self._desk.glance(record),
            attempts[index],
            index,
            unblinded=await self._desk.is_unblinded(),
        )
        return HTMLResponse(page)

    async def recording(self, request: Request, token: str) -> Response:
        """The same as JSON, for the program that draws it."""
        del token
        record = await self._record(request)
        recording = await self._desk.recording(record, int(request.path_params["index"]))
        return Response(msgspec.json.encode(recording), media_type="application/json")

    # Doing

    async def set_status(self, request: Request, token: str) -> Response:
        """Open, close or pause the study."""
        form = await _form(request, token)
        status = STATUSES.get(form.get("do", ""))
        if status is not None:
            await self._desk.set_status(status)
        return RedirectResponse("/admin", 303)

    async def blind(self, request: Request, token: str) -> Response:
        """Show conditions, or hide them again."""
        form = await _form(request, token)
        if form.get("sure") == "yes":
            await self._desk.keep("unblinded")
        elif form.get("do") == "hide":
            await self._desk.keep("blinded")
        return RedirectResponse("/admin", 303)

    async def change(self, request: Request, token: str) -> Response:
        """Exclude, readmit or delete a session."""
        form = await _form(request, token)
        record = await self._record(request)
        back = RedirectResponse(f"/admin/sessions/{record.row.id}", 303)
        reason = form.get("reason", "").strip()[:LONGEST_REASON]
        match form.get("do"):
            case "exclude" if reason:
                await self._desk.exclude(record, reason)
            case "readmit" if reason:
                await self._desk.readmit(record, reason)
            case "delete" if form.get("alias", "").strip() == record.alias:
                await self._desk.delete(record)
                return RedirectResponse("/admin", 303)
            case "delete":
                text = "The pseudonym was not repeated, so nothing was deleted."
                return HTMLResponse(self._pages.problem("Nothing deleted", text), 422)
            case _:
                text = "Please give a reason: it stays with the data."
                return HTMLResponse(self._pages.problem("A reason is needed", text), 422)
        return back

    async def export(self, request: Request, token: str) -> Response:
        """The data as a ZIP archive."""
        _ = await _form(request, token)
        folder = await self._desk.export()
        parent = folder.parent
        archive = await asyncio.to_thread(
            shutil.make_archive, str(parent / "coadapt-export"), "zip", parent, folder.name
        )
        return FileResponse(
            archive,
            media_type="application/zip",
            filename="coadapt-export.zip",
            background=BackgroundTask(shutil.rmtree, parent, ignore_errors=True),
        )

    async def _record(self, request: Request) -> Record:
        return await self._desk.record(int(request.path_params["number"]))


def admin_routes(desk: Desk, *, secure: bool) -> Sequence[BaseRoute]:
    """The routes of the researcher's side.

    Raises:
        InputError: if the programs of the pages have not been built.
    """
    service = desk.service
    model = next(iter(service.robots.values())).model
    site = AdminSite(desk, AdminPages(service.study, model.mode_names), secure=secure)

    def route(path: str, handler: Handler, method: str = "GET") -> Route:
        return Route(path, site.guarded(handler), methods=[method])

    session = "/sessions/{number:int}"
    return [
        Route("/admin", site.enter, methods=["GET", "POST"]),
        Mount(
            "/admin",
            routes=[
                Route("/leave", site.leave, methods=["POST"]),
                route("/find", site.find),
                route("/status", site.set_status, "POST"),
                route("/blinding", site.blind, "POST"),
                route("/export", site.export, "POST"),
                route(session, site.session),
                route(session, site.change, "POST"),
                route(f"{session}/attempts/{{index:int}}", site.replay),
                route(f"{session}/attempts/{{index:int}}/recording", site.recording),
            ],
        ),
    ]


def csrf_of(token: str) -> str:
    """What the researcher's forms carry: only who knows the token can know it."""
    return sha256(f"coadapt admin form\n{token}".encode()).hexdigest()


async def _form(request: Request, token: str) -> dict[str, str]:
    """The fields of a form that is one of ours.

    Raises:
        NotNow: if it is not.
    """
    form = await read_fields(request)
    if not is_equal(form.get("csrf", ""), csrf_of(token)):
        raise NotNow("the form is not one of this page, please load it again")
    return form
