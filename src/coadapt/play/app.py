"""The screen and its keys."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from threading import Event, Thread
from time import monotonic
from typing import ClassVar

from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Container, VerticalScroll
from textual.events import Resize
from textual.geometry import Size
from textual.message import Message
from textual.screen import Screen
from textual.widgets import Footer, LoadingIndicator, Static

from coadapt.errors import InputError
from coadapt.play.bars import Bars, BarsView
from coadapt.play.help import HelpScreen
from coadapt.play.keys import MOST_NUMBERED, keys, numbered
from coadapt.play.session import Session
from coadapt.play.table import Scene, TableView, arrow, goal_labels, is_table
from coadapt.robots import Decision, NoAdaptation, Robot
from coadapt.robots.explain import explain, match_threshold
from coadapt.robots.setup import Progress

INTERRUPTED = 130

LONGEST_LABEL = 16
"""Characters."""

NO_SUCH_INPUT = "?"
"""No input has this name."""

WIDE = 76
"""Columns from which the panels stand side by side."""

TALL = 28
"""Lines from which there is room for more than the two beliefs."""

Begin = Callable[[Progress], Session]
"""Builds robot and log. It reports its stages; it runs in a thread of its own."""


class Stage(Message):
    """A stage of the preparation begins."""

    def __init__(self, sentence: str) -> None:
        super().__init__()
        self.sentence = sentence


class Prepared(Message):
    """The preparation is over."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session


class PreparationFailed(Message):
    """The preparation ended in an error."""

    def __init__(self, error: BaseException) -> None:
        super().__init__()
        self.error = error


class Left(Exception):
    """The person has quit while the robot was being prepared."""


class PlayApp(App[int]):
    """The terminal program.

    Args:
        begin: prepares the session.
        title: what to call the robot.

    Attributes:
        session: the session, or None while it is being prepared.
        failure: what ended the program, or None.
    """

    ENABLE_COMMAND_PALETTE = False
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (WIDE, "-wide")]  # noqa: RUF012 (as Textual has it)
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("left", "steer('left')", "left", key_display="←"),
        Binding("up", "steer('forward')", "forward", key_display="↑"),
        Binding("right", "steer('right')", "right", key_display="→"),
        Binding("down", "steer('back')", show=False),
        *(Binding(f"{n}", f"choose({n})", show=False) for n in range(1, MOST_NUMBERED + 1)),
        Binding("space", "steer('')", "no input"),
        Binding("n", "new_trial", "new"),
        Binding("question_mark", "help", "help", key_display="?"),
        Binding("q", "leave(0)", "quit"),
        Binding("ctrl+c", f"leave({INTERRUPTED})", show=False, priority=True),
        Binding("pageup", "scroll(-1)", show=False),
        Binding("pagedown", "scroll(1)", show=False),
    ]
    CSS_PATH = "play.tcss"

    def __init__(self, begin: Begin, title: str) -> None:
        super().__init__()
        self._begin = begin
        self._robot_title = title
        self._left = Event()
        self._since = monotonic()
        self._sentence = "Starting"
        self._window: Size | None = None
        self.session: Session | None = None
        self.failure: BaseException | None = None

    def compose(self) -> ComposeResult:
        """A heading, the body, the keys; the preparation in front until it is done."""
        yield Static(id="heading", markup=False)
        with Container(id="waiting"):
            yield LoadingIndicator()
            yield Static(id="stage", markup=False)
        with VerticalScroll(id="body", can_focus=False):
            with Container(id="table-panel") as table:
                table.border_title = "The table"
                yield TableView(id="table")
                yield Static(id="moves", markup=False)
            with VerticalScroll(id="belief-panel", can_focus=False) as belief:
                belief.border_title = "What the robot believes"
                yield BarsView(id="bars")
            with VerticalScroll(id="why-panel", can_focus=False) as why:
                why.border_title = "Why"
                yield Static(id="why", markup=False)
        yield Footer(show_command_palette=False)

    def on_mount(self) -> None:
        """Begin the preparation."""
        self._main.query_one("#body").display = False
        self._show_waiting()
        self.set_interval(0.25, self._show_waiting)
        # A daemon: quitting does not wait for it.
        Thread(target=self._prepare, daemon=True).start()

    def on_resize(self, event: Resize) -> None:
        """Where the panels stand one below the other, the reason comes before the belief."""
        belief, reason = self._main.query_one("#belief-panel"), self._main.query_one("#why-panel")
        # `self.size` may still be what it was before this event.
        self._window = event.size
        if not self._is_wide:
            self._main.query_one("#body").move_child(reason, before=belief)
        else:
            self._main.query_one("#body").move_child(reason, after=belief)
        self._show_waiting()
        self._show()

    def on_stage(self, message: Stage) -> None:
        """Show the stage."""
        self._sentence = message.sentence
        self._show_waiting()

    def on_preparation_failed(self, message: PreparationFailed) -> None:
        """Give up."""
        self.failure = message.error
        self.exit()

    def on_prepared(self, message: Prepared) -> None:
        """Begin the first trial."""
        self.session = message.session
        self._main.query_one("#waiting").display = False
        self._main.query_one("#body").display = True
        self._show()

    def action_steer(self, name: str) -> None:
        """One time step with the input ``name``; an empty one is no input."""
        session = self.session
        if session is None:
            return
        if session.goal is not None:
            self.bell()  # the screen already says what to press
            return
        names = session.robot.model.interface.names
        if name and name not in names:
            self.bell()
            return
        try:
            session.step(names.index(name) if name else None)
        except InputError as error:
            self.failure = error
            self.exit()
            return
        self._show()

    def action_choose(self, number: int) -> None:
        """One time step with the input that has this number key."""
        if self.session is not None:
            name = numbered(self.session.robot.model.interface, number)
            self.action_steer(name or NO_SUCH_INPUT)

    def action_new_trial(self) -> None:
        """Begin a new trial."""
        if self.session is not None:
            self.session.new_trial()
            self._show()

    def action_help(self) -> None:
        """Show the help page."""
        self.push_screen(HelpScreen())

    def action_leave(self, code: int) -> None:
        """Quit with exit code ``code``."""
        self._left.set()
        self.exit(code)

    def action_scroll(self, direction: int) -> None:
        """Scroll, where the window is too small for everything."""
        self._main.query_one("#body").scroll_relative(y=5 * direction, animate=False)

    def _prepare(self) -> None:
        try:
            session = self._begin(self._tell)
        except Left:
            return
        except BaseException as error:  # handed to the program's thread
            self.post_message(PreparationFailed(error))
        else:
            self.post_message(Prepared(session))

    def _tell(self, sentence: str) -> None:
        if self._left.is_set():
            raise Left
        self.post_message(Stage(sentence))

    def _show_waiting(self) -> None:
        if self.session is not None:
            return
        seconds = int(monotonic() - self._since)
        self._set("heading", self._heading())
        self._set(
            "stage",
            f"{self._sentence} ({seconds} s)\n\n"
            "The first time this takes longer: the planner is being compiled.",
        )

    def _show(self) -> None:
        session = self.session
        if session is None:
            return
        self._set(
            "heading",
            f"{self._heading()} │ trial {session.trial_number}, step {len(session.decisions)}",
        )
        world = session.robot.model.world
        self._main.query_one(TableView).show(Scene(world, session.state, tuple(session.decisions)))
        self._main.query_one(BarsView).show(belief_bars(session, self._is_tall))
        self._set("moves", moves(session))
        self._set("why", why(session))

    @property
    def _main(self) -> Screen[object]:
        """The screen with the panels, also while the help page is in front of it."""
        return self.screen_stack[0]

    def _heading(self) -> str:
        return f"coadapt play │ {self._robot_title}" if self._is_wide else self._robot_title

    @property
    def _is_wide(self) -> bool:
        return (self._window or self.size).width >= WIDE

    @property
    def _is_tall(self) -> bool:
        return (self._window or self.size).height >= TALL

    def _set(self, name: str, text: str) -> None:
        self._main.query_one(f"#{name}", Static).update(text)


