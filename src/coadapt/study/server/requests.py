"""What comes with a request, read with care."""

from __future__ import annotations

import asyncio
from urllib.parse import parse_qsl

from starlette.exceptions import HTTPException
from starlette.requests import Request

from coadapt.study.server.limits import network_of

LARGEST_FORM = 1_000_000
"""Bytes. An answer of 10,000 characters takes up to 120,000 when it is sent."""

MOST_FIELDS = 1000

PATIENCE = 20.0
"""Seconds to wait for a form."""

FORM = "application/x-www-form-urlencoded"


async def read_fields(request: Request) -> dict[str, str]:
    """The fields of a posted form; of several with one name, the last.

    Raises:
        HTTPException: 408, 413, 415 or 400 if it cannot be read.
    """
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != FORM:
        raise HTTPException(415)
    body = bytearray()
    try:
        async with asyncio.timeout(PATIENCE):
            async for part in request.stream():
                body += part
                if len(body) > LARGEST_FORM:
                    raise HTTPException(413)
    except TimeoutError as error:
        raise HTTPException(408) from error
    try:
        text = body.decode("ascii", "replace")
        return dict(parse_qsl(text, keep_blank_values=True, max_num_fields=MOST_FIELDS))
    except ValueError as error:
        raise HTTPException(400) from error


def client_of(request: Request) -> str:
    """Who asks, for counting only."""
    return network_of(request.client.host if request.client else "")
