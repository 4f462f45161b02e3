"""Where the events of all sessions are kept."""

from coadapt.study.store.database import Durability
from coadapt.study.store.store import Addition, Digest, Kept, Row, Store
from coadapt.study.store.writer import Overloaded, StoreError, Taken, Writer

__all__ = [
    "Addition",
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
