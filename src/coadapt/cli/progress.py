"""A line on the terminal while there is something to wait for."""

from __future__ import annotations

import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager


@contextmanager
def progress_line(on: bool = True) -> Generator[Callable[[str], None]]:
    """Call the result to say what is being done; the line disappears in the end.

    It is on standard error, and only where that is a terminal and the line is ``on``.
    """
    if not (on and sys.stderr.isatty()):
        yield lambda _: None
        return
    from rich.console import Console
    from rich.text import Text

    console = Console(stderr=True)
    with console.status("") as status:
        yield lambda sentence: status.update(Text(sentence))
