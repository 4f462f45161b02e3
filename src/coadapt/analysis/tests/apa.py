"""Numbers as the APA's style writes them: no zero before the point of what cannot exceed 1."""

from __future__ import annotations

from collections.abc import Sequence

from coadapt.analysis.tests.result import Effect


def number(value: float, digits: int = 2) -> str:
    """A number with so many decimals and a real minus sign."""
    text = f"{value:.{digits}f}"
    return (text.lstrip("-") if float(text) == 0 else text).replace("-", "−")


def proportion(value: float, digits: int = 2) -> str:
    """A number between -1 and 1, without the zero before the point."""
    text = number(value, digits)
    return text.replace("0.", ".", 1) if abs(float(text.replace("−", "-"))) < 1 else text


def p_value(p: float) -> str:
    """``p = .012``, ``p < .001`` or ``p > .999``."""
    if p < 0.001:
        return "p < .001"
    if p > 0.999:
        return "p > .999"
    return f"p = {proportion(p, 3)}"


def degrees(df: Sequence[float]) -> str:
    """``(2, 48)`` or ``(31.42)``; nothing if there are none."""
    texts = [f"{d:.0f}" if float(d).is_integer() else f"{d:.2f}" for d in df]
    return f"({', '.join(texts)})" if texts else ""


def effect(found: Effect) -> str:
    """``ε² = .77, 95% CI [.71, .86]``."""
    write = proportion if found.name in _BOUNDED else number
    interval = f"[{write(found.low)}, {write(found.high)}]"
    return f"{found.name} = {write(found.value)}, {100 * found.level:.0f}% CI {interval}"


_BOUNDED = frozenset({"ε²", "η²", "ω²", "r", "V", "φ", "α", "ρ"})
"""Effects whose size is at most 1."""
