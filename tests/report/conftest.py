"""Results that several tests of the report look at."""

from __future__ import annotations

import pytest

from coadapt import SharedAutonomy
from coadapt.report.reproduce import Reproduction, Settings, reproduce
from coadapt.report.write import make_files
from coadapt.worlds import table_clearing


def small_settings(seed: int = 0) -> Settings:
    """A second layout, small enough to be done in a second."""
    model = SharedAutonomy(table_clearing(7, 3), discount=0.9)
    return Settings(runs=50, seed=seed, model=model)


@pytest.fixture(scope="session")
def found() -> Reproduction:
    """The paper's task, with the paper's number of runs."""
    return reproduce(Settings())


@pytest.fixture(scope="session")
def files(found: Reproduction) -> dict[str, bytes]:
    """Every file of the report on the paper's task."""
    return make_files(found)
