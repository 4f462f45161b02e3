"""How much one client may ask for."""

from __future__ import annotations

import time
from collections.abc import Callable
from hashlib import blake2b
from ipaddress import IPv6Address, ip_address
from secrets import token_bytes

Clock = Callable[[], float]


class Bucket:
    """Lets ``rate`` things a second through, and up to ``burst`` at once after a rest.

    Args:
        rate: a second.
        burst: at least 1.
        clock: tells the time in seconds.
    """

    __slots__ = ("_burst", "_clock", "_level", "_rate", "_since")

    def __init__(self, rate: float, burst: float, clock: Clock = time.monotonic) -> None:
        self._rate, self._burst, self._clock = rate, burst, clock
        self._level, self._since = burst, clock()

    def take(self) -> bool:
        """Whether one more may pass; it is counted if so."""
        now = self._clock()
        self._level = min(self._burst, self._level + (now - self._since) * self._rate)
        self._since = now
        if self._level < 1:
            return False
        self._level -= 1
        return True

    @property
    def is_full(self) -> bool:
        """Whether it has rested long enough to be like new."""
        return self._level + (self._clock() - self._since) * self._rate >= self._burst


class Buckets:
    """A bucket for each name. Names are kept only as hashes, with a key that is never stored.

    Args:
        rate, burst, clock: as for `Bucket`.
        most: so many buckets are kept at most; beyond that new names have to wait.
    """

    def __init__(
        self, rate: float, burst: float, most: int = 10_000, clock: Clock = time.monotonic
    ) -> None:
        self._rate, self._burst, self._most, self._clock = rate, burst, most, clock
        self._key = token_bytes(16)
        self._buckets: dict[bytes, Bucket] = {}

    def take(self, name: str) -> bool:
        """Whether ``name`` may do one more thing."""
        hashed = blake2b(name.encode("utf-8", "replace"), key=self._key, digest_size=16).digest()
        bucket = self._buckets.get(hashed)
        if bucket is None:
            if len(self._buckets) >= self._most:
                self._tidy()
            if len(self._buckets) >= self._most:
                return False
            bucket = self._buckets[hashed] = Bucket(self._rate, self._burst, self._clock)
        return bucket.take()

    def _tidy(self) -> None:
        self._buckets = {h: b for h, b in self._buckets.items() if not b.is_full}


def network_of(address: str) -> str:
    """What of an address stands for one client: of IPv6 the first half, which one household has."""
    try:
        parsed = ip_address(address)
    except ValueError:
        return address
    if isinstance(parsed, IPv6Address):
        return parsed.exploded[:19]
    return address
