"""The researcher's texts as HTML."""

from __future__ import annotations

from markdown_it import MarkdownIt
from markupsafe import Markup

_READER = MarkdownIt("commonmark", {"html": False}).enable(["table"])

DEEPEST = 6
"""The lowest heading of HTML."""


def markdown(text: str) -> Markup:
    """``text``, in Markdown, as HTML. HTML in it is shown as it is written.

    Its headings are one level lower than they say, for the page has a heading of its own, and its
    links open beside the page, so that nobody leaves a trial by one.
    """
    tokens = _READER.parse(text)
    for token in tokens:
        if token.type in ("heading_open", "heading_close"):
            token.tag = f"h{min(int(token.tag[1:]) + 1, DEEPEST)}"
        for child in token.children or ():
            if child.type == "link_open":
                child.attrSet("target", "_blank")
                child.attrSet("rel", "noopener noreferrer")
    return Markup(_READER.renderer.render(tokens, _READER.options, {}))
