"""What all figures share: colours, sizes, and how a figure becomes bytes.

The colours keep their order of lightness in greyscale and are those of Okabe and Ito's palette for
colour-blind readers, some darkened. The HTML report exchanges each for a variable of its
style sheet (`TOKENS`), so that the figures follow the reader's light or dark scheme.
"""

# matplotlib leaves the types of keyword arguments open.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from io import BytesIO
from typing import Any

from matplotlib import rc_context, rcdefaults, rcParams  # pyright: ignore[reportUnknownVariableType]
from matplotlib.axes import Axes
from matplotlib.figure import Figure

INK = "#1c2126"
MUTED = "#5c6670"
LINE = "#c9d0d6"
SURFACE = "#eef1f3"
PAPER = "#fffffe"

HUMAN = "#008060"
ROBOT = "#3f4953"
PATH = "#d55e00"

MUTUAL = "#0067a5"
ONE_WAY = "#d98e04"
ONE_WAY_TEXT = "#9c6000"
FIXED = "#2b2f33"

TOKENS = {
    INK: "ink",
    MUTED: "muted",
    LINE: "line",
    SURFACE: "surface",
    PAPER: "paper",
    HUMAN: "human",
    ROBOT: "robot",
    PATH: "path",
    MUTUAL: "mutual",
    ONE_WAY: "one-way",
    ONE_WAY_TEXT: "one-way-text",
    FIXED: "fixed",
}
"""Every colour of the figures with the name of its variable, ``--fig-NAME``."""

WIDTH = 7.2
"""Width of a figure across two columns of a journal, inches."""

DPI = 200

_SETTINGS: dict[Any, Any] = {
    "font.family": "sans-serif",
    # The first is what matplotlib brings along; Verdana is as wide, for readers without it.
    "font.sans-serif": ["DejaVu Sans", "Verdana", "sans-serif"],
    "font.size": 8.0,
    "text.color": INK,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.titlesize": 8.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.facecolor": "none",
    "axes.unicode_minus": True,
    "figure.facecolor": PAPER,
    "lines.linewidth": 1.6,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "svg.fonttype": "none",
    "svg.hashsalt": "coadapt",
    "savefig.dpi": DPI,
    "path.simplify": False,
}


@contextmanager
def settings() -> Generator[None]:
    """Within it figures are made and saved with the report's settings, whatever the user's are."""
    with rc_context():
        rcdefaults()
        rcParams.update(_SETTINGS)
        yield


def render(figure: Figure, kind: str) -> bytes:
    """The figure as ``"svg"`` or ``"png"``; equal figures give equal bytes."""
    buffer = BytesIO()
    nothing = {"Date": None, "Creator": None} if kind == "svg" else {"Software": None}
    figure.savefig(buffer, format=kind, metadata=nothing)
    return buffer.getvalue()


def label_line(
    axes: Axes,
    x: float,
    y: float,
    text: str,
    color: str,
    *,
    dx: float = 4,
    dy: float = 0,
    **kw: Any,
) -> None:
    """Write ``text`` beside the point ``(x, y)``, ``dx`` and ``dy`` points away."""
    axes.annotate(
        text,
        (x, y),
        xytext=(dx, dy),
        textcoords="offset points",
        color=color,
        va=kw.pop("va", "center"),
        annotation_clip=False,
        **kw,
    )
