"""Where the events of all sessions are kept."""

from coadapt.study.store.database import Conflict, Durability, StoreError
from coadapt.study.store.store import Addition, Digest, Kept, Row, Store
from coadapt.study.store.writer import Overloaded, Taken, Writer

__all__ = [
    "Addition",
    "Conflict",
    "Digest",
    "Durability",
    "Kept",
    "Overloaded",
    "Row",
    "Store",
    "StoreError",
    "Taken",
    "Writer",
]
