"""Whether the researcher knows who is in which condition: hidden until they ask, which is kept."""

from __future__ import annotations

import time
from typing import Literal

import msgspec

from coadapt.study.store import Store
from coadapt.study.store.store import get_setting, set_setting

UNBLINDINGS = "unblindings"
"""Name of the setting that holds them."""

Act = Literal["unblinded", "blinded", "exported"]
"""``"blinded"``: hidden again; ``"exported"``: the data, which tell, were taken from here."""


class Unblinding(msgspec.Struct, frozen=True):
    """When the researcher did what, in seconds since 1970."""

    time: float
    act: Act


def unblindings(store: Store) -> tuple[Unblinding, ...]:
    """All that were kept, the oldest first."""
    return _decoded(store.setting(UNBLINDINGS))


def is_unblinded(kept: tuple[Unblinding, ...]) -> bool:
    """Whether conditions are shown now."""
    acts = [unblinding.act for unblinding in kept if unblinding.act != "exported"]
    return bool(acts) and acts[-1] == "unblinded"


def keep_unblinding(store: Store, act: Act) -> None:
    """Keep that the researcher did ``act`` now."""
    with store.database.writing() as connection:
        before = _decoded(get_setting(connection, UNBLINDINGS))
        after = (*before, Unblinding(time.time(), act))
        set_setting(connection, UNBLINDINGS, msgspec.json.encode(after).decode())


def _decoded(setting: str | None) -> tuple[Unblinding, ...]:
    return msgspec.json.decode(setting or "[]", type=tuple[Unblinding, ...])
