"""How many sessions there are, and how far they have come."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

import msgspec

from coadapt.study.protocol import Study
from coadapt.study.record import Record, Standing, standing
from coadapt.study.session.machine import replayed
from coadapt.study.session.plan import plan_of


class Census(msgspec.Struct, frozen=True, kw_only=True):
    """Numbers of sessions.

    Attributes:
        sessions: all of them.
        simulated: those of programs.
        deleted: those that were deleted, which nothing else counts.
        standings: by what became of them.
        stages: of those under way, by the stage in which they are, in the order of stages.
        devices: of those that told it, by what they steer with.
        conditions: by condition and standing; None while that is not to be known.
    """

    sessions: int
    simulated: int
    deleted: int
    standings: dict[Standing, int]
    stages: dict[str, int]
    devices: dict[str, int]
    conditions: dict[str, dict[Standing, int]] | None


def census(
    study: Study, records: Iterable[Record], now: float, *, deleted: int = 0, unblinded: bool
) -> Census:
    """Count the sessions.

    Args:
        study: the protocol.
        records: all sessions.
        now: seconds since 1970; sessions without a sign of life for too long are stale by then.
        deleted: number of sessions that were deleted.
        unblinded: whether conditions are to be told.

    Raises:
        NotNow: if the events of a session cannot have happened in their order.
    """
    simulated = 0
    standings, stages, devices = Counter[Standing](), Counter[str](), Counter[str]()
    conditions = {condition.name: Counter[Standing]() for condition in study.conditions}
    plan = plan_of(study)
    for record in records:
        session = replayed(study, (kept.event for kept in record.events))
        stands = standing(study, session.end, record.events[-1].time, now)
        standings[stands] += 1
        simulated += record.is_simulated
        if stands == "active":
            stages[str(plan[session.position])] += 1
        if session.device is not None:
            devices[session.device] += 1
        if session.condition is not None:
            conditions[session.condition][stands] += 1
    named = {name: dict(counts) for name, counts in conditions.items()}
    return Census(
        sessions=standings.total(),
        simulated=simulated,
        deleted=deleted,
        standings=dict(standings),
        stages={name: stages[name] for name in map(str, plan) if stages[name]},
        devices=dict(devices),
        conditions=named if unblinded else None,
    )