def moves(session: Session) -> str:
    """The last input and the last action, each with its arrow."""
    decision = session.last
    if decision is None:
        return f"You       press {keys(session.robot.model.interface)}\nRobot     waits for you"
    model = session.robot.model
    world, interface = model.world, model.interface
    given = "–  nothing"
    if decision.human_input is not None:
        name = interface.names[decision.human_input]
        given = f"{arrow(interface.directions[decision.human_input])}  {name}"
    done = f"{arrow(world.directions[decision.action])}  {world.action_names[decision.action]}"
    note = ""
    if decision.matched:
        note = "   (does what you ask)"
    elif decision.asked not in (None, decision.action):
        note = "   (not what you ask)"
    return f"You       {given}\nRobot     {done}{note}"


def belief_bars(session: Session, with_agreement: bool) -> list[Bars]:
    """What the robot believes of the person: goal, adaptability, and whether they agree."""
    robot = session.robot
    model = robot.planning_model
    belief = model.prior if session.last is None else session.last.belief
    chances = belief.sum(axis=1)
    mean = float((model.alpha.levels * chances).sum())
    is_deaf = isinstance(robot, NoAdaptation)
    learns = "this robot learns nothing" if is_deaf else ""
    names = [name.removeprefix("alpha=") for name in model.alpha.names]
    wanted = belief.sum(axis=0).tolist()
    groups = [
        Bars("Where you want to go", _short(goal_labels(model.world)), wanted, learns),
        Bars("Your adaptability (alpha)", _short(names), chances.tolist(), f"mean {mean:.2f}"),
    ]
    if with_agreement and session.last is not None and not is_deaf:
        threshold = match_threshold(robot)
        note = "" if threshold is None else f"does as you ask from {threshold:.0%}"
        agreement = [session.last.agreement]
        groups.append(Bars("Same goal, you and its plan", ["sure"], agreement, note))
    return groups


def _short(labels: Sequence[str]) -> list[str]:
    """Labels that leave room for the bars."""
    return [x if len(x) <= LONGEST_LABEL else f"{x[: LONGEST_LABEL - 1]}…" for x in labels]


def why(session: Session) -> str:
    """Why the robot acted, and how the trial ended if it has."""
    decision: Decision | None = session.last
    robot: Robot = session.robot
    if decision is None:
        goals = robot.model.world.goals
        if not is_table(robot.model.world):
            worth = ", ".join(f"{goal.name} is worth {goal.reward:g}" for goal in goals)
            return f"Take the robot to the goal you want. To the robot {worth}."
        worth = " and ".join(f"the {goal.name} one is worth {goal.reward:g}" for goal in goals)
        return f"Take the robot to the bottle you want. To the robot {worth}."
    text = explain(robot, decision)
    if session.goal is not None:
        goal = robot.model.world.goals[session.goal]
        steps = len(session.decisions)
        noun = "bottle" if is_table(robot.model.world) else "goal"
        text = (
            f"The {goal.name} {noun}, worth {goal.reward:g}, after {steps} steps. "
            f"Press n for a new trial, q to quit.\n{text}"
        )
    return text
