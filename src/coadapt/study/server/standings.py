"""What has become of sessions, as the allocation sees it."""

from __future__ import annotations

import time

from sqlalchemy import Connection

from coadapt.study.allocation import Allotted, Standing, allocate
from coadapt.study.protocol import Study
from coadapt.study.session import Session
from coadapt.study.store import Digest, Row, Store

MINUTE = 60.0


def digest_of(session: Session) -> Digest:
    """What of ``session`` is asked of all sessions at once."""
    return Digest(session.condition, session.choice, session.device, session.end)


def standing_of(study: Study, row: Row, now: float) -> Standing:
    """What has become of a session, at the time ``now``."""
    return _standing(row.digest, now - row.seen > study.allocation.stale_minutes * MINUTE)


def _standing(digest: Digest, is_stale: bool) -> Standing:
    if digest.end == "finished":
        return "completed"
    return "lost" if digest.end or is_stale else "active"


def allocate_session(
    study: Study, store: Store, connection: Connection, session: Session
) -> str | None:
    """The condition of ``session`` after all that was allocated; None if all quotas are met."""
    stale = time.time() - study.allocation.stale_minutes * MINUTE
    before: list[Allotted] = []
    for digest, is_stale, count in store.allotted(connection, stale):
        standing = _standing(digest, is_stale)
        before += [Allotted(digest.condition or "", standing, covariates_of(digest))] * count
    return allocate(study, before, covariates_of(digest_of(session)))


def covariates_of(digest: Digest) -> dict[str, str]:
    """What a session is balanced by, see `coadapt.study.protocol.Allocation`."""
    return {"choice": f"{digest.choice}", "device": f"{digest.device}"}
