"""The order in which a participant sees the items of a scale."""

from __future__ import annotations

from hashlib import sha256

from coadapt.study.protocol import Item, Scale


def shown_items(scale: Scale, key: str) -> tuple[Item, ...]:
    """The items of ``scale`` in the order in which the session with ``key`` shows them.

    The same at every look. Where the scale shuffles, each session has a random order of its own,
    since keys are random.
    """
    if not scale.shuffle:
        return scale.items

    def place(item: Item) -> bytes:
        return sha256(f"{key}/{scale.name}/{item.name}".encode()).digest()

    return tuple(sorted(scale.items, key=place))
