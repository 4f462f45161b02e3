"""Settings and fixtures for all tests."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from tests.directories import remove_shared_directories

# `default` tries the same examples on every run. `HYPOTHESIS_PROFILE=explore` draws new ones.
_LESS = [HealthCheck.too_slow, HealthCheck.data_too_large]
settings.register_profile(
    "default", max_examples=40, deadline=None, derandomize=True, suppress_health_check=_LESS
)
settings.register_profile(
    "explore", max_examples=500, deadline=None, print_blob=True, suppress_health_check=_LESS
)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))

SHARED = Path(__file__).parents[2] / "shared"


@pytest.fixture(scope="session", autouse=True)
def _cleared_up() -> Iterator[None]:
    yield
    remove_shared_directories()


@pytest.fixture(scope="session")
def shared() -> Path:
    """The directory of the paper and of published problems, which stands beside the project."""
    if not SHARED.is_dir():
        pytest.skip(f"needs the directory {SHARED.name} beside the project")
    return SHARED
