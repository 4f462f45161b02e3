"""One participant's session: a pure state machine, (state, event) -> state."""

from coadapt.study.session.events import Event, decode_event, encode_event
from coadapt.study.session.machine import NotNow, advance, replayed
from coadapt.study.session.plan import Stage, plan_of
from coadapt.study.session.state import BEGINNING, End, Result, Session

__all__ = [
    "BEGINNING",
    "End",
    "Event",
    "NotNow",
    "Result",
    "Session",
    "Stage",
    "advance",
    "decode_event",
    "encode_event",
    "plan_of",
    "replayed",
]
