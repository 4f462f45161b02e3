"""What keeps strangers out: headers, the tokens of forms, the researcher's token."""

from __future__ import annotations

import secrets
from hashlib import sha256

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from coadapt.study.store import Store
from coadapt.study.store.store import set_setting

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
    "font-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
)
"""Content security policy: nothing from elsewhere, nothing written into a page."""

HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",  # the address of a page lets into its session
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "gamepad=(self), camera=(), microphone=(), geolocation=()",
}

ADMIN_TOKEN = "admin_token"
"""The setting that holds the hash of the researcher's token."""


class SecurityHeaders:
    """Adds `HEADERS` to every answer of ``app``; pages are not kept by browsers."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def send_more(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in HEADERS.items():
                    headers[name] = value
                if "cache-control" not in headers:
                    headers["Cache-Control"] = "no-store"
            await send(message)

        await self._app(scope, receive, send_more)


def csrf_of(key: str) -> str:
    """What the forms of the session with this ``key`` carry: only who knows the key can know it."""
    return sha256(f"coadapt form\n{key}".encode()).hexdigest()


def is_equal(given: str, expected: str) -> bool:
    """Whether two secrets are the same, found out in a time that tells nothing."""
    return secrets.compare_digest(given.encode(), expected.encode())


def hash_of(token: str) -> str:
    """What is stored of a token: it is random and long, so that one round is enough."""
    return sha256(f"coadapt admin\n{token}".encode()).hexdigest()


def new_admin_token(store: Store) -> str:
    """A new token for the researcher; older ones are worth nothing from now on."""
    token = secrets.token_urlsafe(24)
    with store.database.writing() as connection:
        set_setting(connection, ADMIN_TOKEN, hash_of(token))
    return token


def is_admin_token(store: Store, token: str) -> bool:
    """Whether ``token`` is the researcher's."""
    expected = store.setting(ADMIN_TOKEN)
    return expected is not None and is_equal(hash_of(token), expected)
