"""The page behind the question mark."""

from __future__ import annotations

from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.events import Key
from textual.screen import ModalScreen
from textual.widgets import Static

HELP = """\
You want one of the goals: on the table, a bottle. The robot thinks it knows the
better one.
It waits for your key, takes one step, and shows what it did.

 ← ↑ → ↓ ask for left, forward, right or, where there is such an input, back
 1 2 3   the inputs in their order, where there are others
 space   ask for nothing: the robot takes a step of its own
 n       a new trial: the robot starts again and forgets you
 q       quit; the log is saved after every step
 page    up and down scroll where the window is small

 ●  the robot    ○  its start    █  a bottle    1 2 3  other goals
 ▒  an obstacle  ← ↑ →  the way it came

"Where you want to go" is how likely it thinks each bottle is yours.
"Your adaptability" is its belief over alpha: at 0 you never give in,
at 1 you follow the robot at once. "Why" says why it took its last
step; what an action is worth to it is the reward it expects.

Press any key to go on."""


SCROLLING = {"pageup": -5, "pagedown": 5, "up": -1, "down": 1}
"""Lines that a key scrolls."""


class HelpScreen(ModalScreen[None]):
    """Shows `HELP` until a key is pressed."""

    DEFAULT_CSS = """
    HelpScreen {
        align: center middle;
        & > VerticalScroll {
            width: 78;
            max-width: 100%;
            height: auto;
            max-height: 100%;
            padding: 0 1;
            border: round $primary;
            background: $surface;
        }
    }
    """

    def compose(self) -> ComposeResult:
        """The text in a frame."""
        with VerticalScroll(can_focus=False):
            yield Static(HELP, markup=False)

    def on_key(self, event: Key) -> None:
        """Scroll, where the window is too small for the page; any other key closes it."""
        event.stop()  # the key that closes the page steers nothing
        event.prevent_default()
        if event.key in SCROLLING:
            page = self.query_one(VerticalScroll)
            page.scroll_relative(y=SCROLLING[event.key], animate=False)
        else:
            self.dismiss()
