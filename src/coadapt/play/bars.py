"""Probabilities as labelled bars."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from rich.text import Text
from textual.geometry import Size
from textual.widget import Widget

from coadapt.robots.explain import percent

EIGHTHS = " ▏▎▍▌▋▊▉█"


@dataclass(frozen=True)
class Bars:
    """A group of bars.

    Attributes:
        title: what the group is about.
        labels: a short name for each bar.
        values: what the bars show, each in [0, 1].
        note: a line below, or nothing.
    """

    title: str
    labels: Sequence[str]
    values: Sequence[float]
    note: str = ""


class BarsView(Widget):
    """Draws groups of bars, one below the other, as wide as there is room."""

    COMPONENT_CLASSES: ClassVar[set[str]] = {"bars--title", "bars--bar", "bars--note"}
    DEFAULT_CSS = """
    BarsView {
        height: auto;
        & > .bars--title { color: $foreground; text-style: bold; }
        & > .bars--bar { color: $primary; }
        & > .bars--note { color: $foreground-muted; }
    }
    """

    groups: Sequence[Bars] = ()

    def show(self, groups: Sequence[Bars]) -> None:
        """Draw ``groups`` from now on."""
        self.groups = groups
        self.refresh(layout=True)

    def get_content_height(self, container: Size, viewport: Size, width: int) -> int:
        """Lines of all groups, with a blank one between two."""
        lines = sum(1 + len(g.labels) + bool(g.note) for g in self.groups)
        return lines + max(0, len(self.groups) - 1)

    def render(self) -> Text:
        """The drawing."""
        text = Text(no_wrap=True, overflow="ellipsis")
        widest = max((len(label) for g in self.groups for label in g.labels), default=0)
        room = max(4, self.size.width - widest - len(" 100%") - 1)
        lines: list[Text] = []
        for group in self.groups:
            if lines:
                lines.append(Text())
            lines.append(Text(group.title, self.get_component_rich_style("bars--title")))
            for label, value in zip(group.labels, group.values, strict=True):
                line = Text(f"{label:<{widest}} ")
                line.append(bar(value, room), self.get_component_rich_style("bars--bar"))
                line.append(f"{percent(value):>5}")
                lines.append(line)
            if group.note:
                lines.append(Text(group.note, self.get_component_rich_style("bars--note")))
        return text.append_text(Text("\n").join(lines))


def bar(value: float, width: int) -> str:
    """A bar for ``value`` in [0, 1], ``width`` characters with its blank part."""
    full, part = divmod(round(value * width * 8), 8)
    filled = "█" * full + (EIGHTHS[part] if part else "")
    return filled.ljust(width)
