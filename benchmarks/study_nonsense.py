"""Forms and websocket messages that no page sends, for `study_fuzz.py`."""

from __future__ import annotations

import msgspec
from hypothesis import strategies as st


def as_json(value: object) -> str:
    """``value`` as JSON; what has no JSON as Python writes it."""
    try:
        return msgspec.json.encode(value).decode()
    except (ValueError, TypeError, UnicodeError):
        return repr(value)


ANY_TEXT = st.text(max_size=30)
NUMBERS = st.integers() | st.floats() | st.integers(0, 5)
JSON = st.recursive(
    st.none() | st.booleans() | NUMBERS | ANY_TEXT,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(ANY_TEXT, inner, max_size=4),
    max_leaves=8,
)
TYPES = st.sampled_from(["ready", "input", "note", "ping", "step", "began", "scene", "allocated"])
FIELDS = st.fixed_dictionaries(
    {},
    optional={
        "type": TYPES | ANY_TEXT,
        "input": st.none() | NUMBERS,
        "device": st.sampled_from(["keyboard", "gamepad", "touch", "switch"]) | ANY_TEXT,
        "sequence": NUMBERS,
        "page_time": NUMBERS,
        "device_time": st.none() | NUMBERS,
        "what": ANY_TEXT,
        "value": st.none() | NUMBERS,
        "text": st.text(max_size=200),
        "event": TYPES,
    },
)
PRESS = st.fixed_dictionaries(
    {
        "type": st.just("input"),
        "input": st.none() | st.integers(-1, 3),
        "device": st.sampled_from(["keyboard", "gamepad", "touch", "switch"]),
        "sequence": st.integers(-1, 2**53),
        "page_time": st.floats(-1e13, 1e13),
    }
)
VALID = st.sampled_from([{"type": "ready"}, {"type": "ping", "page_time": 1.0}]) | PRESS
MESSAGES = (
    VALID.map(lambda value: msgspec.json.encode(value).decode())
    | FIELDS.map(as_json)
    | JSON.map(as_json)
    | st.text(max_size=100)
    | st.binary(max_size=100)
    | st.integers(2000, 9000).map(lambda n: '{"type":"note","what":"' + "x" * n + '"}')
)
CONVERSATIONS = st.lists(MESSAGES, min_size=1, max_size=8)

VALUES = (
    st.sampled_from(["", "0", "1", "5", "6", "-1", "yes", "no", "keyboard", "1e999", "nan", "on"])
    | st.text(max_size=50)
    | st.integers(1, 12_000).map(lambda n: "𝕊" * n)
)
NAMES = st.sampled_from(
    (
        *("stage", "csrf", "consent", "device", "width", "height", "latency", "browser", "pad"),
        *("goal", "trust_trustworthy", "trust_right_thing", "comments", "why_changed"),
    )
)
FORMS = st.tuples(
    st.dictionaries(NAMES | st.text(max_size=20), VALUES, max_size=6),
    st.sampled_from(["own", "own", "own", "none", "wrong"]),  # hidden fields
)
RAW = st.binary(max_size=200)
