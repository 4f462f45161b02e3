"""A browser, and a study for it. The browser is Debian's Chromium."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from tests.study.browser.serving import Serving, write_study

CHROMIUM = "chromium"

ARGUMENTS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]

PATIENCE = 20_000
"""Milliseconds to wait for anything on a page."""

DESKTOP = {"width": 1280, "height": 800}

Visitor = Callable[..., Page]
"""Opens a page of a browser that nobody has used yet; takes options of a browser context."""


@pytest.fixture(scope="module")  # while it is there no test can run an event loop of its own
def browser() -> Iterator[Browser]:
    """The browser; the tests are skipped without one, but not in continuous integration."""
    path = shutil.which(CHROMIUM)
    if path is None:
        if os.environ.get("CI"):
            pytest.fail(f"needs {CHROMIUM}")
        pytest.skip(f"needs {CHROMIUM}")
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=path, args=ARGUMENTS)
        yield started
        started.close()


@pytest.fixture
def visitor(browser: Browser) -> Iterator[Visitor]:
    """Opens pages; an error in a program or a breach of the pages' policy is a failure."""
    contexts = []
    problems: list[str] = []

    def visit(script: str = "", **options: object) -> Page:
        context = browser.new_context(**{"viewport": DESKTOP, **options})
        contexts.append(context)
        context.set_default_timeout(PATIENCE)
        if script:
            context.add_init_script(script)
        page = context.new_page()
        page.on("pageerror", lambda error: problems.append(f"{error}"))
        page.on("console", lambda told: problems.append(told.text) if _bad(told.text) else None)
        return page

    yield visit
    for context in contexts:
        context.close()
    assert not problems


def _bad(text: str) -> bool:
    return "Content Security Policy" in text or "Refused to" in text


@pytest.fixture(scope="session")
def serving(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    """A study under a fixed clock."""
    served = Serving(write_study(tmp_path_factory.mktemp("studies") / "fixed"))
    yield served
    served.stop()


@pytest.fixture(scope="session")
def waiting(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    """A study that waits for inputs, with little to do."""
    directory: Path = tmp_path_factory.mktemp("studies") / "waiting"
    few = [
        ("step = 0.08", "step = 0.5"),
        ('turns = "fixed"', 'turns = "wait"'),
        ("practice = 2", "practice = 1"),
    ]
    few.append(("trials = 3", "trials = 1"))
    served = Serving(write_study(directory, *few, questions=False))
    yield served
    served.stop()
