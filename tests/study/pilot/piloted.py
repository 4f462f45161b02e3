"""A small study that simulated participants have taken part in, through a server of its own."""

from __future__ import annotations

import shutil
from functools import cache
from pathlib import Path

from coadapt.cli import main
from tests.directories import shared_directory
from tests.study.sessions import small_study

SEED = 3

PEOPLE = 7

TROUBLE = ("--leaves", "0.4", "--reloads", "0.15", "--disconnects", "0.15")
"""Much goes wrong, so that a few participants show it."""


def fresh(prefix: str) -> Path:
    """A directory with the small study, its policies planned."""
    directory = shared_directory(prefix) / "s"
    shutil.copytree(small_study()[0], directory)
    return directory


def run_pilot(directory: Path, *options: str, n: int = PEOPLE, seed: int = SEED) -> int:
    """The exit code of a pilot."""
    arguments = ["study", "pilot", str(directory), "-n", f"{n}", "--seed", f"{seed}"]
    return main([*arguments, "--at-once", "4", *options])


@cache
def piloted() -> Path:
    """A directory with the data of a pilot, the same for all tests; not to be changed."""
    directory = fresh("coadapt-piloted-")
    assert run_pilot(directory, *TROUBLE) == 0
    return directory


def copy_of(directory: Path, to: Path) -> Path:
    """A copy of a study with its data, to be changed."""
    return Path(shutil.copytree(directory, to))
