"""Settings and fixtures for all tests."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

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
def _cleared_up(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Directories that several tests share lie where pytest clears up after them."""
    before, tempfile.tempdir = tempfile.tempdir, str(tmp_path_factory.getbasetemp())
    yield
    tempfile.tempdir = before


@pytest.fixture(scope="session")
def shared() -> Path:
    """The directory of the paper and of published problems, which stands beside the project."""
    if not SHARED.is_dir():
        pytest.skip(f"needs the directory {SHARED.name} beside the project")
    return SHARED
