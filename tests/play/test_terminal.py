"""The terminal program in a real terminal, with keys sent to it by tmux."""

from __future__ import annotations

import os
import shlex
import shutil
import signal
import subprocess
import sys
import time
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import coadapt
from coadapt.cli import main
from coadapt.simulation.log_reader import open_log

TMUX = shutil.which("tmux")

pytestmark = pytest.mark.skipif(
    TMUX is None and not os.environ.get("CI"), reason="needs the terminal multiplexer tmux"
)

PROGRAM = [sys.executable, "-c", "import sys; from coadapt.cli import main; sys.exit(main())"]
PATIENCE = 30.0
"""Seconds until a key shows its effect."""

START = 300.0
"""Seconds until the robot is ready: kernels are compiled on the first run."""


UNWANTED = ("TMUX", "NO_COLOR", "COLUMNS", "LINES")
"""Variables that would reach the program; parallel test runs set a width that is not ours."""


class Terminal:
    """A window of a tmux server of its own."""

    def __init__(self, directory: Path, columns: int, lines: int, *arguments: str) -> None:
        assert TMUX is not None, "CI is set, but tmux is missing"
        self._tmux = [TMUX, "-u", "-L", f"coadapt-{uuid.uuid4().hex}"]
        self._process = directory / "process"
        variables = {
            "PYTHONPATH": str(Path(coadapt.__file__).parents[1]),
            "LANG": "C.UTF-8",
            **{name: os.environ[name] for name in ("NUMBA_CACHE_DIR",) if name in os.environ},
        }
        program = ["env", *(f"{k}={v}" for k, v in variables.items()), *PROGRAM, *arguments]
        inner = f"echo $$ >{shlex.quote(str(self._process))}; exec {shlex.join(program)}"
        # The window stays open after the program, and says how it ended.
        outer = f"sh -c {shlex.quote(inner)}; echo exit code $?.; exec cat"
        size = ["-x", str(columns), "-y", str(lines)]
        self._run("-f", os.devnull, "new-session", "-d", *size, "-c", str(directory), outer)

    def _run(self, *arguments: str) -> str:
        environment = {k: v for k, v in os.environ.items() if k not in UNWANTED}
        environment["SHELL"] = "/bin/sh"
        return subprocess.run(
            [*self._tmux, *arguments],
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=True,
            timeout=30,
            env=environment,
        ).stdout

    def screen(self) -> str:
        return self._run("capture-pane", "-p")

    def press(self, *keys: str) -> None:
        self._run("send-keys", *keys)

    def wait_for(self, words: str, patience: float = PATIENCE) -> str:
        deadline = time.monotonic() + patience
        while words not in (screen := self.screen()):
            over = time.monotonic() > deadline or "exit code" in screen
            assert not over, f"{words!r} did not appear:\n{screen}"
            time.sleep(0.05)
        return screen

    def process(self) -> int:
        return int(self._process.read_text())

    def close(self) -> None:
        subprocess.run([*self._tmux, "kill-server"], capture_output=True, check=False, timeout=30)


Open = Callable[..., Terminal]


@pytest.fixture
def terminal(tmp_path: Path) -> Iterator[Open]:
    """Opens ``coadapt ARGUMENTS`` in a window, in an empty directory; closed in the end."""
    opened: list[Terminal] = []

    def start(*arguments: str, columns: int = 100, lines: int = 30) -> Terminal:
        opened.append(Terminal(tmp_path, columns, lines, *arguments))
        return opened[-1]

    yield start
    for window in opened:
        window.close()


def press_and_watch(window: Terminal, trial: int, keys: list[str]) -> str:
    """Press the keys of a trial, each when the step before is on the screen."""
    screen = window.wait_for(f"trial {trial}, step 0", START)
    for step, key in enumerate(keys, start=1):
        window.press(key)
        screen = window.wait_for(f"trial {trial}, step {step}")
    return screen


@pytest.mark.parametrize("robot", ["mutual_adaptation", "one_way_adaptation", "no_adaptation"])
def test_the_saved_log_replays_bit_for_bit(
    terminal: Open, tmp_path: Path, capsys: pytest.CaptureFixture[str], robot: str
) -> None:
    path = tmp_path / "play.csv"
    window = terminal("play", "--robot", robot, "--log", path.name)
    screen = press_and_watch(window, 1, ["Left", "Left", "Up", "Space", "Right", "Left"])
    for words in ["The table", "What the robot believes", "Why", "Your adaptability", "quit"]:
        assert words in screen
    window.press("n")
    press_and_watch(window, 2, ["Right", "Right", "Space", "Up"])
    window.press("q")
    screen = window.wait_for("Replay it with: coadapt replay play.csv")
    assert "Log of 10 steps saved to play.csv" in screen
    window.wait_for("exit code 0.")

    again = tmp_path / "again.csv"
    assert main(["replay", str(path), "--out", str(again)]) == 0
    assert "Identical to the recorded decisions, all 10 to the bit." in capsys.readouterr().out
    # Inputs, actions and beliefs are in the file, floats as the shortest text for their bits.
    assert again.read_bytes() == path.read_bytes()
    with open_log(path) as log:
        rows = list(log.rows(("left", "forward", "right")))
    names = {"Left": "left", "Up": "forward", "Right": "right", "Space": None}
    keys = ["Left", "Left", "Up", "Space", "Right", "Left", "Right", "Right", "Space", "Up"]
    assert [row.human_input for row in rows] == [names[key] for key in keys]


def test_a_trial_played_to_the_goal(terminal: Open, tmp_path: Path) -> None:
    window = terminal("play", "--robot", "no_adaptation", "--log", "play.csv")
    press_and_watch(window, 1, ["Left"] * 9)  # 3 + 6 moves
    window.wait_for("The right bottle, worth 11, after 9 steps.")
    window.press("Left")  # is not taken
    window.press("n")
    window.wait_for("trial 2, step 0")
    window.press("C-c")
    window.wait_for("Log of 9 steps saved to play.csv")
    window.wait_for("exit code 130.")
    out = str(tmp_path / "again.csv")
    assert main(["replay", str(tmp_path / "play.csv"), "--out", out]) == 0


def test_a_killed_program_leaves_a_log_that_replays(
    terminal: Open, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    window = terminal("play", "--robot", "no_adaptation", "--log", "play.csv")
    press_and_watch(window, 1, ["Left", "Up", "Right"])
    os.kill(window.process(), signal.SIGKILL)
    window.wait_for("exit code 137.")
    assert main(["replay", str(tmp_path / "play.csv"), "--out", str(tmp_path / "again.csv")]) == 0
    assert "Identical to the recorded decisions, all 3 to the bit." in capsys.readouterr().out


def test_a_small_window(terminal: Open) -> None:
    window = terminal("play", "--robot", "no_adaptation", columns=40, lines=14)
    screen = press_and_watch(window, 1, ["Left"])
    assert "●" in screen
    assert "Robot     ↑  forward" in screen
    window.press("q")
    window.wait_for("Replay it with")


def test_an_existing_log_is_kept(terminal: Open, tmp_path: Path) -> None:
    path = tmp_path / "play.csv"
    path.write_text("precious")
    window = terminal("play", "--log", path.name)
    screen = window.wait_for("coadapt: error: ")
    assert "play.csv: found an existing file, expected a new one" in screen
    window.wait_for("exit code 2.")
    assert path.read_text() == "precious"
